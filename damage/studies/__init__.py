"""Studies: definition, tables and figures of their results, fragility."""
