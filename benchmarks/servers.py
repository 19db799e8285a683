"""Can a run in YADE be reached over the network while it starts?  Ten quiet starts beside ten under
attack.

    python3 benchmarks/servers.py                 # by the launcher ./yade
    python3 benchmarks/servers.py --plain         # by YADE's own command
    # where other YADEs run, too:
    sudo unshare --net sh -c 'ip link set lo up; exec python3 benchmarks/servers.py'

Every 20 ms /proc shows on which addresses the process listens.  The attack, through 127.0.0.1
alone, lasts as long as the run: it connects to YADE's first ports again and again and stays idle on
most connections; on one it gives the cookie that it reads in what YADE prints, and then sends code.
A port on which another program listens is left alone. Exit status 1 where a run listened beyond
loopback, executed code, did not end well, or was delayed by more than 2 s: the least and the median
of what the main thread slept in the attacked runs over those in the quiet ones.  The time that it
ran or waited for a processor does not count: it is longer where other programs use the machine, as
the attack does.
"""

import argparse
import os
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WALL = f"""import sys
sys.path.insert(0, {str(ROOT)!r})
from damage import Wall
from yade_scripts.run import main
main(lambda: Wall("pair", length=0.225, height=0.15, precompression=0.0))
"""
MOTION = (
    "--harmonic",
    "0.05",
    "0.01",
    "--cycles",
    "2",
    "--rest",
    "0",
    "--no-pictures",
    "--overwrite",
    "--out",
)
PROMPTS, INFORMERS = range(9000, 9003), range(21000, 21003)
LOOPBACK = {"0100007F", "00000000000000000000000001000000"}  # as /proc/net has 127.0.0.1 and ::1
LOOK_S, KNOCK_S, DELAY_S, LONGEST_S = 0.02, 0.01, 2.0, 90.0
MOST_IDLE = 50


def listening(pid):
    """{(address, port)} on which a process listens, addresses in hexadecimal."""
    sockets, found = set(), set()
    for link in Path(f"/proc/{pid}/fd").iterdir():
        with suppress(FileNotFoundError):  # closed meanwhile
            sockets.add(os.readlink(link))
    for path in (Path(f"/proc/{pid}/net/{table}") for table in ("tcp", "tcp6")):
        for line in path.read_text().splitlines()[1:] if path.exists() else []:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in sockets:
                address, _, port = words[1].partition(":")
                found.add((address, int(port, 16)))
    return found


def _is_taken(port):
    with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1):
        return True
    return False


class Attack(threading.Thread):
    """Connects to YADE's ports until it is stopped; `log()` returns what YADE has printed so
    far."""

    def __init__(self, log, marker):
        super().__init__(daemon=True)
        self.log, self.stopped = log, threading.Event()
        self.code = f"import time; print(time.time(), file=open({str(marker)!r}, 'a'))\n".encode()
        self.ports = [port for port in (*PROMPTS, *INFORMERS) if not _is_taken(port)]
        self.connections, self.prompt = [], None

    def run(self):
        while not self.stopped.wait(KNOCK_S):
            for port in self.ports if len(self.connections) < MOST_IDLE else ():
                with suppress(OSError):
                    self.connections.append(
                        socket.create_connection(("127.0.0.1", port), timeout=1)
                    )
            self._speak()
        for connection in self.connections:
            connection.close()

    def _speak(self):
        """Log in at the prompt with the cookie, then send code at every call."""
        printed = re.search(r":(\d+), auth cookie `(\w+)'", self.log())
        with suppress(OSError):
            if self.prompt is None and printed and int(printed[1]) in self.ports:
                self.prompt = socket.create_connection(("127.0.0.1", int(printed[1])), timeout=1)
                self.prompt.recv(100)
                self.prompt.sendall(f"{printed[2]}\n".encode())
                self.prompt.recv(1000)
                self.connections.append(self.prompt)
            elif self.prompt is not None:
                self.prompt.sendall(self.code)


def start(program, folder, attacked):
    """Start one run and watch it to its end; returns {what: value} of it."""
    wall, marker, log = folder / "wall.py", folder / "marker", folder / "log"
    wall.write_text(WALL)
    marker.unlink(missing_ok=True)
    log.write_text("")
    attack = Attack(log.read_text, marker)
    if attacked:
        attack.start()
    seen, last, slept_s, began = set(), None, 0.0, time.time()
    with (
        log.open("w") as file,
        subprocess.Popen(
            [program, "-n", "-j1", wall, *MOTION, folder / "run.h5"],
            cwd=ROOT,
            stdout=file,
            stderr=subprocess.STDOUT,
        ) as run,
    ):
        while run.poll() is None:
            if time.time() > began + LONGEST_S:
                run.kill()
            with suppress(OSError):  # it ends
                now = listening(run.pid)
                seen |= now
                last = time.time() if now else last
                ran, waited, _ = map(
                    int, Path(f"/proc/{run.pid}/task/{run.pid}/schedstat").read_text().split()
                )
                slept_s = time.time() - began - (ran + waited) / 1e9
            time.sleep(LOOK_S)
    ended = time.time()
    attack.stopped.set()
    if attacked:
        attack.join()
    executed = [float(line) for line in marker.read_text().split()] if marker.exists() else []
    return {
        "status": run.returncode,
        "seconds": ended - began,
        "slept_s": slept_s,
        "connections": len(attack.connections),
        "abroad": {f"{address}:{port}" for address, port in seen if address not in LOOPBACK},
        "listened": 0.0 if last is None else last - began,
        "executed": len(executed),
        "later": sum(when > (last or began) + 2 * LOOK_S for when in executed),
        "log": log.read_text(),
    }


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--starts", type=int, default=10, help="of each kind (default 10)")
    parser.add_argument("--plain", action="store_true", help="by YADE's own command")
    asked = parser.parse_args()
    program = "yade" if asked.plain else str(ROOT / "yade")
    runs = {False: [], True: []}
    with tempfile.TemporaryDirectory() as folder:
        for number in range(asked.starts):
            for attacked in (False, True):
                run = start(program, Path(folder), attacked)
                runs[attacked].append(run)
                until = f" until {run['listened']:.2f} s" if run["listened"] else ""
                print(
                    f"{number + 1} {'attacked' if attacked else 'quiet   '}  status {run['status']}"
                    f"  {run['seconds']:5.1f} s, asleep {run['slept_s']:4.1f} s  listened beyond"
                    f" loopback: {', '.join(sorted(run['abroad'])) or '-'}{until}  connections"
                    f" {run['connections']}  executed {run['executed']}, {run['later']} of it after"
                    " the ports were closed",
                    flush=True,
                )
    delays = [
        how(run["slept_s"] for run in runs[True]) - how(run["slept_s"] for run in runs[False])
        for how in (min, statistics.median)
    ]
    both = runs[False] + runs[True]
    print(
        f"delay by the attack: least {delays[0]:.1f} s, median {delays[1]:.1f} s; cookie printed in"
        f" {sum('cookie' in run['log'] for run in both)} of {len(both)} logs"
    )
    return int(
        max(delays) > DELAY_S
        or any(run["abroad"] or run["executed"] or run["status"] for run in both)
    )


if __name__ == "__main__":
    sys.exit(main())
