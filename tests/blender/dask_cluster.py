"""A Dask cluster on this machine, whose parts can be killed."""

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import thenar_blender


def environment():
    """Variables with which a process finds the package under test."""
    package = Path(thenar_blender.__file__).parent.parent
    paths = os.pathsep.join(path for path in (str(package), os.environ.get("PYTHONPATH", "")) if path)
    return {**os.environ, "PYTHONPATH": paths}


AS_ADVISED = {"DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False"}
"""Variables of scheduler and workers, as README.md tells to start them."""


class Cluster:
    """A Dask scheduler and two workers, each a process of its own."""

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self._place = free.getsockname()
        self.address = f"tcp://127.0.0.1:{self._place[1]}"
        self.folder, self.workers, self.scheduler = folder, [], None

    def begin(self):
        """Start all of them, on the same address each time."""
        host, port = self._place
        self.scheduler = self._dask("scheduler", "--host", host, "--port", str(port), "--no-dashboard", "--no-jupyter")
        self._await_port(host, port)
        own = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(self.folder))
        self.workers = [self._dask("worker", self.address, *own) for _ in range(2)]

    def end(self):
        """Kill all of them."""
        for process in (*self.workers, self.scheduler):
            if process is not None:
                process.kill()
                process.wait()

    def _dask(self, *arguments):
        command = [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]]
        own = {**environment(), **AS_ADVISED}
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=own)

    def _await_port(self, host, port):
        until = time.monotonic() + 60.0
        while time.monotonic() < until:
            with socket.socket() as probe:
                if probe.connect_ex((host, port)) == 0:
                    return
            time.sleep(0.2)
        raise TimeoutError("the scheduler did not start")
