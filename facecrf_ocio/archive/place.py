"""The folders of a run: apart, locked, still where they were, and nothing written outside."""

from __future__ import annotations

import fcntl
import os
import unicodedata
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import OutputError, PhotoError, reason_of
from facecrf_ocio.files.folders import real_path

LOCK = "facecrf-manifest.lock"
TEMPORARY = ".facecrf-"
MOUNT = "mount it, or check the name, and start again"
_NO_LINK = os.O_NOFOLLOW | os.O_CLOEXEC
_PROBE = f"{TEMPORARY}Ä-"  # a letter that has another case, and another composition


@dataclass(frozen=True, slots=True)
class Place:
    """The folder of outputs, as it was when the run began.

    Attributes
    ----------
    folder
        As the user names it.
    real
        Where it truly is, without links.
    identity
        Device and inode; None on another machine, which has others.
    """

    folder: Path
    real: Path
    identity: tuple[int, int] | None = None

    @classmethod
    def of(cls, folder: Path) -> Place:
        """The place that a folder is now."""
        return cls(folder, real_path(folder), _identity(folder))

    def inside(self, name: str) -> Path:
        """Path of an output, which may be written or removed: links on the way lead nowhere else.

        Raises
        ------
        OutputError
            If it lies elsewhere, or the folder is not the one it was.
        """
        return self.all_inside((name,))[0]

    def all_inside(self, names: Iterable[str]) -> list[Path]:
        """Paths of several outputs, as `inside` gives each; every folder is looked at once.

        Raises
        ------
        OutputError
            If one leads out of the folder, or that is no longer the one that it was.
        """
        self.require()
        paths = [self.folder / name for name in names]
        holds = {folder: self._holds(real_path(folder)) for folder in {p.parent for p in paths}}
        for path in paths:
            if path.name in ("", "..") or not holds[path.parent]:
                raise OutputError(
                    f"{path}: leads out of {self.folder}; remove the link, or name another folder"
                )
        return paths

    def _holds(self, real: Path) -> bool:
        return real == self.real or self.real in real.parents

    def require(self) -> None:
        """Raise OutputError unless the folder is the one it was."""
        moved = real_path(self.folder) != self.real
        if moved or (self.identity is not None and _identity(self.folder) != self.identity):
            raise OutputError(f"{self.folder}: is no longer the folder it was; {MOUNT}")

    def remove(self, names: Iterable[str]) -> None:
        """Remove outputs that are there.

        Raises
        ------
        OutputError
            As `inside` does; then what is left of them is not looked at.
        """
        for name in names:
            path = self.inside(name)
            with suppress(OSError):
                path.unlink()

    def clear(self, names: Iterable[str]) -> None:
        """Remove temporary files of a run that was killed, where outputs of these names lie."""
        for place in {self.inside(name).parent for name in names}:
            for leftover in place.glob(f"{TEMPORARY}*"):
                leftover.unlink(missing_ok=True)

    def clear_all(self) -> None:
        """Remove temporary files of workers that were lost; their photos were done again."""
        for place, _, names in os.walk(self.folder):
            for name in names:
                if name.startswith(TEMPORARY):
                    Path(place, name).unlink(missing_ok=True)

    def alike(self) -> Callable[[str, str], bool]:
        """Return how the file system compares names: with or without case and composition.

        Raises
        ------
        OutputError
            If nothing can be written to the folder.
        """
        probe = self.folder / f"{_PROBE}{os.urandom(4).hex()}"
        try:
            probe.touch(exist_ok=False)
        except OSError as error:
            raise OutputError(
                f"{self.folder}: cannot be written: {reason_of(error)}; "
                "choose a folder you may write to"
            ) from error
        try:
            no_case = probe.with_name(probe.name.swapcase()).exists()
            composes = probe.with_name(unicodedata.normalize("NFD", probe.name)).exists()
        finally:
            probe.unlink(missing_ok=True)
        return lambda one, other: _seen(one, no_case, composes) == _seen(other, no_case, composes)


def _seen(name: str, no_case: bool, composes: bool) -> str:
    name = unicodedata.normalize("NFC", name) if composes else name
    return name.casefold() if no_case else name


def _identity(folder: Path) -> tuple[int, int] | None:
    try:
        status = folder.stat()
    except OSError:
        return None
    return status.st_dev, status.st_ino


def source_identity(source: Path) -> tuple[int, int]:
    """Device and inode of the photos' folder: another file system mounted, or none, has others.

    Raises
    ------
    PhotoError
        If it is not there, or is not a folder.
    """
    identity = _identity(source)
    if identity is None:
        raise PhotoError(source, "is not there", MOUNT)
    if not source.is_dir():
        raise PhotoError(source, "is not a folder", "name the folder of the photos")
    return identity


def require_apart(source: Path, folder: Path) -> None:
    """Raise OutputError if outputs would lie among the photos, or photos among the outputs."""
    here, there = real_path(source), real_path(folder)
    if here == there:
        raise OutputError(f"{folder}: is the folder of the photos; write to one of its own")
    if here in there.parents or there in here.parents:
        raise OutputError(
            f"{folder}: lies inside of {source}, or around it; write to a folder of its own"
        )


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder; the lock ends with the process, however that ends.

    Raises
    ------
    OutputError
        If the folder cannot be written to, or another run is in it.
    """
    try:
        descriptor = os.open(folder / LOCK, os.O_WRONLY | os.O_CREAT | _NO_LINK, 0o666)
    except OSError as error:
        reason = reason_of(error)
        problem = f"{folder}: cannot be written: {reason}; choose a folder you may write to"
        raise OutputError(problem) from error
    try:
        _lock(descriptor, folder)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise OutputError(f"{folder}: another run is at work there; wait for it") from None
    except OSError as error:
        raise OutputError(
            f"{folder}: cannot be locked: {reason_of(error)}; choose a folder on another disk"
        ) from error
