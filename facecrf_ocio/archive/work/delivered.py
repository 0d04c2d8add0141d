"""What a worker of another machine answered: checked, and its files written here."""

from __future__ import annotations

import hashlib

from facecrf_ocio.archive.task import FAILED, Result, Task
from facecrf_ocio.archive.work.parcel import Delivery
from facecrf_ocio.archive.work.worker_answer import checked
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.files.folders import make_folder
from facecrf_ocio.files.plain_text import plain_text


def accepted(task: Task, delivery: Delivery, *, shipped: bool) -> Result:
    """What a worker says came of a photo, if it can be; its files, if they were sent.

    `shipped`: they had to be.
    """
    try:
        result = checked(task, delivery.result)
        if not shipped and delivery.contents != ():
            raise ValueError("it sends files that nobody asked for")
        if shipped and not _is_whole(result, delivery.contents):
            raise ValueError("its files came damaged")
    except (ValueError, TypeError) as error:
        return odd_answer(str(error))
    return _written(task, result, delivery.contents) if delivery.contents else result


def odd_answer(problem: str) -> Result:
    """What is said of a photo whose answer cannot be believed."""
    remedy = "look at the cluster's workers, and start again"
    reason = f"a worker gave an answer that cannot be: {problem}"
    return Result(FAILED, reason=plain_text(reason), remedy=remedy, lasting=False)


def _is_whole(result: Result, contents: object) -> bool:
    """Whether the bytes of all outputs are there, and none else."""
    if not isinstance(contents, tuple) or len(contents) != len(result.outputs):
        return False
    return all(
        isinstance(content, bytes)
        and len(content) == output.size
        and hashlib.sha256(content).hexdigest() == output.sha256
        for output, content in zip(result.outputs, contents, strict=True)
    )


def _written(task: Task, result: Result, contents: tuple[bytes, ...]) -> Result:
    """Write what a worker sent."""
    from facecrf_ocio.archive.work.one_photo import failure_of  # noqa: PLC0415 - heavy

    try:
        paths = task.place.all_inside(output.name for output in result.outputs)
        make_folder(paths[0].parent)
        drafts = [
            Draft(path, content, lambda _: None)
            for path, content in zip(paths, contents, strict=True)
        ]
        write_files(drafts, overwrite=task.overwrite)
    except (OutputError, OSError) as error:
        return failure_of(error)
    return result
