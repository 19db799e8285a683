"""Mechanics of a wall: bodies, interfaces between them, contact points and the joint law, and the
time step.

Its functions take numbers of one wall, or vectors of those of eight (`eight`).
"""

from damage.mechanics.compiled import find_a_place

find_a_place()  # before anything is compiled
