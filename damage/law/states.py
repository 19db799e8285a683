"""State of a joint, one code for solvers and histories; nothing is imported, so that reading it
loads no solver."""

BROKEN = 1
AT_LIMIT = 2
CRUSHED = 4
ENDED = 8
"""Bits of a contact point's state, as histories keep it; ENDED: its interface has ended, and forces
are zero."""
FAILED = 1.0
ENDING = 7.0
"""Of an interface in the step, rising from zero while it is intact to ENDED.  FAILED: a contact
point has failed, softened or been crushed; ENDING: the two faces ceased to overlap in this step."""
