"""Model files in three other engines, in three dimensions, over the same obstacles."""
