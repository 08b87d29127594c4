"""Requirements of the documentation site, without building it."""
