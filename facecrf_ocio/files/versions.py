"""Versions of what a result depends on, told without importing it."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Mapping
from contextlib import suppress
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


def _version(distribution: str) -> str:
    return _installed().get(_normal(distribution), "")


@cache
def _installed() -> dict[str, str]:
    """Versions of all that is installed, by the names of the folders that tell of them.

    As `importlib.metadata` finds them, which takes 30 ms to import: a third of a decode.
    """
    found: dict[str, str] = {}
    for place in sys.path:
        with suppress(OSError):
            for entry in os.listdir(place or "."):  # noqa: PTH208 - names are all that is wanted
                name, dash, version = entry.removesuffix(".dist-info").partition("-")
                if dash and entry.endswith(".dist-info"):
                    found.setdefault(_normal(name), version)
    return found


def _normal(name: str) -> str:
    """A name as the folders of what is installed have it (PEP 503, with underscores)."""
    return re.sub(r"[-_.]+", "_", name).lower()
