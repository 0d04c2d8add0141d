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


class Certificates:
    """An authority of our own, and a certificate by it and one by a stranger, all made here."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        for authority in ("ca", "stranger"):
            self._openssl(
                *("req", "-x509", *_NEW_KEY, "-subj", f"/CN={authority}", "-days", "2"),
                *("-keyout", f"{authority}.key", "-out", f"{authority}.pem"),
            )
        self._openssl(
            *("req", *_NEW_KEY, "-subj", "/CN=127.0.0.1", "-keyout", "own.key", "-out", "own.csr")
        )
        self._openssl(
            *("x509", "-req", "-in", "own.csr", "-CA", "ca.pem", "-CAkey", "ca.key"),
            *("-CAcreateserial", "-days", "2", "-out", "own.pem"),
        )

    def options(self, who: str = "own") -> tuple[str, ...]:
        """For `dask scheduler`, `dask worker` and `facecrf batch`."""
        return (
            *("--tls-ca-file", str(self._folder / "ca.pem")),
            *("--tls-cert", str(self._folder / f"{who}.pem")),
            *("--tls-key", str(self._folder / f"{who}.key")),
        )

    def _openssl(self, *arguments: str) -> None:
        subprocess.run(["openssl", *arguments], cwd=self._folder, check=True, capture_output=True)


_NEW_KEY = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")


class DaskCluster:
    """A scheduler; workers are added by hand. Everything ends with the `with` block."""

    def __init__(self, folder: Path, certificates: Certificates | None = None) -> None:
        self.folder = folder
        self._tls = () if certificates is None else certificates.options()
        self.workers: list[subprocess.Popen[bytes]] = []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            protocol = "tls" if certificates else "tcp"
            self.address = f"{protocol}://127.0.0.1:{free.getsockname()[1]}"
        self.file = folder / "scheduler.json"

    def __enter__(self) -> DaskCluster:
        port = self.address.rpartition(":")[2]
        self.scheduler = self._start(
            *("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"),
            *("--protocol", self.address.partition(":")[0], *self._tls),
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
            *("--local-directory", str(self.folder), *self._tls, *options),
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
