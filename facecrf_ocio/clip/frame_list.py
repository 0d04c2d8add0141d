"""Frames in the order of time, and a way to read them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import counted, plain_text
from facecrf_ocio.values import Photo

_MOST_NAMED = 8  # frames that cannot be read; of more the others are counted


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
        Gives the frames at these indices, in rising order, but for those that cannot be read: each
        index with its photo.
    notes
        What there is to say of the file, in sentences.
    motion_jpeg
        Whether it is a video whose frames are JPEGs.
    unread
        Of the frames that could not be read so far what is wrong, by their indices.
    """

    path: Path
    name: str
    times: tuple[float, ...]
    names: tuple[str, ...]
    rate: float
    read: Callable[[Sequence[int]], Iterator[tuple[int, Photo]]]
    notes: tuple[str, ...] = ()
    motion_jpeg: bool = False
    unread: dict[int, PhotoError] = field(default_factory=dict)

    def first(self, indices: Sequence[int]) -> Photo:
        """The first of some frames that can be read.

        Raises
        ------
        PhotoError
            If there is none.
        """
        for _, photo in self.read(indices):
            return photo
        raise self.unread[indices[0]]

    def left_out(self) -> str:
        """Which frames could not be read so far, and why not the first; empty if all could."""
        if not self.unread:
            return ""
        indices = sorted(self.unread)
        named = ", ".join(plain_text(self.names[one]) for one in indices[:_MOST_NAMED])
        more = len(indices) - _MOST_NAMED
        others = f" and {more} more" if more > 0 else ""
        first = "" if len(indices) == 1 else "the first "
        problem = self.unread[indices[0]].problem
        return f"{counted(len(indices), 'frame')} cannot be read: {named}{others}; {first}{problem}"


def in_one_size(frames: Iterable[tuple[int, Photo]]) -> Iterator[tuple[int, Photo]]:
    """Frames as they come, of which one of another size raises PhotoError."""
    size: tuple[int, ...] = ()
    for index, photo in frames:
        if size not in ((), photo.shape):
            raise PhotoError(
                photo.path,
                f"has {photo.shape[1]} x {photo.shape[0]} pixels, frames before it "
                f"{size[1]} x {size[0]}",
                "give the frames of one clip",
            )
        size = photo.shape
        yield index, photo
