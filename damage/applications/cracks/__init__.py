"""Against the laboratory: pushed walls beside their tests, and digitised cracks as data."""
