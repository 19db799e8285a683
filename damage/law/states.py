"""Bits of a contact point's state, as histories keep it; nothing is imported, so that reading them loads no solver."""

BROKEN, AT_LIMIT, CRUSHED, ENDED = 1, 2, 4, 8
