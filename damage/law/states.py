"""State of a joint, one code for solvers and histories; nothing is imported, so that reading it
loads no solver."""

BROKEN = 1
"""Bit of a contact point's state in histories: its bond has failed."""
AT_LIMIT = 2
"""Bit of the state: the contact point is at its shear limit."""
CRUSHED = 4
"""Bit of the state: the joint has been crushed."""
ENDED = 8
"""Bit of the state: the interface has ended, and its forces are zero."""
FAILED = 1.0
"""State of an interface in the step, between intact and ENDED: a contact point has failed, softened
or been crushed."""
ENDING = 7.0
"""State of an interface in the step: its two faces ceased to overlap in this step."""
