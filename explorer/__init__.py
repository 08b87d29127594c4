"""The page in which the core runs in the browser: `python -m explorer` in a clone."""
