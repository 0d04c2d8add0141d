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
_MEMORY = 2 << 30  # [byte] of addresses; OpenColorIO itself takes some 0.2e9


def serve() -> None:
    """Say `ready`, then answer lines `[path, seconds]` with lines `[reason, warnings]`.

    The reason is OpenColorIO's against the file, "" for none.
    """
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # noqa: PLC0415 - not on Windows

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
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
    try:
        ocio_processor(path, quiet=False)
    except RefusedError as error:
        return str(error) or "it gives no reason"
    except MemoryError:
        return "it asks for more memory than a LUT needs"
    return ""


def _allow(seconds: float) -> None:
    """End this process after so much processor time; OpenColorIO is deaf to what Python handles."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_PROF, seconds)
