"""Measures of a run, from its History: energies, cracks, cycles, periods, summary, tables,
warnings."""
