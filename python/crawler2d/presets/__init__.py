"""Ready-made robots of the literature, and terrains of every kind."""
