"""Arrays that no one can change, and what comes from outside: of which types, and which pixels."""

from __future__ import annotations

import copyreg
import inspect
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from itertools import chain
from numbers import Integral, Real
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import PhotoError, SettingsError

Float = npt.NDArray[np.floating[Any]]
Bool = npt.NDArray[np.bool_]
Index = npt.NDArray[np.intp]

MOST_BITS = 32
"""[bit] No integer file has wider code values, and float32 could not tell theirs apart."""
LEAST_SHARE = 0.01
"""Share of white's X + Y + Z that each primary must give at least. Of Rec.709, Rec.2020, Adobe RGB,
ProPhoto, ACES and two camera gamuts the smallest is 0.19; near 0 white lies at the edge."""
LARGEST_XY = 2.0
"""[CIE xy] of primaries; the widest in use, of cameras, stay below 1.6."""
SMALLEST_TRIANGLE = 1e-3
"""[CIE xy squared] Twice the area between primaries; that of Rec.709 is 0.22."""


def frozen(array: npt.ArrayLike, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """Return a read-only array of the given type, copied if the caller could still write to it.

    An array that is read-only already is taken as it is: that hands it over. What are no numbers
    raises SettingsError.
    """
    try:
        if np.iscomplexobj(array):
            raise TypeError
        result = np.asarray(array, dtype=dtype)
    except (TypeError, ValueError, OverflowError):
        raise SettingsError(f"{type(array).__name__} holds no numbers; give floats") from None
    if result.flags.writeable:
        result = result.copy() if isinstance(array, np.ndarray) else result
        result.flags.writeable = False
    return result


def read_only(items: Mapping[str, float]) -> MappingProxyType[str, float]:
    """Return a copy that no one can write to."""
    return MappingProxyType(dict(items))


_Function = TypeVar("_Function", bound=Callable[..., Any])
_Kinds = tuple[type, ...]
_ALSO: dict[Any, _Kinds] = {
    Path: (os.PathLike,),
    int: (Integral,),
    float: (Real,),
    bool: (bool, np.bool_),
    Any: (object,),
}
"""What is taken for a type besides itself, such as NumPy's numbers."""


def typed(function: _Function) -> _Function:
    """Let a function refuse by SettingsError what is not of the types that its signature names."""
    signature = inspect.signature(function)

    @wraps(function)
    def run(*args: Any, **named: Any) -> Any:
        require_types(function, signature.bind(*args, **named).arguments)
        return function(*args, **named)

    return cast("_Function", run)


def require_types(owner: Any, given: Mapping[str, Any]) -> None:
    """Raise SettingsError unless values are of the types that a function or class names."""
    for name, value in given.items():
        kinds, parts = _kinds_named(owner)[name]
        _require(name, value, kinds)
        if parts and isinstance(value, list | tuple):
            for part in value:
                _require(f"a part of {name}", part, parts)


def _require(name: str, value: Any, kinds: _Kinds) -> None:
    if {os.PathLike, np.ndarray} <= set(kinds):
        return  # photos, of which `photo_given` tells more
    # Python takes a text, and an array of one number, for a sequence.
    whole = isinstance(value, str | bytes) or getattr(value, "ndim", 1) == 0
    taken = tuple(k for k in kinds if not (whole and k in (Iterable, Sequence)))
    if not isinstance(value, taken):
        wanted = " or ".join(dict.fromkeys(kind.__name__ for kind in kinds))
        raise SettingsError(f"{name} is given as {type(value).__name__}; give {wanted}")
    if os.PathLike in kinds and "\0" in str(value):
        raise SettingsError(f"{name} is {value!r:.80}; give a name without a null character")


@cache
def _kinds_named(owner: Any) -> dict[str, tuple[_Kinds, _Kinds]]:
    """Of each name the types, and those of the parts of what has some."""
    return {name: _kinds(hint) for name, hint in get_type_hints(owner).items()}


def _kinds(hint: Any) -> tuple[_Kinds, _Kinds]:
    plain, inner = get_origin(hint) or hint, get_args(hint)
    if plain in (Union, UnionType):
        kinds, parts = zip(*map(_kinds, inner), strict=True)
        return tuple(chain(*kinds)), tuple(chain(*parts))
    of_parts = _kinds(inner[0])[0] if plain in (Iterable, Sequence) else ()
    return _ALSO.get(plain, (plain,)), of_parts


# An estimate goes from process to process, and pickle does not know read-only views by itself.
copyreg.pickle(MappingProxyType, lambda view: (read_only, (dict(view),)))


_FAR_ABOVE_WHITE = 16.0  # no filter rings as far; floats beyond are codes of 8 bits or more


def unit_floats(values: npt.ArrayLike) -> npt.NDArray[Any]:
    """Return code values as floats in [0, 1]: 8-bit and 16-bit integers by their maximum.

    Raises
    ------
    SettingsError
        If they are other integers, whose maximum nobody knows, or floats that were not divided
        by theirs.
    """
    given = np.asarray(values)
    if given.dtype in (np.uint8, np.uint16):
        return given.astype(np.float32) / np.float32(np.iinfo(given.dtype).max)
    if not np.issubdtype(given.dtype, np.floating):
        raise SettingsError(
            f"code values of type {given.dtype} have no known maximum; divide them by it and give "
            "floats in [0, 1], or use uint8 or uint16"
        )
    if given.size and given.max() > _FAR_ABOVE_WHITE:
        raise SettingsError(
            f"code values up to {given.max():g} are not in [0, 1]; divide them by the maximum code "
            "(255 or 65535)"
        )
    return given


def encoded_of(codes: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """8-bit code values (H, W, C) divided by their maximum."""
    import cv2  # noqa: PLC0415 - heavy, and only for those who work on photos

    return np.asarray(cv2.LUT(codes, np.asarray(np.arange(256) / 255, np.float32)))


def checked_pixels(
    given: npt.ArrayLike, path: Path | None, *, scene_linear: bool
) -> npt.NDArray[np.float32]:
    """(H, W, 3) float32 of pixels that are finite, and in [0, 1] unless they are linear light.

    Raises PhotoError if they are something else.
    """
    array = checked_shape(given, path)
    if not np.issubdtype(array.dtype, np.floating):
        raise PhotoError(
            path,
            f"code values of type {array.dtype} have no known maximum",
            "divide them by the maximum code (255 or 65535) and give floats in [0, 1]",
        )
    encoded = np.asarray(array, dtype=np.float32)
    low, high = float(encoded.min()), float(encoded.max())
    if not (np.isfinite(low) and np.isfinite(high)):
        raise PhotoError(
            path,
            "has NaN or infinite pixels",
            "replace them (oiiotool --fixnan box3) and try again",
        )
    if not scene_linear and (low < 0.0 or high > 1.0):
        raise PhotoError(
            path,
            f"has encoded values from {low:.3g} to {high:.3g}, outside of 0 to 1",
            "scale them to [0, 1], or pass scene_linear=True if they are linear light"
            if path is None
            else "save it with values from 0 to 1, or as EXR if they are linear light",
        )
    return encoded


def checked_shape(given: npt.ArrayLike, path: Path | None) -> npt.NDArray[Any]:
    """Return the array of pixels (H, W, 3); raise PhotoError if it has another shape."""
    _refuse_mask(given, path)
    array = np.asarray(given)
    if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
        raise PhotoError(
            path,
            f"an array of shape {array.shape} is not a photo",
            "give an array of shape (height, width, 3)",
        )
    return array


def checked_alpha(
    given: npt.ArrayLike, shape: tuple[int, ...], path: Path | None
) -> npt.NDArray[np.float32]:
    """(H, W) float32 of alpha in [0, 1] for pixels of shape (H, W, 3).

    Raises
    ------
    PhotoError
        If it is something else.
    """
    _refuse_mask(given, path)
    array = np.asarray(given)
    if array.shape != shape[:2] or not np.issubdtype(array.dtype, np.floating):
        raise PhotoError(
            path,
            f"alpha of shape {array.shape} and type {array.dtype} does not fit pixels of {shape}",
            f"give floats of shape {shape[:2]}, or alpha=None",
        )
    alpha = np.asarray(array, dtype=np.float32)
    low, high = float(alpha.min()), float(alpha.max())
    if not (low >= 0.0 and high <= 1.0):  # as NaN does not
        raise PhotoError(
            path,
            f"has alpha from {low:.3g} to {high:.3g}, outside of 0 to 1",
            "scale it to [0, 1], or pass alpha=None",
        )
    return alpha


def check_bit_depth(bits: Any, path: Path | None) -> None:
    """Refuse a bit depth that is neither None nor a number of bits.

    Raises
    ------
    PhotoError
        If it is not.
    """
    whole = isinstance(bits, (int, np.integer)) and not isinstance(bits, bool)
    if bits is not None and not (whole and 1 <= bits <= MOST_BITS):
        raise PhotoError(
            path,
            f"{bits!r} is no bit depth",
            f"give the bits of its integer codes, 1 to {MOST_BITS}, or None for floating point",
        )


def check_primaries(chromaticities: Sequence[Sequence[float]], path: Path | None) -> None:
    """Refuse primaries and white (4 of CIE xy) that span no colors.

    Raises
    ------
    PhotoError
        If they do not.
    """
    if not span_colors(chromaticities):
        raise PhotoError(
            path,
            "its primaries and white span no colors",
            "give the CIE xy of three primaries around a white, or primaries=None",
        )


def span_colors(chromaticities: Sequence[Sequence[float]]) -> bool:
    """Whether red, green, blue and white (4 of CIE xy) are a triangle around white."""
    try:
        xy = np.asarray(chromaticities, dtype=np.float64)
    except (TypeError, ValueError):
        return False
    if xy.shape != (4, 2) or not (np.abs(xy) <= LARGEST_XY).all():  # as NaN is not
        return False
    (x1, y1), (x2, y2) = xy[1] - xy[0], xy[2] - xy[0]
    if abs(x1 * y2 - x2 * y1) < SMALLEST_TRIANGLE:
        return False
    xyz = np.column_stack([xy, 1.0 - xy.sum(axis=1)])
    shares = np.linalg.solve(xyz[:3].T, xyz[3])
    return bool((shares > LEAST_SHARE).all() and xy[3, 1] > 0.0)


def _refuse_mask(given: object, path: Path | None) -> None:
    """Refuse masked arrays, whose mask NumPy would drop without a word."""
    # Who has a mask has loaded them, which takes a while; another thread may be at it just now.
    masked = getattr(sys.modules.get("numpy.ma"), "MaskedArray", None)
    if masked is not None and isinstance(given, masked):
        raise PhotoError(
            path,
            "a masked array says nothing of the pixels it hides",
            "fill them (array.filled), or calibrate a part without a mask",
        )
