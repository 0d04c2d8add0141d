"""Text of unknown encoding, as files and libraries give it, made storable and printable.

EXIF is said to be ASCII and is whatever a camera's maker took for text; OpenImageIO's bindings
pass its bytes on as lone surrogates, which SQLite, EXR headers and terminals refuse. Messages of
libraries quote such bytes too, and then raise UnicodeDecodeError instead of telling.
"""

from __future__ import annotations

import re
from collections.abc import Callable

LONGEST = 1000
"""[characters] Of one text, by default; EXIF allows 64 KB, and what is read at a glance is less."""

_CUT = "…"
# C0, C1 and DEL; line and paragraph separators; marks that turn the direction of what follows; the
# byte order mark; noncharacters. None of them is seen, and all of them change what is seen.
_UNSEEN = (
    "\x00-\x08\x0b-\x1f\x7f-\x9f"
    "\u2028\u2029\u200e\u200f\u202a-\u202e\u2066-\u2069\ufeff\ufffe\uffff"
)
_BREAKS = re.compile("\r\n?|[\u2028\u2029\x85]")
_STEERS = re.compile("[\x00-\x1f\x7f-\x9f]")
_LINE = re.compile(f"[{_UNSEEN}\t\n]+")
_LINES = re.compile(f"[{_UNSEEN}]+")


def plain_text(said: object, *, limit: int = LONGEST, lines: bool = False) -> str:
    r"""What was said, as text that UTF-8 holds and any terminal shows.

    Parameters
    ----------
    said
        Text, bytes, or an error of any library. Bytes, and those that stand as lone surrogates in
        text (PEP 383), are taken for UTF-8, else for Windows-1252, of which Latin-1's letters are
        a part. Of a UnicodeDecodeError what could not be decoded is told.
    limit
        [characters] Longer text is cut, and ends in an ellipsis.
    lines
        Keep line ends and tabs; else they become spaces, as do control characters always.

    Returns
    -------
    str
        Without lone surrogates, NUL and control characters, and without spaces at its ends.
    """
    unseen = _LINES if lines else _LINE
    text = unseen.sub(" ", _BREAKS.sub("\n", _decoded(said))).strip()
    return text if len(text) <= limit else text[: limit - len(_CUT)].rstrip() + _CUT


def one_line(text: str) -> str:
    r"""Escape line ends and what else steers a terminal, which file names may hold, as `\x0a`."""
    return _STEERS.sub(lambda found: f"\\x{ord(found[0]):02x}", text)


def counted(count: int, thing: str) -> str:
    """As words: 1 photo, 2 photos."""
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def complaint(ask: Callable[[], object]) -> str:
    """What a library answers where it is asked for its last error, in plain text."""
    try:
        return plain_text(ask(), lines=True)
    except UnicodeDecodeError as error:
        return plain_text(error, lines=True)


def _decoded(said: object) -> str:
    if isinstance(said, UnicodeDecodeError):
        return _of_bytes(said.object)
    if isinstance(said, BaseException):
        return _decoded(said.args[0]) if len(said.args) == 1 else _decoded(str(said))
    if isinstance(said, bytes | bytearray):
        return _of_bytes(bytes(said))
    text = str(said)
    if text.isascii():
        return text
    try:
        return _of_bytes(text.encode("utf-8", "surrogateescape"))
    except UnicodeEncodeError:  # surrogates that stand for no byte
        return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def _of_bytes(content: bytes) -> str:
    for encoding in ("utf-8", "cp1252"):
        try:
            return content.decode(encoding)
        except UnicodeDecodeError:
            continue
    return content.decode("latin-1")  # five bytes that Windows-1252 leaves out
