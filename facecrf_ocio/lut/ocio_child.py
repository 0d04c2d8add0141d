"""Opens LUT files for another process, which this one must not take along when it hangs or dies."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sys
import tempfile
from pathlib import Path

from facecrf_ocio.lut.ocio_processor import RefusedError, ocio_processor

_MOST_WARNINGS = 20  # of OpenColorIO for one file, sent to whoever asked
_MOST_ASKED = 2  # times: of a damaged file it gave none once, and its reason thousands of times
_LEAST_MEMORY = 80 << 20
"""[byte] Addresses that any file may take; the largest that are published take a few megabytes."""

_MEMORY_PER_BYTE = 16  # of a file; published ones take up to 1.5


def serve() -> None:
    """Say `ready`, then answer lines `[path, seconds]` with lines `[reason, warnings]`.

    The reason is OpenColorIO's against the file, "" for none.
    """
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # noqa: PLC0415 - not on Windows

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # What OpenColorIO logs of a damaged file may be no UTF-8: a logging function of Python's would
    # fail inside of it, while it holds its lock, and it would wait for that forever.
    log = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the process
    os.dup2(log.fileno(), sys.stderr.fileno())
    print("ready", flush=True)
    for line in sys.stdin:
        path, seconds = json.loads(line)
        log.seek(0)
        log.truncate()
        _allow(seconds)
        _allow_memory(path)
        reason = _reason(Path(path))
        _allow(0.0)
        log.seek(0)
        warnings = log.read().decode("utf-8", "replace").splitlines()
        told = dict.fromkeys(_plain(text, path) for text in warnings[:_MOST_WARNINGS])
        print(json.dumps([reason, list(told)]), flush=True)


def _plain(text: str, path: str) -> str:
    """A line of OpenColorIO's log without who says it, and of what file."""
    _, _, message = " ".join(text.split()).rpartition(f"{path}")
    return message.removeprefix("[OpenColorIO Warning]: ")


def _reason(path: Path) -> str:
    for _ in range(_MOST_ASKED):
        try:
            ocio_processor(path, quiet=False)
        except RefusedError as error:
            if str(error):
                return str(error)
        except MemoryError:
            return "it asks for more memory than a LUT needs"
        else:
            return ""
    return "it gives no reason"


def _allow(seconds: float) -> None:
    """End this process after so much processor time; OpenColorIO is deaf to what Python handles."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_PROF, seconds)


def _allow_memory(path: str) -> None:
    """Refuse this process more memory than reading a file of that size takes."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # noqa: PLC0415 - not on Windows

        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        most = taken + _LEAST_MEMORY + _MEMORY_PER_BYTE * os.stat(path).st_size  # noqa: PTH116
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))
