"""What OpenColorIO logs on stderr, in lines of its own, beside what it raises."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import PyOpenColorIO as ocio  # noqa: N813


@contextmanager
def unlogged(quiet: bool = True) -> Iterator[None]:
    """Let OpenColorIO keep its warnings to itself, if quiet."""
    level = ocio.GetLoggingLevel()
    try:
        if quiet:
            ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_NONE)
        yield
    finally:
        ocio.SetLoggingLevel(level)
