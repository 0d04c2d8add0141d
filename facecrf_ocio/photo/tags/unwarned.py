"""Pillow without its warnings, which would stand on stderr as two lines of its own."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def unwarned() -> Iterator[None]:
    """Let a library keep its warnings to itself: of damaged metadata, and of size, both checked."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
