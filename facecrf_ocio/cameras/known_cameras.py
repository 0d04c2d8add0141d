"""One measured response: whose it is, how it was measured, and how sure it is."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import click
import numpy as np

from facecrf_ocio.cameras.maker_names import bare_model, maker_of
from facecrf_ocio.errors import FaceCRFError, LutError, OutputError
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.response.model import inverse_crf
from facecrf_ocio.values import CHANNELS, InverseCRF

POINTS = 256
"""Code values at which a registry keeps a curve."""
FORMAT = "facecrf cameras 1"


@dataclass(frozen=True, slots=True)
class KnownCamera:
    """A camera's measured response.

    Attributes
    ----------
    make, model, style
        As EXIF names them; style is what bent the curve to the measured scene, as `Photo.adapted`
        has it, and empty where nothing is known to have done so.
    method
        `pair`, `bracket` or `chart`.
    grade
        A (several sets agree), B, or C (one set, or an edited one).
    spread_stops
        Standard deviation of green over codes 32 to 235, in stops.
    proof
        What it was measured from: names and hashes of files, or the public sets of photos.
    linear
        (3, N) linear light at uniform code values; N is POINTS where we measured it ourselves.
    """

    make: str
    model: str
    style: str
    method: str
    grade: str
    spread_stops: float
    proof: str
    linear: tuple[tuple[float, ...], ...]

    @property
    def curve(self) -> InverseCRF:
        """The response, at 4096 code values."""
        linear = np.array(self.linear)
        return inverse_crf(np.linspace(0.0, 1.0, linear.shape[1]), linear)

    @property
    def key(self) -> tuple[str, ...]:
        """What makes two measurements the same one."""
        return (self.make, self.model, self.style, self.method, self.proof)


@cache
def shipped_cameras() -> tuple[KnownCamera, ...]:
    """Those that ship, from public exposure stacks and photos of charts (`cameras.fit_known`)."""
    path = Path(__file__).parent / "known.json"
    return _parsed(path, path.read_text(encoding="utf-8"))


def registry_path() -> Path:
    """The user's registry; FACECRF_CAMERAS names another."""
    named = os.environ.get("FACECRF_CAMERAS")
    return Path(named) if named else Path(click.get_app_dir("facecrf")) / "cameras.json"


def known_cameras() -> tuple[KnownCamera, ...]:
    """Those that ship, and the user's own."""
    return (*shipped_cameras(), *own_cameras())


_SENT: ContextVar[tuple[KnownCamera, ...] | None] = ContextVar("_SENT", default=None)


@contextmanager
def own_cameras_are(sent: tuple[KnownCamera, ...] | None) -> Iterator[None]:
    """Take these for the user's own within the block, whatever is in this machine's registry.

    Work for somebody elsewhere goes by that one's registry; None leaves this machine's.
    """
    token = _SENT.set(sent)
    try:
        yield
    finally:
        _SENT.reset(token)


def own_cameras() -> tuple[KnownCamera, ...]:
    """The user's own."""
    sent = _SENT.get()
    if sent is not None:
        return sent
    path = registry_path()
    try:
        changed = path.stat().st_mtime_ns
    except OSError:
        return ()
    return _own(path, changed)


@lru_cache(maxsize=4)
def _own(path: Path, changed: int) -> tuple[KnownCamera, ...]:  # noqa: ARG001 - is another then
    return read_registry(path)


def read_registry(path: Path) -> tuple[KnownCamera, ...]:
    """Read a registry; one that does not exist is empty.

    Raises
    ------
    LutError
        If it is no registry.
    """
    try:
        return _parsed(path, path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise LutError(
            f"{path}: cannot be read ({error.strerror}); check its permissions"
        ) from None


def write_registry(path: Path, cameras: Iterable[KnownCamera], *, overwrite: bool) -> None:
    """Write a registry, whole or not at all, its entries in order.

    Raises
    ------
    OutputError
        If it exists and `overwrite` is false, or it cannot be written.
    """
    ordered = sorted(cameras, key=lambda one: one.key)
    entries = [{**asdict(one), "linear": _without_repeats(one.linear)} for one in ordered]
    lines = ",\n".join(json.dumps(entry) for entry in entries)
    text = f'{{"format": "{FORMAT}", "cameras": [\n{lines}\n]}}\n'
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{path.parent}: the folder cannot be made ({error.strerror})") from error

    def check(written: Path) -> None:
        _parsed(path, written.read_text(encoding="utf-8"))

    write_files([Draft(path, text.encode(), check)], overwrite=overwrite)


def joined(one: Iterable[KnownCamera], other: Iterable[KnownCamera]) -> tuple[KnownCamera, ...]:
    """Entries of both; of the same measurement the other's."""
    return tuple({camera.key: camera for camera in (*one, *other)}.values())


def names_of(make: str, model: str) -> frozenset[str]:
    """All that files call one model: makers' JPEGs begin it with their name, raw files do not."""
    maker, bare = maker_of(make), bare_model(make, model.strip()).casefold()
    return frozenset({bare, f"{maker} {bare}".strip()})


def matching(cameras: Iterable[KnownCamera], make: str, model: str) -> tuple[KnownCamera, ...]:
    """Those of this make and model, the surest first. Makes are compared by their first word."""
    names, maker = names_of(make, model), maker_of(make)
    found = [
        one
        for one in cameras
        if names & names_of(one.make, one.model) and (maker_of(one.make) == maker or not make)
    ]
    return tuple(sorted(found, key=lambda one: (one.grade, one.spread_stops)))


def _without_repeats(linear: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    """One row for channels that are all alike."""
    return linear[:1] if len(set(linear)) == 1 else linear


def _of_channels(rows: Any) -> tuple[tuple[float, ...], ...]:
    """Three rows, of as many or of one that all channels share."""
    linear = tuple(map(tuple, rows))
    return linear * len(CHANNELS) if len(linear) == 1 else linear


def _parsed(path: Path, text: str) -> tuple[KnownCamera, ...]:
    try:
        stored: Any = json.loads(text)
        if stored["format"] != FORMAT:
            raise ValueError("another format")
        cameras = tuple(
            KnownCamera(**{**one, "linear": _of_channels(one["linear"])})
            for one in stored["cameras"]
        )
        for camera in cameras:
            _ = camera.curve
    except (ValueError, KeyError, TypeError, FaceCRFError):
        raise LutError(
            f"{path}: is no registry of cameras; give a file of facecrf cameras export"
        ) from None
    return cameras
