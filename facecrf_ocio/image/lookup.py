"""Sending pixels through a transform as fast as their type allows: codes by table, else in threads.

Integers and half floats have at most 65,536 different values, so a transform that keeps channels
apart is asked once for each of them, and the pixels are looked up in the answers. The rest goes
through the transform itself, a band of rows at a time, on all cores.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import LutError, SettingsError
from facecrf_ocio.files.threads import usable_cores
from facecrf_ocio.image.by_table import (
    numpy_look_up,
    opencv_look_up,
    opencv_looks_up_16_bits,
)
from facecrf_ocio.image.pixel_types import HALF_MAX, MAXIMA, as_float, as_half, every_value
from facecrf_ocio.image.reach import bring_back, some_lost
from facecrf_ocio.values import InverseCRF

Pixels = npt.NDArray[Any]
Float32 = npt.NDArray[np.float32]
Transform = Callable[[Float32, Pixels], None]
"""Maps (H, W, 3) C-contiguous float32 to the like-shaped second argument, float32 or float16."""

_RGB = (0, 1, 2)  # channels
_BAND = 1 << 19  # [pixel] 6 MB of float32 colors; a call for fewer costs more than the cache spares


class Lookup:
    """A transform of RGB, applied by tables where that gives the same.

    Parameters
    ----------
    transform
        What to apply.
    separable
        Whether each channel of the result depends on that channel alone. Without it there are no
        tables.
    name
        What to call the transform in the error for codes that become NaN or infinite; None passes
        such results on. Of a transform with a name, colors beyond the codes that become so are
        taken for the brightest, or darkest, on the way there from the codes that do not.
    """

    def __init__(
        self, transform: Transform, *, separable: bool = True, name: str | None = None
    ) -> None:
        self.separable = separable
        self._transform = transform
        self._name = name
        self._tables: dict[tuple[object, ...], _Table] = {}
        self._has_cut = False

    @property
    def has_cut(self) -> bool:
        """Whether half floats were asked for light above 65504 so far, and got 65504."""
        return self._has_cut

    def apply(
        self,
        pixels: Pixels,
        *,
        dtype: npt.DTypeLike = np.float32,
        out: Pixels | None = None,
        maximum: int | None = None,
        color: Sequence[int] = _RGB,
        alpha: int | None = None,
    ) -> Pixels:
        """Transform the color channels of an image; the others keep their values.

        Parameters
        ----------
        pixels
            (H, W, C) uint8, uint16, float16 or float32.
        dtype
            Of the result: float16, whose colors are clamped to 65504, or float32.
        out
            (H, W, C) of one of these types, written to and returned; `dtype` is then ignored.
        maximum
            The integer code that stands for 1; by default the largest of the type.
        color
            Indices of R, G and B, or of one gray channel.
        alpha
            Index of the channel that colors are multiplied by: they are divided by it before the
            transform and multiplied after it, except where it is 0. None where they are not.

        Returns
        -------
        numpy.ndarray
            (H, W, C).

        Raises
        ------
        SettingsError
            If types or shapes are none of these, or gray is sent through unlike curves.
        LutError
            If a code from 0 to 1 becomes NaN or infinite and the transform has a name.
        """
        out = np.empty(pixels.shape, dtype) if out is None else out
        _check(pixels, out, color)
        if out.size == 0:
            return out
        work = _Work(maximum or MAXIMA.get(pixels.dtype, 1), tuple(color), alpha)
        if alpha is not None and _is_opaque(pixels, alpha, work.maximum):
            work = replace(work, alpha=None)
        if self.separable and work.alpha is None and pixels.dtype != np.float32:
            self._look_up(pixels, out, work)
        else:
            self._compute(pixels, out, work)
        return out

    def _look_up(self, pixels: Pixels, out: Pixels, work: _Work) -> None:
        key = (work, pixels.dtype, pixels.shape[2], out.dtype)
        if key not in self._tables:
            self._tables[key] = self._table(pixels, out.dtype, work)
        table = self._tables[key]
        codes = pixels.view(np.uint16) if pixels.dtype == np.float16 else pixels
        if table.infinite is not None and self._name is not None:
            used = (np.take(table.infinite[:, c], codes[..., c]).any() for c in work.color)
            if any(used):
                raise self._broken()
        if codes.dtype == np.uint8 or opencv_looks_up_16_bits():
            opencv_look_up(codes, table.values, out)
        else:
            numpy_look_up(codes, table.values, out)
        if table.cut:
            self._has_cut |= bool((out[..., list(work.color)] == np.float16(HALF_MAX)).any())

    def _table(self, pixels: Pixels, dtype: Any, work: _Work) -> _Table:
        values = every_value(pixels.dtype, work.maximum)
        table = np.repeat(values[:, None], pixels.shape[2], axis=1)
        result = self._transformed(np.repeat(values[None, :, None], 3, axis=2), work)[0]
        table[:, work.color] = result
        infinite = None
        if not np.isfinite(result).all():
            # What was not finite before is no fault of the transform.
            infinite = ~np.isfinite(table) & np.isfinite(values)[:, None]
        if dtype != np.float16:
            return _Table(table, infinite)
        return _Table(as_half(table, work.color), infinite, bool((result > HALF_MAX).any()))

    def _compute(self, pixels: Pixels, out: Pixels, work: _Work) -> None:
        plain = work == _Work(work.maximum, _RGB, None) and pixels.shape[2] == 3
        band = self._colors_alone if plain and pixels.dtype == np.float32 else self._band
        rows = max(1, _BAND // pixels.shape[1])
        bands = [slice(y, y + rows) for y in range(0, pixels.shape[0], rows)]
        cores = min(len(bands), usable_cores())
        if cores == 1:
            for at in bands:
                band(pixels[at], out[at], work)
            return
        with ThreadPoolExecutor(cores) as threads:
            for done in [threads.submit(band, pixels[at], out[at], work) for at in bands]:
                done.result()

    def _colors_alone(self, pixels: Float32, out: Pixels, work: _Work) -> None:
        """Float RGB straight into `out`, where that can be."""
        given = np.ascontiguousarray(pixels)
        # OpenColorIO takes twice as long to half floats as to floats, and OpenCV rounds at once.
        straight = out.dtype == np.float32 and out.flags.c_contiguous
        straight = straight and not np.may_share_memory(given, out)
        result = out if straight else np.empty_like(given)
        self._transform(given, result)
        if self._name is not None and bring_back(self._transform, given, result):
            self._require_finite(given, result)
        if not straight:
            out[...] = self._cut_to_half(result, work) if out.dtype == np.float16 else result

    def _band(self, pixels: Pixels, out: Pixels, work: _Work) -> None:
        values = as_float(pixels, work.maximum)
        given = np.ascontiguousarray(values[..., work.color * (3 // len(work.color))])
        coverage = np.ones_like(given[..., :1])
        if work.alpha is not None:
            coverage = values[..., work.alpha, None]
            coverage = np.where(coverage > 0, coverage, np.float32(1))
            given /= coverage
        result = self._transformed(given, work)
        self._require_finite(given[..., : result.shape[2]], result)
        values[..., work.color] = result * coverage
        out[...] = self._cut_to_half(values, work) if out.dtype == np.float16 else values

    def _cut_to_half(self, values: Float32, work: _Work) -> Pixels:
        if (values[..., list(work.color)] > HALF_MAX).any():
            self._has_cut = True
        return as_half(values, work.color)

    def _transformed(self, given: Float32, work: _Work) -> Float32:
        """(H, W, 1 or 3) of (H, W, 3)."""
        result = np.empty_like(given)
        self._transform(given, result)
        if self._name is not None:
            bring_back(self._transform, given, result)
        if len(work.color) == 3:
            return result
        gray = result[..., :1]
        if not np.array_equal(result, np.broadcast_to(gray, result.shape), equal_nan=True):
            raise SettingsError(
                f"{self._name or 'the transform'}: treats R, G and B unlike each other, and the "
                "image is gray; convert the image to RGB first"
            )
        return gray

    def _require_finite(self, given: Float32, result: Float32) -> None:
        if self._name is not None and some_lost(given, result):
            raise self._broken()

    def _broken(self) -> LutError:
        return LutError(f"{self._name}: gives NaN or infinite values; make the LUT again")


@dataclass(frozen=True, slots=True)
class _Work:
    """What `Lookup.apply` was asked for: the code that is 1, the channels' indices."""

    maximum: int
    color: tuple[int, ...]
    alpha: int | None


@dataclass(frozen=True, slots=True, eq=False)
class _Table:
    """(N, C) what becomes of every value, which of it is not finite, if any, and if any was cut."""

    values: Pixels
    infinite: npt.NDArray[np.bool_] | None
    cut: bool = False


def curve_lookup(curve: InverseCRF) -> Lookup:
    """Return what `curve.linearize` does; NaN become 0, as in OpenColorIO."""

    def transform(values: Float32, out: Pixels) -> None:
        # Beyond the curve's ends lies what is at them; `linearize` takes that for undivided codes.
        out[...] = curve.linearize(np.clip(np.nan_to_num(values, nan=0.0), 0.0, 1.0))

    return Lookup(transform)


def _check(pixels: Pixels, out: Pixels, color: Sequence[int]) -> None:
    if pixels.ndim != 3 or str(pixels.dtype) not in ("uint8", "uint16", "float16", "float32"):
        raise SettingsError(
            f"pixels must be (H, W, C) uint8, uint16, float16 or float32, not {pixels.dtype} of "
            f"shape {pixels.shape}"
        )
    if out.shape != pixels.shape or out.dtype not in (np.float16, np.float32):
        raise SettingsError(
            f"the result of {pixels.shape} pixels must be float16 or float32 of the same shape, "
            f"not {out.dtype} {out.shape}"
        )
    if len(color) not in (1, 3) or not all(0 <= index < pixels.shape[2] for index in color):
        raise SettingsError(f"no channels {tuple(color)} of {pixels.shape[2]} for R, G, B or gray")


def _is_opaque(pixels: Pixels, alpha: int, maximum: int) -> bool:
    coverage = pixels[..., alpha]
    return bool((coverage == (1 if coverage.dtype.kind == "f" else maximum)).all())
