"""Studies: what they run, the tables and figures of what they left, fragility."""
