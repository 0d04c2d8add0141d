r"""How names, which are bytes, are kept as the text that SQLite and readers of the manifest want.

A byte that is no UTF-8 is written as `\xe9`; a backslash that would read as such an escape, as
`\x5c`. So no two names have one key, and every key gives its name back.
"""

from __future__ import annotations

import os
import re
from pathlib import PurePosixPath
from unicodedata import normalize

from facecrf_ocio.errors import OutputError

_LIKE_AN_ESCAPE = re.compile(r"\\(?=x[0-9a-f]{2})")
_ESCAPE = re.compile(rb"\\x([0-9a-f]{2})")


def key_of(name: str) -> str:
    """Key of a path below the source or the folder of outputs, with slashes."""
    plain = _LIKE_AN_ESCAPE.sub(lambda _: r"\x5c", name)
    return plain.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def name_of_key(key: object) -> str:
    """The path that a key stands for, relative and without a way out.

    Raises
    ------
    OutputError
        If it leads elsewhere; then it was not written by this package.
    """
    if not isinstance(key, str):
        raise OutputError("the manifest names a file by what is no text")
    name = os.fsdecode(_ESCAPE.sub(lambda hexed: bytes([int(hexed[1], 16)]), key.encode()))
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or "\0" in name or not path.parts:
        raise OutputError(f"the manifest names {key}, which leads out of its folder")
    return name


def folded(name: str) -> str:
    """What names have in common that file systems without regard to case or composition mix up."""
    return key_of(normalize("NFC", normalize("NFC", name).casefold()))
