"""Keeps YADE from starting its network servers: the launcher `yade` has YADE import this before
anything of its own.

YADE's command ends its start with `yade.remote.runServers()`, which opens a prompt and an
information server on all network interfaces.  Here `yade.remote` is a module whose `runServers`
does nothing.  No other part of YADE uses it.
"""

import sys
from importlib.machinery import ModuleSpec


class NoServers:
    """Finds and loads a `yade.remote` that opens nothing."""

    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return ModuleSpec(name, cls) if name == "yade.remote" else None

    @staticmethod
    def create_module(spec):
        return None  # an ordinary module

    @staticmethod
    def exec_module(module):
        module.runServers = lambda: None


sys.meta_path.insert(0, NoServers)
if sys.path[-1] == ".":
    # YADE's option -L appends it; a file of the current folder must not stand in for a library
    sys.path.pop()
