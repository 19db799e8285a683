"""Mechanics of a wall: bodies, interfaces between them, contacts and their law, one plain time step.

Everything here is written for one wall in plain arithmetic.  The functions of `bodies` and `interfaces` also take
eight values as one (`eight`), so that the fast step of the reference solver repeats none of them.
"""

from damage.mechanics.cache import find_a_place

find_a_place()  # before anything is compiled
