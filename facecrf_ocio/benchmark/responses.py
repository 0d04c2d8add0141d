"""Measured camera responses to test with: Columbia's DoRF file or any .npz of inverse curves."""

from __future__ import annotations

import hashlib
import io
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from facecrf_ocio.errors import PhotoError, reason_of
from facecrf_ocio.response.dorf import GRID_SIZE, read_dorf_inverse
from facecrf_ocio.values import CHANNELS, Float, Index, frozen

_FAMILY_KEYS = ("maker", "family", "brand")
_END_TOLERANCE = 1e-6  # [1] from 0 and 1, above what single precision rounds


@dataclass(frozen=True, slots=True, eq=False)
class Responses:
    """Inverse camera responses of one file.

    Attributes
    ----------
    inverse
        (C, 3, 1024) linear light at uniform encoded values from 0 to 1; never decreasing.
    names
        C names, as the file has them or `row 0`, `row 1` ...
    families, kinds
        C names of makers, and of kinds of camera, or None where the file does not tell.
    path, sha256
        The file and the digest of its bytes.
    """

    inverse: Float
    names: tuple[str, ...]
    families: tuple[str, ...] | None
    path: Path
    sha256: str
    kinds: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "inverse", frozen(self.inverse))

    def family(self, row: int) -> str:
        """Name of a response's maker, empty where the file does not tell."""
        return "" if self.families is None else self.families[row]

    def kind(self, row: int) -> str:
        """A response's kind of camera, empty where the file does not tell."""
        return "" if self.kinds is None else self.kinds[row]

    def training_curves(self, rows: Index) -> Float:
        """Curves (N, 1024) of some responses to fit a model to; equal channels count once."""
        kept = []
        for response in self.inverse[rows]:
            gray = (response == response[0]).all()
            kept.append(response[:1] if gray else response)
        return np.concatenate(kept) if kept else np.empty((0, GRID_SIZE))


def read_responses(path: Path) -> Responses:
    """Read inverse responses.

    Parameters
    ----------
    path
        DoRF's .mat file, or an .npz with inverse curves (C, K) or (C, 3, K) at uniform encoded
        values in `inverse` or in its only array of such a shape; optionally `names` (C,), makers
        (C,) in `maker`, `family` or `brand`, and `kind` (C,) of camera.

    Raises
    ------
    PhotoError
        If the file cannot be read or holds no valid inverse responses.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        problem = reason_of(error)
        raise PhotoError(path, problem, "give a DoRF .mat file or an .npz of curves") from error
    sha256 = hashlib.sha256(content).hexdigest()
    if path.suffix.lower() == ".mat":
        curves = np.repeat(read_dorf_inverse(path)[:, None], len(CHANNELS), axis=1)
        return Responses(_checked(path, curves), _row_names(len(curves)), None, path, sha256)
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, AttributeError) as error:
        raise PhotoError(
            path, "is neither a DoRF .mat file nor an .npz of curves", "give one of these"
        ) from error
    curves = _checked(path, _curves(path, arrays))
    names = _texts(arrays, ("names", "name"), len(curves)) or _row_names(len(curves))
    makers, kinds = (_texts(arrays, keys, len(curves)) for keys in (_FAMILY_KEYS, ("kind",)))
    return Responses(curves, names, makers, path, sha256, kinds)


def spread_rows(count: int, every: int = 1, limit: int | None = None) -> tuple[int, ...]:
    """Rows to test: every n-th of `count`, of these at most `limit`, spread evenly."""
    rows = np.arange(0, count, every)
    if limit is None or limit >= len(rows):
        return tuple(rows.tolist())
    return tuple(rows[np.arange(limit) * len(rows) // limit].tolist())


def _curves(path: Path, arrays: dict[str, Float]) -> Float:
    """The array of inverse curves as (C, 3, K)."""
    fitting = [name for name, array in arrays.items() if _is_curves(array)]
    if "inverse" in fitting:
        fitting = ["inverse"]
    if len(fitting) != 1:
        raise PhotoError(
            path,
            f"has {len(fitting)} arrays that may be curves, none of them named inverse",
            "store the inverse curves (C, K) or (C, 3, K) under the name inverse",
        )
    curves = np.asarray(arrays[fitting[0]], dtype=np.float64)
    return np.repeat(curves[:, None], len(CHANNELS), axis=1) if curves.ndim == 2 else curves


def _is_curves(array: Float) -> bool:
    if array.dtype.kind not in "fiu" or array.ndim not in (2, 3) or 0 in array.shape:
        return False
    return array.shape[-1] > 2 and (array.ndim == 2 or array.shape[1] == len(CHANNELS))


def _checked(path: Path, curves: Float) -> Float:
    """Resample curves (N, C, K) to 1,024 values after refusing what is no inverse response."""
    ends = np.stack([curves[..., 0], curves[..., -1] - 1.0])
    good = (
        np.isfinite(curves).all(axis=(1, 2))
        & (np.diff(curves, axis=2) >= 0).all(axis=(1, 2))
        & (np.abs(ends) <= _END_TOLERANCE).all(axis=(0, 2))
    )
    if not good.all():
        raise PhotoError(
            path,
            f"row {int(np.argmin(good))} does not rise from 0 to 1",
            "give linear light at uniform code values, scaled to [0, 1]",
        )
    if curves.shape[2] == GRID_SIZE:
        return curves
    given, grid = np.linspace(0.0, 1.0, curves.shape[2]), np.linspace(0.0, 1.0, GRID_SIZE)
    return np.array([[np.interp(grid, given, channel) for channel in rgb] for rgb in curves])


def _texts(arrays: dict[str, Float], keys: tuple[str, ...], count: int) -> tuple[str, ...] | None:
    for key in keys:
        if key in arrays and arrays[key].shape == (count,):
            return tuple(str(text) for text in arrays[key])
    return None


def _row_names(count: int) -> tuple[str, ...]:
    return tuple(f"row {row}" for row in range(count))
