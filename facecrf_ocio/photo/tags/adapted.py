"""Settings by which a camera bends its curve to the scene, as its maker's notes tell them.

With one of them on, a photo has another curve than its camera's, and mostly more than one. Tags
and values are those of ExifTool's tables (exiftool.org/TagNames, version 13.58). A value that is
not listed there says nothing, and so does `off`. A weak setting counts as a strong one: makers
publish no curves of either, and by `Auto` the camera chooses how strong. Apple's HDR is told by
EXIF itself (`edits.py`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from facecrf_ocio.photo.tags.maker_notes import MakerNotes, maker_notes

# What values mean, as the tables have them.
_LEVELS = {1: "Low", 2: "Standard", 3: "High"}
_MOST = 16  # numbers of a value that are looked at


@dataclass(frozen=True, slots=True)
class _Setting:
    """One tag.

    Attributes
    ----------
    name
        What the maker calls the setting; of several tags of a name the first that is there tells.
    tag
        Its number.
    on
        What values mean by which it is on.
    at
        Place of the value among the tag's numbers.
    letter
        How the tag's bytes are read, where not by the kind that it says.
    below
        Tag of the directory in which it lies; 0 for the notes' own.
    sized
        Whether the value begins with its size, as arrays of Canon do. Where notes were moved and
        their offsets lead elsewhere, it does not.
    """

    name: str
    tag: int
    on: Mapping[int, str]
    at: int = 0
    letter: str = ""
    below: int = 0
    sized: bool = False

    def value(self, notes: MakerNotes) -> int | None:
        """The value; None where there is none."""
        place = notes.below(self.below) if self.below else notes
        read = place.numbers(self.tag, _MOST, self.letter)
        if self.sized and read[:1] != (place.size(self.tag),):
            return None
        return read[self.at] if len(read) > self.at else None


# Of Nikon, where the numbers of extra high begin at 8.
_ACTIVE = {1: "Low", 3: "Normal", 5: "High", 7: "Extra High", 0xFFFF: "Auto"}
_ACTIVE |= {7 + level: f"Extra High {level}" for level in range(1, 5)}
_OPTIMIZER_ON = {0: "Standard", 1: "Low", 2: "Strong"}  # Canon
# Of Sony, whose levels begin at 8 and at 16.
_DRO = {1: "Standard", 2: "Advanced Auto", 3: "Auto"}
_DRO |= {7 + level: f"Advanced Lv{level}" for level in range(1, 6)}
_DRO |= {15 + level: f"Lv{level}" for level in range(1, 6)}
# [stop] In hundredths.
_PANASONIC_HDR = {100 * stops: f"{stops} EV" for stops in range(1, 4)}
_PANASONIC_HDR |= {0x8000 + value: f"{text}, Auto" for value, text in _PANASONIC_HDR.items()}
# Canon's own program takes a contrast for on where this bit is set; ExifTool, ContrastInfo.
_CONTRAST_ON = {value: "on" for value in range(256) if value & 8}

_SETTINGS: Mapping[str, tuple[_Setting, ...]] = {
    "Nikon": (
        _Setting("Active D-Lighting", 0x22, _ACTIVE),
        _Setting("HDR", 0x35, {1: "on", 48: "Auto"}, 4, "B"),
    ),
    "Canon": (
        _Setting("Auto Lighting Optimizer", 0x4018, _OPTIMIZER_ON, 2, "i", sized=True),
        _Setting("Highlight Tone Priority", 0x4018, {1: "on", 2: "Enhanced"}, 3, "i", sized=True),
        _Setting("HDR", 0x4025, {1: "Auto", 2: "on"}, 1, "i", sized=True),
        _Setting("i-Contrast", 0x27, _CONTRAST_ON, 4, "H", sized=True),
    ),
    "Sony": (
        _Setting("Dynamic Range Optimizer", 0xB025, _DRO),
        _Setting("Dynamic Range Optimizer", 0xB04F, {1: "Standard", 2: "Plus"}),
        # Beside it some cameras keep one of the exposures, whose second number is 0.
        _Setting("HDR", 0x200A, dict.fromkeys(range(1, 4), "on"), 1, "H"),
    ),
    "Olympus": (
        _Setting("Gradation", 0x50F, {1: "Auto"}, 3, below=0x2020),
        _Setting("HDR", 0x804, {5: "HDR1", 6: "HDR2"}, below=0x2020),
    ),
    "Panasonic": (
        _Setting("Intelligent D-Range", 0x79, _LEVELS),
        _Setting("HDR", 0x9E, _PANASONIC_HDR),
    ),
    "Pentax": (
        _Setting("Highlight Correction", 0x69, {1: "on"}, 0, "B"),
        _Setting("Shadow Correction", 0x79, {1: "on", 2: "Auto"}, 0, "B"),
        _Setting("HDR", 0x85, {1: "Auto", 2: "1", 3: "2", 4: "3", 5: "Advanced"}, 0, "B"),
    ),
    "Fujifilm": (
        _Setting("D Range Priority", 0x1444, {1: "Weak", 2: "Strong", 3: "Plus"}),
        _Setting("D Range Priority", 0x1445, {1: "Weak", 2: "Strong"}),
    ),
    "Samsung": (_Setting("Smart Range", 0xA012, {1: "on"}),),
    "Ricoh": (
        _Setting("Dynamic Range Compensation", 0x100E, {3: "Weak", 4: "Medium", 5: "Strong"}),
    ),
}

# Canon's custom functions (ExifTool, CanonCustom::Functions2), of cameras before the EOS 7D, in
# groups of a tag of their own; and the models for which 1 is no `off`.
_CANON_CUSTOM, _TONE_PRIORITY, _OPTIMIZER = 0x99, 0x0203, 0x0204
_CANON_FOUR = re.compile(r"\b(50D|5D Mark II|500D|T1i|Kiss X3|1D Mark IV)\b")
_MOST_CUSTOM = 1024  # numbers that are looked at; a damaged file may claim any number of them
# Fujifilm: whether the range is chosen by the camera (0) or by hand (1), and both [%].
_FUJI_SETTING, _FUJI_BY = 0x1402, {0: (0x140B, "Auto, "), 1: (0x1403, "")}
_FUJI_WIDE = {0x200: "Wide 1", 0x201: "Wide 2"}  # 230 and 400 %
_FUJI_PLAIN = 100  # [%] a range as without


def adapted_by(exif: bytes) -> tuple[str, ...]:
    """What bends a photo's curve to its scene, such as `Active D-Lighting (Auto)`.

    Empty where all that is known is off, and where a file does not tell.
    """
    notes = maker_notes(exif)
    told: dict[str, str] = {}
    for setting in _SETTINGS.get(notes.maker, ()):
        value = setting.value(notes)
        if value is not None:
            told.setdefault(setting.name, setting.on.get(value, ""))
    for name, word in _OTHERS.get(notes.maker, _none)(notes):
        told.setdefault(name, word)
    return tuple(f"{name} ({word})" for name, word in told.items() if word)


def _none(_: MakerNotes) -> Iterator[tuple[str, str]]:
    return iter(())


def _by_fujifilm(notes: MakerNotes) -> Iterator[tuple[str, str]]:
    for chosen in notes.numbers(_FUJI_SETTING, 1):
        tag, how = _FUJI_BY.get(chosen, (0, ""))
        for percent in notes.numbers(tag, 1):
            yield "Dynamic Range", f"{how}{percent} %" if percent > _FUJI_PLAIN else ""
        yield "Dynamic Range", _FUJI_WIDE.get(chosen, "")


def _by_canon(notes: MakerNotes) -> Iterator[tuple[str, str]]:
    custom = dict(_custom_functions(notes))
    if custom.get(_TONE_PRIORITY) == 1:
        yield "Highlight Tone Priority", "on"
    optimizer = custom.get(_OPTIMIZER, -1)
    on = _OPTIMIZER_ON if _CANON_FOUR.search(notes.model) else {0: "Standard"}
    yield "Auto Lighting Optimizer", on.get(optimizer, "")


def _custom_functions(notes: MakerNotes) -> Iterator[tuple[int, int]]:
    """Tags and first numbers of custom functions: groups (number, bytes, count) of (tag, count)."""
    words = notes.numbers(_CANON_CUSTOM, _MOST_CUSTOM, "I")
    if words[:1] != (notes.size(_CANON_CUSTOM),):
        return
    at = 2  # behind the size of all and the count of groups
    while at + 3 <= len(words):
        end = at + 1 + words[at + 1] // 4
        entry = at + 3
        while entry + 2 < min(end, len(words)):
            yield words[entry], words[entry + 2] if words[entry + 1] else -1
            entry += 2 + words[entry + 1]
        at = max(end, at + 3)


_OTHERS: Mapping[str, Callable[[MakerNotes], Iterator[tuple[str, str]]]] = {
    "Canon": _by_canon,
    "Fujifilm": _by_fujifilm,
}
