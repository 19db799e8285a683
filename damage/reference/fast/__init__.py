"""The fast step: that of `damage.mechanics.step` for eight numbers at once, to the same bits.

It takes walls whose bodies are rigid and whose interfaces stay the same: all that can be built.
"""
