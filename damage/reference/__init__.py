"""The built-in reference solver: a wall and its state, the fast step, the solver of a run, its command."""
