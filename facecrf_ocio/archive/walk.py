"""The photos of an archive, one after the other: the list is never held in memory."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

SUFFIXES = (
    *(".jpg", ".jpeg", ".jpe", ".jp2", ".png", ".tif", ".tiff", ".webp", ".bmp", ".gif", ".heic"),
    *(".heif", ".avif", ".exr", ".hdr", ".psd", ".tga", ".ppm", ".pgm", ".pnm", ".dng", ".nef"),
    *(".cr2", ".cr3", ".arw", ".raf", ".orf", ".rw2", ".pef", ".srw"),
)
"""What is taken for a photo where the user does not say; anything else takes an include glob."""


def photos_under(
    root: Path, include: Sequence[str] = (), exclude: Sequence[str] = ()
) -> Iterator[Path]:
    """Walk a folder in the order of names.

    Parameters
    ----------
    root
        The folder. Links to files are followed, links to folders are not.
    include, exclude
        Globs on the path relative to `root` or on the name alone, without regard to case.

    Raises
    ------
    OSError
        If a folder cannot be read.
    """
    for folder, below, names in os.walk(root, onerror=_raise):
        below[:] = sorted(
            name for name in below if not _matches(Path(folder, name).relative_to(root), exclude)
        )
        for name in sorted(names):
            path = Path(folder, name)
            relative = path.relative_to(root)
            if include:
                wanted = _matches(relative, include)
            else:
                wanted = path.suffix.lower() in SUFFIXES and not name.startswith("._")
            if wanted and not _matches(relative, exclude) and path.is_file():
                yield path


def _matches(relative: Path, globs: Sequence[str]) -> bool:
    texts = (relative.as_posix().lower(), relative.name.lower())
    return any(fnmatchcase(text, glob.lower()) for glob in globs for text in texts)


def _raise(error: OSError) -> None:
    raise error


def name_of(path: Path, root: Path) -> str:
    """Key of a photo in the manifest: its path below `root` with slashes, as UTF-8 text."""
    return os.fsencode(path.relative_to(root).as_posix()).decode("utf-8", "backslashreplace")
