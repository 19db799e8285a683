"""The wall: its parameters, layout, geometry, natural modes, and the joint law."""
