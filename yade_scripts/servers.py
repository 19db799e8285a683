"""Closing of the network servers that YADE's own command starts before it runs a script.

They listen on all network interfaces: one executes code after a guessable cookie, one pauses runs
without any.  The launcher `yade` of this project starts neither.
"""

import gc
import os
import socket
import socketserver
import stat
import time
from contextlib import suppress
from threading import Thread

PATIENCE_S = 1.0
"""Time that the threads of servers have to end [s]; their connections are closed before."""


def close_servers():
    """Close all servers of this process with their connections, within little more than PATIENCE_S;
    returns the number of servers."""
    servers = [
        thing for thing in gc.get_objects() if issubclass(type(thing), socketserver.BaseServer)
    ]
    ports = {server.server_address[1] for server in servers}
    for server in servers:
        _refuse(server)
        with suppress(OSError):
            # it listens no more, and its loop looks at once
            server.socket.shutdown(socket.SHUT_RDWR)
    ending = [Thread(target=server.shutdown, daemon=True) for server in servers]
    for thread in ending:
        thread.start()
    deadline = time.monotonic() + PATIENCE_S
    _close_connections(ports)
    while any(thread.is_alive() for thread in ending) and time.monotonic() < deadline:
        time.sleep(0.01)
        _close_connections(ports)  # one more may have been accepted while the loop ended
    _close_connections(ports)
    for server in servers:
        server.socket.close()  # server_close() would wait for every connection's thread
    return len(servers)


def _refuse(server):
    """Have a server refuse new and pending connections, and all cookies."""
    server.verify_request = lambda request, client: False
    server.RequestHandlerClass = lambda request, client, server: None
    # of connections that are closed while they talk
    server.handle_error = lambda request, client: None
    server.cookie = None


def _close_connections(ports):
    """Shut down all connections of this process that were accepted on these ports."""
    for number in filter(_is_socket, map(int, os.listdir("/proc/self/fd"))):
        with (
            suppress(OSError),
            socket.fromfd(number, socket.AF_INET, socket.SOCK_STREAM) as connection,
        ):
            address = connection.getsockname()
            if isinstance(address, tuple) and address[1] in ports:
                connection.shutdown(socket.SHUT_RDWR)


def _is_socket(number):
    """Whether an open file is a socket: of any other one socket.fromfd() fails and leaves a copy
    open."""
    try:
        return stat.S_ISSOCK(os.fstat(number).st_mode)
    except OSError:  # closed meanwhile
        return False
