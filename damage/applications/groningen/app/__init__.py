"""A claim as a local page: `python3 -m damage app`."""
