"""Results of a history: energies, cracks, cycles, periods, key numbers, tables."""
