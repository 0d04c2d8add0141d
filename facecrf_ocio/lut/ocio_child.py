"""Opens LUT files for another process, which this one must not take along when it hangs or dies."""

from __future__ import annotations

import contextlib
import json
import signal
import sys
from pathlib import Path

from facecrf_ocio.lut.ocio_processor import RefusedError, ocio_processor

_MEMORY = 2 << 30  # [byte] of addresses; OpenColorIO itself takes some 0.2e9


def serve() -> None:
    """Answer lines `[path, seconds]` with OpenColorIO's reason against the file, "" for none."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # noqa: PLC0415 - not on Windows

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for line in sys.stdin:
        path, seconds = json.loads(line)
        _allow(seconds)
        answer = _reason(Path(path))
        _allow(0.0)
        print(json.dumps(answer), flush=True)


def _reason(path: Path) -> str:
    try:
        ocio_processor(path)
    except RefusedError as error:
        return str(error) or "it gives no reason"
    except MemoryError:
        return "it asks for more memory than a LUT needs"
    return ""


def _allow(seconds: float) -> None:
    """End this process after so much processor time; OpenColorIO is deaf to what Python handles."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_PROF, seconds)
