"""Studies: many runs on the processors of a machine, or of a cluster."""
