"""What code points of ITU-T H.273 name, by which PNG, HEIC and AVIF tell of their color."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.values import Primaries

LINEAR, PQ, HLG = "linear", "PQ", "HLG"
_PRIMARIES = {1: "Rec.709", 9: "Rec.2020", 12: "Display P3"}  # H.273, table 2
TRANSFERS = {8: LINEAR, 9: "log 100:1", 10: "log 316:1", 16: PQ, 18: HLG}
"""Curves by their numbers (ITU-T H.273, table 3) that say what the codes mean.

Others (BT.709, sRGB) name what a display is to do, and cameras do as they like.
"""
_BOX = b"colrnclx"


@dataclass(frozen=True, slots=True)
class CodePoints:
    """Primaries and transfer characteristics, and whether code values use their full range."""

    primaries: int
    transfer: int
    full_range: bool = True

    @property
    def curve(self) -> str:
        """One of `TRANSFERS`, or empty for any other."""
        return TRANSFERS.get(self.transfer, "")

    def named_primaries(self) -> Primaries | None:
        """The primaries; None for those that have no name here."""
        name = _PRIMARIES.get(self.primaries)
        return known_primaries(name, "file attribute") if name else None


def of_numbers(told: Sequence[int] | None) -> CodePoints | None:
    """Of a PNG's cICP: primaries, transfer, matrix, full range."""
    if told is None or len(told) != 4:
        return None
    return CodePoints(int(told[0]), int(told[1]), bool(told[3]))


def of_nclx(told: Mapping[str, Any] | None) -> CodePoints | None:
    """Of the picture's color box as pillow-heif has it."""
    if not told:
        return None
    return CodePoints(int(told["color_primaries"]), int(told["transfer_characteristics"]))


def of_boxes(content: bytes) -> CodePoints | None:
    """Of the first color box of a file (ISO 14496-12, 12.1.5), whose range its decoder minds."""
    at = content.find(_BOX)
    return None if at < 0 else of_color_box(content[at + 4 : at + 12])


def of_color_box(held: bytes) -> CodePoints | None:
    """Of what a color box holds; None where that is no code points."""
    if held[:4] != _BOX[4:] or len(held) < 8:
        return None
    return CodePoints(*struct.unpack_from(">HH", held, 4))
