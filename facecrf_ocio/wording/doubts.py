"""What speaks against a curve, in words, and what can lift each of these doubts.

Records keep a doubt as its words, so its kind is told by a clause that all of that kind have.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from enum import StrEnum


class Remedy(StrEnum):
    """What makes a curve surer; each surface has its own words for it."""

    TOGETHER = "more photos of the camera"
    PAIR = "a raw file of the camera beside its JPEG, or a bracket"
    RAW = "the photo's own raw file"
    ORIGINAL = "the picture before a program changed it"
    OFF = "photos without what bent the curve"
    PERSON = "a photo of a person"
    ONE_CAMERA = "photos of one camera alone"


_NOT_SINGLE = "perhaps no single curve: "
_BENT = " bent it to the scene"
_ANOTHER_STYLE = ": another picture style, or edited"
_ONE_CURVE = "but one curve is of one camera: "

# What lifts a doubt that has the clause, the easiest first; of several clauses the first counts.
# More photos of the camera make the band narrower, and lift none of these.
_LIFTED_BY = {
    _BENT: (Remedy.OFF, Remedy.RAW),
    "the camera treated places unlike each other": (Remedy.OFF, Remedy.RAW),
    "strays from every single curve": (Remedy.RAW,),
    "no camera took it": (Remedy.ORIGINAL,),
    "sees nobody's face": (Remedy.PERSON, Remedy.RAW),
    _NOT_SINGLE: (Remedy.ORIGINAL, Remedy.RAW),
    _ANOTHER_STYLE: (Remedy.RAW,),
    _ONE_CURVE: (Remedy.ONE_CAMERA,),
}


def not_single(found: Iterable[str]) -> tuple[str, ...]:
    """Doubts that any one curve of a camera made a photo, by what was found."""
    return tuple(f"{_NOT_SINGLE}{one}" for one in found)


def bent_by(adapted: Iterable[str]) -> tuple[str, ...]:
    """The doubt where cameras bent curves to scenes, by the settings that did; none without."""
    what = ", ".join(dict.fromkeys(adapted))
    return not_single([f"{what}{_BENT}"] if what else [])


def is_bent(doubts: Collection[str]) -> bool:
    """Whether one of the doubts is that a setting bent the curve."""
    return any(_BENT in doubt for doubt in doubts)


def contradicted(photos: int, measurement: str) -> str:
    """The doubt where photos contradict what was measured of their camera."""
    who = "the photo contradicts" if photos == 1 else "the photos contradict"
    return f"{who} {measurement}{_ANOTHER_STYLE}"


def of_several_cameras(number: int, some: str) -> str:
    """The doubt where photos of one curve name several cameras."""
    return f"the photos name {number} cameras, {_ONE_CURVE}{some}"


def lifted_by(doubts: Iterable[str]) -> tuple[tuple[Remedy, ...], ...]:
    """Ways to make a curve with these doubts surer, the easiest first; a way takes all it names.

    What lifts every doubt; where nothing does, what lifts each. A band that is wide, or a face that
    is too dark, more photos lift.
    """
    each = [_lifts(doubt) for doubt in doubts]
    each = [remedies for remedies in each if remedies] or [(Remedy.TOGETHER, Remedy.PAIR)]
    shared = tuple((one,) for one in each[0] if all(one in remedies for remedies in each))
    return shared or (tuple(dict.fromkeys(remedies[0] for remedies in each)),)


def _lifts(doubt: str) -> tuple[Remedy, ...]:
    """None of a doubt that more photos lift."""
    return next((remedies for clause, remedies in _LIFTED_BY.items() if clause in doubt), ())
