"""Versions of what a result depends on, told without importing it."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache

from facecrf_ocio import __version__

_DISTRIBUTIONS = {
    "OpenColorIO": ("opencolorio",),
    "OpenImageIO": ("OpenImageIO",),
    "numpy": ("numpy",),
    "scipy": ("scipy",),
    "OpenCV": ("opencv-python-headless", "opencv-python", "opencv-contrib-python"),
    "rawpy": ("rawpy",),
}


def versions() -> dict[str, str]:
    """Return the version of this package, of Python and of each library that is installed."""
    found = {"facecrf_ocio": __version__, "python": platform.python_version()}
    for name, distributions in _DISTRIBUTIONS.items():
        for distribution in distributions:
            version = _version(distribution)
            if version:
                found[name] = version
                break
    return found


def difference(here: Mapping[str, str], there: Mapping[str, str]) -> str:
    """Return the first thing that differs as `name 1 there, 2 here`, empty if nothing does."""
    for name in here:
        if there.get(name) != here[name]:
            return f"{name} is {there.get(name, 'missing')} there and {here[name]} here"
    return ""


@cache  # parsing what was installed costs more than writing the record that tells it
def _version(distribution: str) -> str:
    from importlib import metadata  # noqa: PLC0415 - slow, and needed only when a file is written

    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return ""
