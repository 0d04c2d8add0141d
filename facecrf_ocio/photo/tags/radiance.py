"""What a Radiance picture tells of its numbers and their coding (G. Ward, Radiance File Formats).

OpenImageIO passes on neither primaries nor corrections of color, and of exposures the last one.
"""

from __future__ import annotations

import math
import re

import numpy as np

_MOST = 1 << 16  # [byte] of a header, which a blank line ends
_LINE = re.compile(rb"^(PRIMARIES|EXPOSURE|COLORCORR|GAMMA)=(.*)$", re.MULTILINE)
_SIZES = re.compile(rb"\n\n[-+][XY] +\d+ +[-+][XY] +\d+\n")  # the line that pixels follow
# Numbers in a line of each.
_COUNTS = {b"PRIMARIES": 8, b"EXPOSURE": 1, b"COLORCORR": 3, b"GAMMA": 1}
_SAME = 1e-3  # of a factor that is 1, as programs round it


def radiance_primaries(content: bytes) -> tuple[float, ...] | None:
    """CIE xy of red, green, blue and white; None where they are not told."""
    told = _told(content, b"PRIMARIES")
    return told[-1] if told else None


def radiance_notes(content: bytes) -> tuple[str, ...]:
    """What was done to the light before it was written, which is not undone, in clauses."""
    notes = []
    for name, whose in ((b"EXPOSURE", "light is"), (b"COLORCORR", "red, green and blue are")):
        told = _told(content, name)  # each program adds a line: all of them together count
        factors = [math.prod(of_one) for of_one in zip(*told, strict=True)]
        if any(abs(factor - 1) > _SAME for factor in factors):
            times = ", ".join(f"{factor:.4g}" for factor in factors)
            notes.append(f"its {whose} {times} times the scene's by its header ({name.decode()})")
    gammas = [gamma for (gamma,) in _told(content, b"GAMMA")]
    if gammas and abs(gammas[-1] - 1) > _SAME:
        notes.append(f"its header says GAMMA={gammas[-1]:.4g}: its numbers were taken for light")
    return tuple(notes)


def has_old_runs(content: bytes) -> bool:
    """Whether equal pixels are coded by a count of repetitions: as in Radiance before 1991.

    Each pixel is four bytes, and a count is one whose three colors are 1, which no light gives: one
    color of each pixel is at least 128. The newer coding begins each row by two bytes of 2.
    """
    pixels = _SIZES.split(content, maxsplit=1)[-1] if content.startswith(b"#?") else b""
    if pixels.startswith(b"\2\2"):
        return False
    units = np.frombuffer(pixels[: len(pixels) // 4 * 4], np.uint8).reshape(-1, 4)
    return bool((units[:, :3] == 1).all(axis=1).any())


def _told(content: bytes, name: bytes) -> list[tuple[float, ...]]:
    """Numbers of each line of a name that has as many as it should; factors above zero alone."""
    header = content[:_MOST].partition(b"\n\n")[0] if content.startswith(b"#?") else b""
    told = []
    for found, text in _LINE.findall(header):
        try:
            numbers = tuple(map(float, text.split()))
        except ValueError:
            continue
        sound = name == b"PRIMARIES" or all(0 < number < math.inf for number in numbers)
        if found == name and len(numbers) == _COUNTS[name] and sound:
            told.append(numbers)
    return told
