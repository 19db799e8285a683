"""The built-in reference solver: the compiled step, a wall and its state, the stages of a run, its command."""
