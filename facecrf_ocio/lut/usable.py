"""Whether OpenColorIO can use a LUT file, asked where it can do no harm.

On some damaged files it never returns (38 bytes of .csp will do) or ends the process, so it is
asked in a child process first, which lives on for the next file.
"""

from __future__ import annotations

import atexit
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import facecrf_ocio

_LEAST_SECONDS = 0.5
"""[s] Processor time that any file may take; a few kilobytes take some milliseconds."""

_BYTES_PER_SECOND = 2e6
"""[byte/s] What OpenColorIO reads at least, of text: 8e6 on one core of 2020."""

_PATIENCE = 60.0 if hasattr(signal, "setitimer") else 5.0
"""Times the processor time that may pass on a busy machine; less where nobody counts that time."""

_START = 60.0
"""[s] That the process may take to start."""

_SERVE = "import sys; sys.path.insert(0, sys.argv[1]); from facecrf_ocio.lut.ocio_child import "
_ROOT = str(Path(facecrf_ocio.__file__).resolve().parents[1])


def why_unusable(path: Path) -> str:
    """Return OpenColorIO's reason against a LUT file, whole; empty if it takes it."""
    return ask(path)[0]


def ask(path: Path) -> tuple[str, tuple[str, ...]]:
    """Return OpenColorIO's reason against a LUT file, and what it warns of."""
    if "python" not in Path(sys.executable or "").name.lower():
        return "", ()  # inside of a host, whose program must not be started a second time
    return _child.ask(path)


class _Child:
    """The process that is asked, started when it is needed."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._owner = 0
        self._lock = threading.Lock()

    def ask(self, path: Path) -> tuple[str, tuple[str, ...]]:
        seconds = _LEAST_SECONDS + path.stat().st_size / _BYTES_PER_SECOND
        question = json.dumps([os.path.abspath(path), seconds])  # noqa: PTH100 - resolves no links
        with self._lock:
            process = self._running()
            answer = _exchange(process, question + "\n", _PATIENCE * seconds)
            if answer:
                reason, warnings = json.loads(answer)
                return str(reason), tuple(map(str, warnings))
            return self._last_words(process, seconds), ()

    def stop(self) -> None:
        process, self._process = self._process, None
        if process is not None and self._owner == os.getpid():
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()

    def _running(self) -> subprocess.Popen[str]:
        if self._process is None or self._owner != os.getpid() or self._process.poll() is not None:
            self.stop()
            self._owner = os.getpid()
            self._process = subprocess.Popen(
                [sys.executable, "-c", f"{_SERVE} serve; serve()", _ROOT],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                encoding="utf-8",
            )
            _exchange(self._process, "", _START)  # that it is ready
        return self._process

    def _last_words(self, process: subprocess.Popen[str], seconds: float) -> str:
        # Unless it died of something else, its time was up: by its own clock, or by the watch.
        process.kill()
        died_of = -process.wait()
        self.stop()
        by_clock = {getattr(signal, name, 0) for name in ("SIGPROF", "SIGKILL", "SIGTERM")}
        if died_of in by_clock or died_of <= 0:
            return f"OpenColorIO does not come to an end with it within {seconds:.1f} s"
        return "OpenColorIO crashes on it"


def _exchange(process: subprocess.Popen[str], question: str, seconds: float) -> str:
    """Return a line of a process's answer, which dies if it has none in time; empty then."""
    watch = threading.Timer(seconds, process.kill)
    watch.start()
    try:
        assert process.stdin is not None and process.stdout is not None  # noqa: S101, PT018
        process.stdin.write(question)
        process.stdin.flush()
        return process.stdout.readline()
    except OSError:
        return ""
    finally:
        watch.cancel()


_child = _Child()
atexit.register(_child.stop)
