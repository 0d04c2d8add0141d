"""Blocks that a JPEG's scan has left when its picture is full: a sign of damage within its pixels.

Huffman codes fall into step again after damage, so a decoder reads on, some blocks too early or too
late. Too early, it runs out of data and says so. Too late, the picture is full before the data end,
and OpenImageIO does not look. But a scan can be read from anywhere: its last bytes alone give the
blocks that it ends with. Where the picture ends with earlier ones, what follows them is left over.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.photo.containers.jpeg_segments import JpegParts
from facecrf_ocio.photo.raster.pixels import Pixels
from facecrf_ocio.photo.tags.unwarned import unwarned

Float32 = npt.NDArray[np.float32]

# What a JPEG codes at once, color differences and all, is a unit here (T.81: MCU).
_LAST = (12, 48)  # [unit] at the picture's end that are compared, at least and at most
_TAIL = 250  # [unit] of mean length that are read; up to 100 pass until they are in step
_BYTES = (3_000, 40_000)  # [byte] that are read, at least and at most
_ROOM = 3  # times as many units may be in them: those of a sky are short
_TALLEST = 65_500  # [px] of a JPEG
_TOLD = 40  # [level] other than 0 that the picture's end needs, to be told from other places
_ALIKE = 0.6  # correlation: 0.95 and more between the same units, less where damage made them clip
_UNLIKE = 0.5  # times that at most with the data's end, of a picture that does not end there
_AFTER = 2  # [unit] left over; of the bits that fill the last byte a decoder may make one
_LARGEST = 20.0  # [level] above it a single edge would count for more than all the rest
_STEP = 8  # [code] of the levels of the tail, the least from which 8 bits give them back
_SEQUENTIAL = (0xC0, 0xC1)  # frames of a single scan, Huffman coded (T.81, table B.1)
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}  # SOF0 to SOF15 (T.81, table B.1)
_LUMA = np.array([0.299, 0.587, 0.114], np.float32)  # ITU-T T.871
_LOW = 4  # frequencies a side that are compared; of higher ones few are coded
# T.81, A.3.3: the cosine transform of 8 values.
_COSINES = np.cos((2 * np.arange(8) + 1) * np.arange(_LOW)[:, None] * np.pi / 16) / 2
_COSINES[0] /= np.sqrt(2)
# T.81, figure A.6: where the numbers of a table of quantization belong, row by row.
_ZIGZAG = sorted(
    range(64), key=lambda at: (sum(divmod(at, 8)), divmod(at, 8)[(sum(divmod(at, 8)) + 1) % 2])
)


@dataclass(frozen=True, slots=True, eq=False)
class Tail:
    """The last units of a scan, as a JPEG one unit wide.

    Attributes
    ----------
    jpeg
        Its bytes, with a quantization of its own.
    unit
        (height, width) [px] of a unit.
    size
        (height, width) [px] of the photo as it is stored.
    steps
        (4, 4) [code] the photo's quantization of luma, of low frequencies.
    """

    jpeg: bytes
    unit: tuple[int, int]
    size: tuple[int, int]
    steps: npt.NDArray[np.float64]


def tail_of(parts: JpegParts) -> Tail | None:
    """The end of a JPEG's scan; None where there is nothing to compare.

    Of restart marks, and of several scans, decoders tell what is left over before the last.
    """
    try:
        return _tail_of(parts.picture) if parts.ended else None
    except (IndexError, KeyError, struct.error, ValueError, ZeroDivisionError):
        return None


def _tail_of(picture: bytes) -> Tail | None:
    tables, frame, marker, sequential = b"", b"", 0, False
    steps: dict[int, npt.NDArray[np.float64]] = {}
    for marker, at, end in _headers(picture):
        body = picture[at + 4 : end]
        if marker == 0xDB:
            steps.update(_quantization(body))
        elif marker == 0xC4:
            tables += picture[at:end]
        elif marker in _FRAMES:
            sequential, frame = marker in _SEQUENTIAL, body
        if marker == 0xDA or (marker == 0xDD and any(body)):
            break
    bits, height, width, layers = struct.unpack_from(">BHHB", frame)
    across, down = frame[7] >> 4, frame[7] & 15
    # One scan of all three layers, color differences as they are stored once a unit.
    plain = sequential and (bits, layers, body[:1]) == (8, 3, b"\3") and marker == 0xDA
    if not plain or frame[10::3] != b"\x11\x11" or max(across, down) > 2:
        return None
    scan = picture[end:-2].rstrip(b"\0")  # which some fill up with
    tall, wide = 8 * down, 8 * across
    mean = len(scan) * tall * wide / (width * height)
    # Neither a byte FF nor the 00 after it begins the tail.
    rest = scan[-round(min(max(_TAIL * mean, _BYTES[0]), _BYTES[1])) :].lstrip(b"\xff\0")
    units = min(round(_ROOM * len(rest) / mean), _TALLEST // tall)
    own = b"".join(_segment(0xDB, bytes((one, 1, *[_STEP] * 63))) for one in steps)
    small = frame[:1] + struct.pack(">HH", units * tall, wide) + frame[5:]
    jpeg = b"\xff\xd8" + own + _segment(0xC0, small) + tables + picture[at:end] + rest + b"\xff\xd9"
    return Tail(jpeg, (tall, wide), (height, width), steps[frame[8]])


def _headers(picture: bytes) -> Iterator[tuple[int, int, int]]:
    """Marker, begin and end of each segment of a JPEG that was taken apart."""
    at = 2
    while at < len(picture):
        end = at + 2 + int.from_bytes(picture[at + 2 : at + 4], "big")
        yield picture[at + 1], at, end
        at = end


def _segment(marker: int, body: bytes) -> bytes:
    return struct.pack(">BBH", 0xFF, marker, len(body) + 2) + body


def _quantization(body: bytes) -> Iterator[tuple[int, npt.NDArray[np.float64]]]:
    """Number and (4, 4) steps [code] of each table (T.81, B.2.4.1), of low frequencies."""
    while body:
        wide = body[0] >> 4
        table = np.zeros(64)
        table[_ZIGZAG] = np.frombuffer(body[1 : 65 + 64 * wide], ">u2" if wide else np.uint8)
        yield body[0] & 15, table.reshape(8, 8)[:_LOW, :_LOW]
        body = body[65 + 64 * wide :]


def units_left_over(tail: Tail, codes: Pixels) -> int:
    """How many units of a scan follow those that its picture ends with; 0 where none surely do.

    Parameters
    ----------
    tail
        From `tail_of`.
    codes
        (H, W, 3) of 8 bits, as stored.
    """
    (tall, wide), (height, width) = tail.unit, tail.size
    row, whole = (height - 1) // tall * tall, width // wide
    if codes.shape != (height, width, 3) or height - row < 8 or whole < _LAST[0]:
        return 0
    count = min(whole, _LAST[1])
    first = (whole - count) * wide
    light = codes[row : row + 8, first : whole * wide].astype(np.float32) @ _LUMA
    end = _levels(light.reshape(8, count, wide)[..., :8].swapaxes(0, 1), tail.steps)
    data = _decoded(tail)
    if data is None or np.count_nonzero(end) < _TOLD:
        return 0
    data = _levels(data, np.full((_LOW, _LOW), float(_STEP)))
    filled = np.flatnonzero(data.any(axis=1))
    # Full to its last unit, the tail may go on; nearly empty, it says nothing.
    if len(filled) < count or filled[-1] == len(data) - 1:
        return 0
    cut = -(-width // wide) - whole  # units at the right that are not seen whole
    return _left_over(end, data[: filled[-1] + 1], cut, int(np.flatnonzero(end.any(axis=1))[-1]))


def _decoded(tail: Tail) -> Float32 | None:
    """(N, 8, 8) luma of the first block of each unit, around 128."""
    from PIL import Image  # noqa: PLC0415 - 30 ms, for JPEGs alone

    with unwarned():
        try:
            with Image.open(io.BytesIO(tail.jpeg)) as picture:
                picture.draft("L", picture.size)
                light = np.asarray(picture, np.float32)
        except (OSError, ValueError):
            return None
    return light.reshape(-1, *tail.unit)[:, :8, :8]


def _levels(blocks: Float32, steps: npt.NDArray[np.float64]) -> Float32:
    """(N, 15) levels that (N, 8, 8) blocks were quantized to, without their means."""
    cosines = _COSINES.astype(np.float32)
    spectrum = cosines @ blocks @ cosines.T / steps.astype(np.float32)
    return np.rint(spectrum).clip(-_LARGEST, _LARGEST).reshape(len(blocks), -1)[:, 1:]


def _left_over(end: Float32, data: Float32, cut: int, last: int) -> int:
    """Units of the data (N, 15) after those that are like the picture's end (K, 15)."""
    count = len(end)
    padded = np.concatenate([data, np.zeros_like(end)])
    places = len(padded) - count + 1
    alike = np.zeros(places, np.float32)
    for at, unit in enumerate(end):
        alike += padded[at : at + places] @ unit
    power = np.cumsum(np.concatenate([[0.0], (padded.astype(np.float64) ** 2).sum(axis=1)]))
    alike /= np.sqrt(np.maximum((power[count:] - power[:-count]) * (end**2).sum(), 1e-9))
    found = int(alike.argmax())
    at_end = max(len(data) - 1 - cut - last, 0)  # where the picture's end lies in a sound file
    sound = alike[max(at_end - 1, 0) : at_end + 1].max(initial=0.0)  # padding may make one more
    after = len(data) - (found + count + cut)
    if alike[found] < _ALIKE or sound > _UNLIKE * alike[found] or after < _AFTER:
        return 0
    return after
