"""Closes the servers that YADE opens at each start, on all interfaces: a prompt that executes code behind a guessable
cookie, and one that pauses runs without any."""

import gc
import socketserver
from threading import Thread


def close_servers():
    """Shut every server of this process down; returns how many there were."""
    servers = [thing for thing in gc.get_objects() if isinstance(thing, socketserver.BaseServer)]
    closing = [Thread(target=_close, args=(server,)) for server in servers]
    for thread in closing:
        thread.start()
    for thread in closing:
        thread.join()
    return len(servers)


def _close(server):
    server.shutdown()  # its loop looks twice a second
    server.server_close()
