"""Files that appear whole or not at all."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import ExistsError, OutputError, reason_of

_REMEDIES = {
    errno.ENOSPC: "free some space or write to another disk",
    errno.EDQUOT: "free some space or write to another disk",
    errno.EFBIG: "raise the limit on file size (ulimit -f)",
    errno.EACCES: "choose a folder you may write to",
    errno.EPERM: "choose a folder you may write to",
    errno.EROFS: "choose a folder you may write to",
    errno.ENOENT: "create the folder first",
    errno.ENOTDIR: "choose a folder, not a file",
    errno.ENAMETOOLONG: "choose a shorter name",
}
_NO_FOLDER_SYNC = (errno.EACCES, errno.EINVAL, errno.ENOTSUP, errno.EPERM, errno.EISDIR)


@dataclass(frozen=True, slots=True)
class Draft:
    """A file to be written.

    Attributes
    ----------
    target
        Where it shall appear.
    content
        Its bytes; or a function that writes them to the path of an empty file, the temporary one.
    check
        Called with the path of the finished temporary file, which lies in the target's folder and
        has the target's suffix; what it raises keeps the file from appearing.
    """

    target: Path
    content: bytes | Callable[[Path], None]
    check: Callable[[Path], None]


def write_files(drafts: Sequence[Draft], *, overwrite: bool = False) -> tuple[Path, ...]:
    """Write all drafts, or none of them.

    Every file is written under a temporary name, flushed to the disk and checked before the first
    one gets its name. If naming one fails, those already named are taken back, and the files they
    replaced are restored where the file system has hard links.

    Raises
    ------
    ExistsError
        If a target exists and `overwrite` is false, also if it came to exist meanwhile.
    OutputError
        If a target is not a regular file, or if the system refuses to write it.
    """
    for draft in drafts:
        require_free(draft.target, overwrite=overwrite)
    with ExitStack() as leftovers:
        temporaries = []
        for draft in drafts:
            temporary = _temporary_name(draft.target)
            leftovers.callback(_remove, temporary)
            with _naming(draft.target):
                _write(temporary, draft.content)
            draft.check(temporary)
            temporaries.append(temporary)
        _publish_all(tuple(zip(temporaries, drafts, strict=True)), overwrite, leftovers)
    return tuple(draft.target for draft in drafts)


def require_free(target: Path, *, overwrite: bool) -> None:
    """Raise ExistsError or OutputError unless a file may be written at `target`."""
    with _naming(target):
        taken = os.path.lexists(target)
        if taken and target.exists() and not target.is_file():
            raise OutputError(f"{target}: is not a regular file; choose another name")
    if taken and not overwrite:
        raise ExistsError(target)


def _temporary_name(target: Path) -> Path:
    # The suffix stays, because OCIO chooses its reader by it; the stem goes, because the user's
    # may be as long as the file system allows.
    return target.parent / f".facecrf-{os.urandom(8).hex()}{target.suffix.lower()}"


def _write(path: Path, content: bytes | Callable[[Path], None]) -> None:
    descriptor = os.open(
        path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666
    )
    with os.fdopen(descriptor, "wb") as stream:
        if not callable(content):
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
            return
    content(path)
    with path.open("rb+") as stream:  # anew, in case the writer replaced the file
        os.fsync(stream.fileno())


def _publish_all(
    staged: Sequence[tuple[Path, Draft]], overwrite: bool, leftovers: ExitStack
) -> None:
    with ExitStack() as undo:
        for temporary, draft in staged:
            with _naming(draft.target):
                if overwrite:
                    _replace(temporary, draft.target, undo, leftovers)
                else:
                    _link(temporary, draft.target)
                    undo.callback(_remove, draft.target)
        for folder in {draft.target.parent for _, draft in staged}:
            with _naming(folder):
                _sync_folder(folder)
        undo.pop_all()


def _replace(temporary: Path, target: Path, undo: ExitStack, leftovers: ExitStack) -> None:
    former = _temporary_name(target)
    with suppress(OSError, NotImplementedError):  # no former file, or no hard links
        os.link(target, former, follow_symlinks=False)
        leftovers.callback(_remove, former)
    temporary.replace(target)
    undo.callback(_restore, former, target)


def _restore(former: Path, target: Path) -> None:
    try:
        former.replace(target)
    except OSError:
        _remove(target)


def _link(temporary: Path, target: Path) -> None:
    """Give a file its name without ever replacing another, which `rename` would."""
    try:
        os.link(temporary, target)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links: reserve the name, then take it
        os.close(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            temporary.replace(target)
        except BaseException:
            _remove(target)
            raise


def _sync_folder(folder: Path) -> None:
    """Make the new names survive a power cut, where the system lets folders be flushed."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
    except OSError as error:
        if error.errno not in _NO_FOLDER_SYNC:
            raise


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink()


@contextmanager
def _naming(target: Path) -> Iterator[None]:
    """Turn the system's error into one line that names the target and what to do."""
    try:
        yield
    except FileExistsError as error:
        raise ExistsError(target, f"cannot be written: {reason_of(error)}") from error
    except OSError as error:
        problem = reason_of(error)
        remedy = _REMEDIES.get(error.errno or 0, "choose another folder")
        raise OutputError(f"{target}: cannot be written: {problem}; {remedy}") from error
