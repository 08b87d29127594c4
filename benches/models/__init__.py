"""Files of models in two other engines, in three dimensions, over the same obstacles."""
