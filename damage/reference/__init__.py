"""The built-in reference solver: the compiled step, a wall and its state, the stages of a run, its command."""

from damage.mechanics.cache import find_a_place

find_a_place()  # before anything of this folder is compiled
