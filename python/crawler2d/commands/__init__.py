"""The commands of the package: each file has the options of one, and what it does with them."""
