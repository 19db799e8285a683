"""Houses: walls placed in plan, their corners, floors and ties, their layout in space.

Also what is done to walls and houses alike: drawn inputs, larger units, plausible values.
"""
