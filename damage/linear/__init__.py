"""Intact walls and houses: stiffness in blocks, masses, static displacements, natural modes."""
