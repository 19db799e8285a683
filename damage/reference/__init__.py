"""Reference solver: a wall and its state, its plain and fast time step, the interface to a run, its
command."""
