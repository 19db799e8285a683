"""The history file of a run: its schema, who writes it, who reads it."""
