"""The fast time step: `damage.mechanics.step` in vectors of eight numbers, to the same bits.

It requires rigid bodies and a fixed set of interfaces.
"""
