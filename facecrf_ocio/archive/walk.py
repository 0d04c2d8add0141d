"""The photos of an archive, one after the other: the list is never held in memory."""

from __future__ import annotations

import os
import stat
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from facecrf_ocio.errors import PhotoError, reason_of
from facecrf_ocio.photo.containers.suffixes import PHOTO_SUFFIXES

OTHER_SOFTWARE = (
    *("@eaDir", "#recycle", "#snapshot"),  # Synology
    *("@Recycle", "@Recently-Snapshot", ".@__thumb", ".@upload_cache"),  # QNAP
    *(".Trash", ".Trash-*", ".Trashes", "$RECYCLE.BIN", "RECYCLER", "lost+found"),  # systems' bins
    *(".snapshot", ".snapshots", ".zfs", "~snapshot"),  # snapshots of storage
    *(".thumbnails", ".thumbs", ".AppleDouble", ".Spotlight-V100", ".fseventsd"),
    *(".TemporaryItems", "System Volume Information"),
)
"""Folders in which systems and storage keep thumbnails, deleted photos and former versions."""


@dataclass(slots=True)
class Passed:
    """What a walk passed over, with its number: folders and links to some by name, other files."""

    folders: Counter[str] = field(default_factory=Counter)
    links: Counter[str] = field(default_factory=Counter)
    suffixes: Counter[str] = field(default_factory=Counter)


def photos_under(
    root: Path,
    include: Sequence[str] = (),
    exclude: Sequence[str] = (),
    *,
    all_folders: bool = False,
    passed: Passed | None = None,
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
    all_folders
        Also look into folders like `OTHER_SOFTWARE`.
    passed
        Gets what is passed over without having been excluded.

    Raises
    ------
    PhotoError
        If the folder itself cannot be read.
    """
    passed = passed or Passed()
    unread: list[OSError] = []
    for folder, below, names in os.walk(root, onerror=unread.append):
        yield from _places(unread, root)
        here = Path(folder)
        below[:] = sorted(
            name for name in below if not _matches((here / name).relative_to(root), exclude)
        )
        if not all_folders:
            others = [name for name in below if _matches(Path(name), OTHER_SOFTWARE)]
            passed.folders.update(others)
            below[:] = [name for name in below if name not in others]
        passed.links.update(name for name in below if (here / name).is_symlink())
        for name in sorted(names):
            path = here / name
            relative = path.relative_to(root)
            if _matches(relative, exclude):
                continue
            if not _is_wanted(relative, include):
                passed.suffixes[path.suffix.lower()] += 1
            elif _may_be_photo(path):
                yield path
    yield from _places(unread, root)


def _is_wanted(relative: Path, include: Sequence[str]) -> bool:
    if include:
        return _matches(relative, include)
    # A name that begins so is what macOS keeps beside a file on other file systems.
    return relative.suffix.lower() in PHOTO_SUFFIXES and not relative.name.startswith("._")


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
    """Name of a photo: its path below `root`, with slashes."""
    return path.relative_to(root).as_posix()


def as_utf8(text: str) -> str:
    r"""Text that may hold names of files, their bytes that are not UTF-8 written as `\xe9`."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
