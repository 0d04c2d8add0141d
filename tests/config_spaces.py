"""Whether a config that was extended still does all it did."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

PIXELS = np.array(
    [[0, 0, 0], [0.18, 0.18, 0.18], [1, 1, 1], [0.9, 0.3, 0.1], [0.02, 0.4, 0.7]], np.float32
)

# OpenColorIO writes 7 digits of the numbers in a config: of 25 stops, a look makes 4e-6.
LOOKS_WITHIN = 1e-5


def outcome(config: Any, *way: Any) -> npt.NDArray[np.float32] | None:
    """What becomes of some pixels; None where the config cannot tell."""
    pixels = PIXELS.copy()
    try:
        processor = config.getProcessor(*way)
        processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(pixels)
    except (ocio.Exception, ocio.ExceptionMissingFile):
        return None
    return pixels


def ways(config: Any) -> dict[tuple[str, ...], tuple[Any, ...]]:
    """From each space to linear light and back, and from there to each view and through each look.

    Spaces that the config hides are among them; named transforms run by themselves.
    """
    forward = ocio.TRANSFORM_DIR_FORWARD
    every = ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL
    roles = [role for role in ("scene_linear", "default") if config.hasRole(role)]
    linear = next(iter([*roles, *config.getColorSpaceNames(*every)]))
    found: dict[tuple[str, ...], tuple[Any, ...]] = {}
    for name in config.getColorSpaceNames(*every):
        found["from", name] = (name, linear)
        found["to", name] = (linear, name)
    for name in config.getNamedTransformNames(ocio.NAMEDTRANSFORM_ALL):
        found["named", name] = (name, forward)
    for name in config.getLookNames():
        found["look", name] = (ocio.LookTransform(linear, linear, name),)
    for display in config.getDisplays():
        for view in config.getViews(display):
            found[display, view] = (linear, display, view, forward)
    return found


def lost(before: Any, after: Any) -> tuple[int, list[tuple[str, ...]]]:
    """How many ways `before` can go, and those of which `after` makes something else."""
    count, unlike = 0, []
    for name, way in ways(before).items():
        was = outcome(before, *way)
        if was is None:
            continue
        count += 1
        now = outcome(after, *way)
        within = LOOKS_WITHIN if name[0] == "look" else 1e-6
        # A view transform's table may send light to infinity; the same infinity will do.
        same = now is not None and np.allclose(was, now, rtol=within, atol=within, equal_nan=True)
        if not same:
            unlike.append(name)
    return count, unlike


def read(config: str | Path) -> Any:
    ocio.ClearAllCaches()
    return ocio.Config.CreateFromFile(str(config))
