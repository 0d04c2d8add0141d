"""The photos of an archive, one after the other: the list is never held in memory."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from facecrf_ocio.errors import PhotoError, reason_of
from facecrf_ocio.photo.suffixes import PHOTO_SUFFIXES


def photos_under(
    root: Path, include: Sequence[str] = (), exclude: Sequence[str] = ()
) -> Iterator[Path]:
    """Walk a folder in the order of names.

    A folder below it that cannot be read is given in place of its photos, and so are links that
    lead nowhere: whoever looks at them finds what is wrong.

    Parameters
    ----------
    root
        The folder. Links to files are followed, links to folders are not.
    include, exclude
        Globs on the path relative to `root` or on the name alone, without regard to case. Without
        any to include, the files of `photo.suffixes.PHOTO_SUFFIXES` are.

    Raises
    ------
    PhotoError
        If the folder itself cannot be read.
    """
    unread: list[OSError] = []
    for folder, below, names in os.walk(root, onerror=unread.append):
        yield from _places(unread, root)
        below[:] = sorted(
            name for name in below if not _matches(Path(folder, name).relative_to(root), exclude)
        )
        for name in sorted(names):
            path = Path(folder, name)
            relative = path.relative_to(root)
            if include:
                wanted = _matches(relative, include)
            else:
                wanted = path.suffix.lower() in PHOTO_SUFFIXES and not name.startswith("._")
            if wanted and not _matches(relative, exclude) and _may_be_photo(path):
                yield path
    yield from _places(unread, root)


def _places(unread: list[OSError], root: Path) -> Iterator[Path]:
    """Take out the folders that could not be read."""
    while unread:
        error = unread.pop()
        place = Path(error.filename)
        if place == root:
            problem = f"cannot be read: {reason_of(error)}"
            raise PhotoError(root, problem, "mount it, or allow reading it, and start again")
        yield place


def _may_be_photo(path: Path) -> bool:
    """Whether it is a file, or cannot be looked at; devices, pipes and folders are no photos."""
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return True


def _matches(relative: Path, globs: Sequence[str]) -> bool:
    texts = (relative.as_posix().lower(), relative.name.lower())
    return any(fnmatchcase(text, glob.lower()) for glob in globs for text in texts)


def name_of(path: Path, root: Path) -> str:
    """Key of a photo in the manifest: its path below `root` with slashes, as UTF-8 text."""
    return as_utf8(path.relative_to(root).as_posix())


def as_utf8(text: str) -> str:
    r"""Text that may hold names of files, their bytes that are not UTF-8 written as `\xe9`."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
