"""The exceptions that a user is told in one line."""


class InputError(ValueError):
    """Bad input: its one-line message says what came, what was expected, how to mend it."""


class WriteError(OSError):
    """A history could not be written any further, as on a full disk: its message is one line."""
