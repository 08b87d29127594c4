"""Ready-made robots from the literature, and terrains of every kind."""
