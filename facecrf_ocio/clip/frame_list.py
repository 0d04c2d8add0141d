"""Frames in the order of time, and a way to read them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.values import Photo


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """Frames in the order of time.

    Attributes
    ----------
    path
        Of the video file, or of the first frame.
    name
        What outputs are named after: the video file's, or the frames' without their numbers.
    times
        [s] of each frame, from 0.
    names
        Of each frame, for messages and for files written of it.
    rate
        [1/s] Frames a second.
    read
        Gives photos of the frames at these indices, in rising order.
    notes
        What there is to say of the file, in sentences.
    motion_jpeg
        Whether it is a video whose frames are JPEGs.
    """

    path: Path
    name: str
    times: tuple[float, ...]
    names: tuple[str, ...]
    rate: float
    read: Callable[[Sequence[int]], Iterator[Photo]]
    notes: tuple[str, ...] = ()
    motion_jpeg: bool = False


def in_one_size(photos: Iterable[Photo]) -> Iterator[Photo]:
    """Frames as they come, of which one of another size raises PhotoError."""
    size: tuple[int, ...] = ()
    for photo in photos:
        if size not in ((), photo.shape):
            raise PhotoError(
                photo.path,
                f"has {photo.shape[1]} x {photo.shape[0]} pixels, frames before it "
                f"{size[1]} x {size[0]}",
                "give the frames of one clip",
            )
        size = photo.shape
        yield photo
