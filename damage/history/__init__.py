"""The history file of a run: schema, writer and reader."""
