"""Exposure of an address: the earthquakes of a catalogue and the ground motion that they caused
there."""
