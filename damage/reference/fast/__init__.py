"""The fast step: that of `damage.mechanics.step` for eight numbers at once, to the same bits.

Walls qualify whose bodies are rigid and whose interfaces stay the same (`damage.reference.wall.why_not_fast`).
"""
