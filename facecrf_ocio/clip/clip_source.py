"""What a clip is: frames with times, from a numbered sequence, a folder or a video file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from facecrf_ocio.clip.frame_list import Clip, in_one_size
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.photo.containers.suffixes import suffixes_named
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo

DEFAULT_RATE = 24.0  # [1/s] of a sequence, which does not tell
_IMAGES = suffixes_named("JPEG", "PNG", "TIFF", "DPX", "WebP", "BMP", "OpenEXR")
_VIDEOS = (".mp4", ".mov", ".m4v", ".mkv", ".avi", ".mxf", ".webm", ".mts", ".m2ts", ".mpg", ".ts")
_PATTERN = re.compile(r"%0?(\d*)d|#+")
_NUMBER = re.compile(r"(\d+)(?=\D*$)")


def open_clip(given: Path) -> Clip:
    """Find the frames of a clip.

    Parameters
    ----------
    given
        A video file, a folder of images, or a pattern such as `frame.%04d.jpg`, `frame.####.png`.

    Raises
    ------
    PhotoError
        If there is no such thing, or fewer than two frames.
    """
    if given.is_file() and given.suffix.lower() in _VIDEOS:
        from facecrf_ocio.clip.video import open_video  # noqa: PLC0415 -- an extra

        clip = open_video(given)
    elif given.is_dir():
        clip = _sequence(given, sorted(_images(given), key=_order), given.name)
    elif _PATTERN.search(given.name):
        clip = _sequence(given, _matching(given), _without_number(given.name))
    elif given.exists():
        raise PhotoError(
            given,
            "is one picture, and no clip",
            "give a pattern such as frame.%04d.jpg, a folder "
            "or a video file; for one photo use facecrf calibrate",
        )
    else:
        raise PhotoError(given, "does not exist", "check the name")
    if not clip.times:
        raise PhotoError(given, "has no frames", "check the folder, the suffix and the digits")
    if len(clip.times) < 2:
        raise PhotoError(given, "has one frame, and is no clip", "use facecrf calibrate")
    return clip


def _images(folder: Path) -> list[Path]:
    return [p for p in folder.iterdir() if p.suffix.lower() in _IMAGES and p.is_file()]


def _matching(given: Path) -> list[Path]:
    """Files whose names have a number where the pattern has its place, in the number's order."""
    found = _PATTERN.search(given.name)
    if found is None or not given.parent.is_dir():
        return []
    digits = len(found[0]) if found[0].startswith("#") else int(found[1] or 1)
    before, after = given.name[: found.start()], given.name[found.end() :]
    one = re.compile(re.escape(before) + rf"(\d{{{digits},}})" + re.escape(after))
    numbered = [(int(m[1]), p) for p in given.parent.iterdir() if (m := one.fullmatch(p.name))]
    return [path for _, path in sorted(numbered)]


def _without_number(pattern: str) -> str:
    """`a.v2.jpg` of `a.v2.####.jpg`, so that a sequence's name tells its kind, as a file's does."""
    before, _, after = _PATTERN.split(pattern, maxsplit=1)
    return (before.rstrip("._- ") or "clip") + after


def _order(path: Path) -> tuple[str, int, str]:
    found = _NUMBER.search(path.stem)
    number = int(found[1]) if found else -1
    return (path.stem[: found.start()] if found else path.stem, number, path.name)


def _sequence(given: Path, paths: Sequence[Path], name: str) -> Clip:
    unread: dict[int, PhotoError] = {}

    def readable(indices: Sequence[int]) -> Iterator[tuple[int, Photo]]:
        for index in indices:
            try:
                yield index, read_photo(paths[index])
            except PhotoError as error:
                unread[index] = error

    def read(indices: Sequence[int]) -> Iterator[tuple[int, Photo]]:
        return in_one_size(readable(indices))

    return Clip(
        paths[0] if paths else given,
        name.strip("._- ") or "clip",
        tuple(index / DEFAULT_RATE for index in range(len(paths))),
        tuple(path.name for path in paths),
        DEFAULT_RATE,
        read,
        _gaps(paths),
        unread=unread,
    )


def _gaps(paths: Sequence[Path]) -> tuple[str, ...]:
    """What there is to say of numbers that are missing; nothing where names have several stems."""
    orders = [_order(path) for path in paths]
    if not orders or len({order[0] for order in orders}) > 1 or orders[0][1] < 0:
        return ()
    steps = [(one[1], other[1]) for one, other in pairwise(orders) if other[1] - one[1] > 1]
    missing = sum(after - before - 1 for before, after in steps)
    if not 0 < missing < len(paths):  # of a few frames among many numbers nothing is missing
        return ()
    first, last = steps[0][0] + 1, steps[0][1] - 1
    which = f"{first}" if first == last else f"{first} to {last}"
    more = " and others" if len(steps) > 1 else ""
    are = "is" if missing == 1 else "are"
    return (
        f"{counted(missing, 'frame')} {are} missing ({which}{more}): those that are there are "
        "taken to follow one another",
    )
