"""The parts of a JPEG file: what stands before its pixels, where they end, and what follows.

Decoders take the pictures that phones append for pixels of their own, or refuse a file for bytes
that no pixel depends on; so a file is taken apart first (ITU-T T.81, annex B).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

_START, _END, _SCAN = 0xD8, 0xD9, 0xDA  # markers (T.81, table B.1)
_ALONE = frozenset((0x01, *range(0xD0, 0xD8)))  # markers without a length (T.81, table B.1)
_APP = range(0xE0, 0xF0)  # APP0 to APP15
# SOF0 to SOF15, without DHT, JPG and DAC.
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_PROGRESSIVE = frozenset((0xC2, 0xC6, 0xCA, 0xCE))  # of several scans (T.81, table B.1)
_FREQUENCIES = 64  # of a block
# [byte] 0 in the place of the end: a download that was broken off. A scan by tables of its own may
# end with as many where it is of one color.
_FILL = 16
_LEAD = 1 << 10  # [byte] looked through for the start of a picture


@dataclass(frozen=True, slots=True, eq=False)
class JpegParts:
    """A JPEG file, taken apart.

    Attributes
    ----------
    picture
        The bytes of its first picture alone, without stray ones, and with an end.
    segments
        (marker, content) of its application segments, in their order.
    size
        (width, height) [px]; (0, 0) where the file does not come so far.
    rest
        What follows the picture.
    stray
        Bytes between segments, or before the first, that belong to none.
    ended
        Whether the file has the mark that ends the picture.
    complete
        Whether the scans of a progressive JPEG bring all frequencies to their last bit.
    """

    picture: bytes
    segments: tuple[tuple[int, bytes], ...]
    size: tuple[int, int]
    rest: bytes
    stray: int
    ended: bool
    complete: bool

    def contents(self, marker: int, signature: bytes) -> list[bytes]:
        """What segments of this marker hold after their signature."""
        return [
            content[len(signature) :]
            for kind, content in self.segments
            if kind == marker and content.startswith(signature)
        ]


def take_apart(content: bytes) -> JpegParts | None:
    """Take a JPEG file apart; None where no picture starts in its first bytes."""
    # Only a first mark is known without the next: stray bytes may stand between the two.
    start = 0 if content[:2] == b"\xff\xd8" else content.find(b"\xff\xd8\xff", 0, _LEAD)
    if start < 0:
        return None
    walk = _Walk(content, start + 2, stray=start)
    while not walk.done:
        walk.step()
    if not walk.ended and walk.kept:
        last = bytes(walk.kept[-1])
        scan = last.rstrip(b"\0")
        walk.kept[-1] = scan if len(last) - len(scan) >= _FILL else last
    kept = (b"\xff\xd8", *walk.kept, b"" if walk.ended else b"\xff\xd9")
    # Mostly nothing is left out and nothing added, and the file is the picture.
    is_whole = walk.ended and sum(map(len, kept)) == len(content)
    picture = content if is_whole else b"".join(kept)
    return JpegParts(
        *(picture, tuple(walk.segments), walk.size, content[walk.at :], walk.stray, walk.ended),
        complete=not any(walk.missing_bits.values()),
    )


def _markers(content: bytes) -> npt.NDArray[np.intp]:
    """Where markers that end a scan may be: in one, FF 00 is a byte, and FF D0 to D7 restart it."""
    codes = np.frombuffer(content, np.uint8)
    ends = np.ones(256, bool)
    ends[[0x00, 0xFF, *range(0xD0, 0xD8)]] = False
    begins = np.flatnonzero(codes[:-1] == 0xFF)
    return begins[ends[codes[begins + 1]]]


class _Walk:
    """From segment to segment; `kept` holds the bytes of each, marker included."""

    def __init__(self, content: bytes, at: int, stray: int) -> None:
        self.content, self.at, self.stray = content, at, stray
        self.markers = _markers(content)
        self.kept: list[bytes | memoryview] = []
        self.segments: list[tuple[int, bytes]] = []
        self.size = (0, 0)
        # Of each layer and frequency of a progressive JPEG, as far as its scans have come.
        self.missing_bits: dict[tuple[int, int], int] = {}
        self.done = self.ended = False

    def step(self) -> None:
        """Take the next segment, and the scan that may follow it."""
        mark = self._next_marker()
        if mark == len(self.content):
            self.done, self.at = True, mark
            return
        between = self.content[self.at : mark].rstrip(b"\xff")  # FF may fill (T.81, B.1.1.2)
        self.stray += len(between)
        marker, begin = self.content[mark + 1], mark + 2
        self.at = begin
        if marker == _END:
            self.done = self.ended = True
            self.kept.append(b"\xff\xd9")
        elif marker == _START or marker in _ALONE:
            self.stray += 2
        else:
            self._segment(marker, begin)

    def _next_marker(self) -> int:
        found = int(np.searchsorted(self.markers, self.at))
        return int(self.markers[found]) if found < self.markers.size else len(self.content)

    def _segment(self, marker: int, begin: int) -> None:
        length = int.from_bytes(self.content[begin : begin + 2], "big")
        self.at = begin + max(length, 2)
        body = self.content[begin + 2 : self.at]
        if marker in _APP:
            self.segments.append((marker, body))
        elif marker in _FRAMES and self.size == (0, 0):
            self.size = int.from_bytes(body[3:5], "big"), int.from_bytes(body[1:3], "big")
            layers = body[6::3] if marker in _PROGRESSIVE else b""
            self.missing_bits = dict.fromkeys(product(layers, range(_FREQUENCIES)), 1)
        if marker == _SCAN:
            self._progress(body)
            self.at = self._next_marker()
        self.kept += bytes((0xFF, marker)), memoryview(self.content)[begin : self.at]

    def _progress(self, scan: bytes) -> None:
        """Count the bits that a scan of a progressive JPEG leaves to others (T.81, B.2.3)."""
        count = scan[0] if scan else 0
        if not self.missing_bits or len(scan) < 2 * count + 4:
            return
        first, last, bits = scan[2 * count + 1 : 2 * count + 4]
        for of in product(scan[1 : 2 * count : 2], range(first, last + 1)):
            self.missing_bits[of] = bits & 15
