"""Mechanics of a wall: bodies, interfaces between them, contact points and the joint law, and the plain time step.

All functions are written for one wall.  Those of `bodies` and `interfaces` also accept vectors of eight values
(`eight`), so that the fast step of the reference solver uses the same functions.
"""

from damage.mechanics.cache import find_a_place

find_a_place()  # before anything is compiled
