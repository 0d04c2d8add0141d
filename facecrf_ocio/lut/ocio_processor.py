"""One LUT file as OpenColorIO reads it: the one place where this package asks it to."""

from __future__ import annotations

import os
import sys
from functools import cache
from pathlib import Path
from typing import Any

import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.lut.ocio_log import unlogged

# How its log is made to tell more, which is for whoever calls it.
_ADVICE = "(Enable debug log for errors from all formats.)"


class RefusedError(Exception):
    """OpenColorIO cannot use a file; the text is its reason, whole, in one line."""


def ocio_processor(
    path: Path, *, inverse: bool = False, quiet: bool = True, curve: bool = False
) -> Any:
    """Return the processor of a LUT file, as it is on the disk now.

    Parameters
    ----------
    path
        The file.
    inverse
        Whether to run it backward.
    quiet
        Whether OpenColorIO keeps its warnings to itself; `usable.ask` tells them.
    curve
        Whether the file holds no more than curves, for which the best interpolation is the linear
        one: named so, processors that do the same have the same identity in all formats.

    Raises
    ------
    RefusedError
        If OpenColorIO does not take it.
    """
    source = os.path.abspath(path)  # noqa: PTH100 - resolves no links
    way = ocio.TRANSFORM_DIR_INVERSE if inverse else ocio.TRANSFORM_DIR_FORWARD
    with unlogged(quiet):
        return _processor(path, source, way, ocio.INTERP_LINEAR if curve else ocio.INTERP_BEST)


def _processor(path: Path, source: str, way: Any, between: Any) -> Any:
    try:
        # It keeps every file it ever read, by path: a file that was written again would be read
        # as it was, and a batch would fill the memory.
        ocio.ClearAllCaches()
        transform = ocio.FileTransform(src=source, interpolation=between)
        # An empty context keeps it from expanding $HOME and the like in the folder's name.
        return _raw_config().getProcessor(ocio.Context(), transform, way)
    except (ocio.Exception, UnicodeDecodeError) as error:  # its reason may quote a damaged file
        reason = plain_text(error, limit=sys.maxsize).replace(source, path.name)
        raise RefusedError(" ".join(reason.replace(_ADVICE, "").split())) from error
    except TypeError as error:  # how its binding meets a path that is not Unicode
        raise RefusedError("it cannot read from a folder whose name is not Unicode") from error
    finally:
        ocio.ClearAllCaches()


@cache
def _raw_config() -> Any:
    """A config without color spaces, which does not keep processors as others do."""
    config = ocio.Config.CreateRaw()
    config.setProcessorCacheFlags(ocio.PROCESSOR_CACHE_OFF)
    return config


def exact_cpu(processor: Any, depth: Any = ocio.BIT_DEPTH_F32) -> Any:
    """Return what runs a processor on 32-bit floats, with no inverse made approximate."""
    return processor.getOptimizedCPUProcessor(
        ocio.BIT_DEPTH_F32, depth, ocio.OptimizationFlags.OPTIMIZATION_LOSSLESS
    )
