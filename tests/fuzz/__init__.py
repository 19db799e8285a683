"""Damaged files of every kind that is read, and what comes of reading them: `python3 -m tests.fuzz --help`."""
