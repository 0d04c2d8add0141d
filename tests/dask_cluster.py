"""A Dask cluster of real processes: a scheduler and workers that may be killed."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

_START = 60.0


class DaskCluster:
    """A scheduler; workers are added by hand. Everything ends with the `with` block."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.workers: list[subprocess.Popen[bytes]] = []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        self.file = folder / "scheduler.json"

    def __enter__(self) -> DaskCluster:
        port = self.address.rpartition(":")[2]
        self.scheduler = self._start(
            *("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"),
            *("--scheduler-file", str(self.file)),
        )
        end = time.monotonic() + _START
        while not self._is_up():
            assert time.monotonic() < end, self.log()
            time.sleep(0.1)
        return self

    def __exit__(self, *_: object) -> None:
        for process in (*self.workers, self.scheduler):
            self._end(process)

    def _is_up(self) -> bool:
        try:
            return bool(json.loads(self.file.read_text(encoding="utf-8"))["address"])
        except (OSError, ValueError):
            return False

    def add_worker(self, *options: str, cwd: Path | None = None, **environment: str) -> int:
        """Start a worker of one thread and return its process id."""
        process = self._start(
            *("worker", self.address, "--nthreads", "1", "--no-dashboard"),
            *("--local-directory", str(self.folder), *options),
            cwd=cwd,
            **environment,
        )
        self.workers.append(process)
        return process.pid

    def wait_for_workers(self, count: int) -> None:
        """Wait until so many have told the scheduler of themselves."""
        from distributed import Client  # noqa: PLC0415 - an extra

        with Client(self.address, timeout=_START, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=_START)

    def kill_worker(self, pid: int) -> None:
        """As a power cut does."""
        os.killpg(pid, signal.SIGKILL)

    def log(self) -> str:
        """What all of them printed."""
        return (self.folder / "log").read_text(encoding="utf-8", errors="replace")

    def _start(self, *arguments: str, cwd: Path | None = None, **environment: str):
        with (self.folder / "log").open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "dask", *arguments],
                stdout=log,
                stderr=log,
                cwd=cwd or self.folder,
                env={**os.environ, **environment},
                start_new_session=True,
            )

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
        process.wait()
