"""Photos by a list of their names, as `--files-from` takes it from find, git and editors."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import click


def named_photos(text: bytes, source: Path, end: bytes) -> Iterator[Path]:
    """Yield the photos that a list names, relative to the source or absolute.

    Parameters
    ----------
    text
        Names, one a line.
    source
        Folder of the photos.
    end
        What each ends with, a line feed or NUL.

    Raises
    ------
    click.UsageError
        If a list of lines holds NUL, or a photo lies elsewhere.
    """
    root = Path(os.path.abspath(source))  # noqa: PTH100 - links are names, too
    if end == b"\n" and b"\0" in text:
        raise click.UsageError("the list of --files-from holds NUL; pass -0")
    for line in text.removeprefix(b"\xef\xbb\xbf").split(end):
        if line.strip(b"\r"):
            path = _named_path(root, line)
            if root not in path.parents:
                raise click.BadParameter(f"{path} is not below {source}")
            yield source / path.relative_to(root)


def _named_path(root: Path, line: bytes) -> Path:
    """A line's photo; of lists that Windows wrote a line's end has a byte too many."""
    path = Path(os.path.normpath(root / os.fsdecode(line)))
    if line.endswith(b"\r") and not os.path.lexists(path):
        return Path(os.path.normpath(root / os.fsdecode(line.removesuffix(b"\r"))))
    return path
