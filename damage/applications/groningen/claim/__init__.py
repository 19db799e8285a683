"""A claim: the same wall with and without the earthquakes, with and without the settlement, and the
sheet on it."""
