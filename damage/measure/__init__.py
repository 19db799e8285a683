"""What a history says: energies, cracks, cycles, periods, key numbers, tables."""
