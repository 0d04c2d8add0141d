"""What keeps a photo's outputs from being written, told before the photo is worked on."""

from __future__ import annotations

import os
from collections.abc import Callable

from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.task import FAILED, Result, Task
from facecrf_ocio.errors import OVERWRITE, OutputError
from facecrf_ocio.files.plain_text import plain_text

Alike = Callable[[str, str], bool]
_LONGEST = 255  # [byte] what most file systems take, where this one does not tell


def in_the_way(manifest: Manifest, task: Task, alike: Alike) -> Result | None:
    """Why a photo's outputs cannot be written, None if they can.

    Such a failure is not the photo's own, so that every run tries it anew.

    Parameters
    ----------
    manifest
        Its outputs may be replaced by those of the same photo.
    task
        `overwrite`: also files that are no outputs may be replaced.
    alike
        Whether the file system takes two names for one.
    """
    problem = _too_long(task)
    try:
        for planned in task.planned:
            problem = problem or _owned(manifest, task, planned, alike)
        if problem is not None:
            return problem
        for planned, path in zip(task.planned, task.place.all_inside(task.planned), strict=True):
            if not os.path.lexists(path):
                continue
            if path.exists() and not path.is_file():
                return _failure(f"{path}: is not a regular file", "move it away, and start again")
            if not task.overwrite and not _ours(manifest, planned):
                wrong = f"{path}: exists already"
                return _failure(wrong, OVERWRITE)
    except OutputError as error:
        return Result(FAILED, reason=plain_text(str(error)), lasting=False)
    return None


def _failure(reason: str, remedy: str) -> Result:
    return Result(FAILED, reason=plain_text(reason), remedy=remedy, lasting=False)


def _ours(manifest: Manifest, planned: str) -> bool:
    return any(name == planned for name, _ in manifest.owners(planned))


def _owned(manifest: Manifest, task: Task, planned: str, alike: Alike) -> Result | None:
    for name, photo in manifest.owners(planned):
        if photo != task.name and alike(name, planned):
            return _failure(
                f"its output {planned} would be the file {name} of {photo}",
                "rename one of them, or write them to two folders",
            )
    return None


def _too_long(task: Task) -> Result | None:
    size = max(len(os.fsencode(planned.rpartition("/")[2])) for planned in task.planned)
    try:
        longest = os.pathconf(task.place.folder, "PC_NAME_MAX")
    except (OSError, ValueError):
        longest = _LONGEST
    if size <= longest:
        return None
    return _failure(
        f"an output would have a name of {size} bytes, {size - longest} more than the disk takes",
        "shorten its name",
    )
