"""Life of a wall: the earthquakes at its address, drawn and carried through one after the other."""
