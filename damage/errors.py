"""The one exception that stands for input a user can mend."""


class InputError(ValueError):
    """Bad input: its one-line message says what came, what was expected, how to mend it."""
