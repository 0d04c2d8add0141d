"""What OpenColorIO logs on stderr, in lines of its own, beside what it raises."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import partial

import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.files.threads import WhileAny


def unlogged(quiet: bool = True) -> AbstractContextManager[None]:
    """Let OpenColorIO keep its warnings to itself, if quiet."""
    return _without_log() if quiet else nullcontext()


def _end_log() -> Callable[[], object]:
    level = ocio.GetLoggingLevel()
    ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_NONE)
    return partial(ocio.SetLoggingLevel, level)


_without_log = WhileAny(_end_log)
