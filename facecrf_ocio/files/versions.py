"""Versions of what a result depends on, told without importing it."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module

from facecrf_ocio import __version__

# Of each library the module that is imported, and the names that its distribution may have.
_LIBRARIES = {
    "OpenColorIO": ("PyOpenColorIO", "opencolorio"),
    "OpenImageIO": ("OpenImageIO", "OpenImageIO"),
    "numpy": ("numpy", "numpy"),
    "scipy": ("scipy", "scipy"),
    "OpenCV": ("cv2", "opencv-python-headless", "opencv-python", "opencv-contrib-python"),
    "rawpy": ("rawpy", "rawpy"),
}
_TOLD = re.compile(rb"^Version:[ \t]*(\S+)", re.MULTILINE | re.IGNORECASE)
_HEAD = 4096  # [bytes] of what a distribution says of itself; its version is in the third line


def versions() -> dict[str, str]:
    """Return the version of this package, of Python and of each library that is installed."""
    found = {"facecrf_ocio": __version__, "python": platform.python_version()}
    told = {name: _version(*library) for name, library in _LIBRARIES.items()}
    return found | {name: version for name, version in told.items() if version}


def difference(here: Mapping[str, str], there: Mapping[str, str]) -> str:
    """Return the first thing that differs as `name 1 there, 2 here`, empty if nothing does."""
    for name in here:
        if there.get(name) != here[name]:
            return f"{name} is {there.get(name, 'missing')} there and {here[name]} here"
    return ""


@cache
def _version(module: str, *distributions: str) -> str:
    """Version of a library; empty if it is not installed.

    What is in no folder of its own, such as eggs, zips and what other finders find, the standard
    library is asked for. Libraries that hosts and systems ship without a distribution are asked
    themselves, and so are those of which two versions are said to be in one place.
    """
    for distribution in distributions:
        told = {_in_folder(folder) for folder in _folders().get(_normal(distribution), ())} - {""}
        if len(told) == 1:
            return told.pop()
        if told:
            return _by_module(module) or ", ".join(sorted(told))
    return _by_metadata(distributions) or _by_module(module)


@cache
def _folders() -> dict[str, list[str]]:
    """By names of distributions, the folders that tell of them in the first place that has any.

    As `importlib.metadata` finds them, which takes 30 ms to import: a third of a decode.
    """
    found: dict[str, list[str]] = {}
    for place in sys.path:
        here: dict[str, list[str]] = {}
        with suppress(OSError):
            for entry in os.listdir(place or "."):  # noqa: PTH208 - names are all that is wanted
                if entry.endswith(".dist-info"):
                    name = _normal(entry.removesuffix(".dist-info").partition("-")[0])
                    here.setdefault(name, []).append(f"{place or '.'}/{entry}")
        found = here | found
    return found


def _in_folder(folder: str) -> str:
    """The version that a distribution's folder tells; empty for what a broken upgrade left."""
    with suppress(OSError), open(f"{folder}/METADATA", "rb") as file:  # noqa: PTH123 - as above
        told = _TOLD.search(file.read(_HEAD))
        return told[1].decode("ascii", "replace") if told else ""
    return ""


def _by_metadata(distributions: Sequence[str]) -> str:
    from importlib import metadata  # noqa: PLC0415 - heavy

    for distribution in distributions:
        with suppress(metadata.PackageNotFoundError, OSError, KeyError):
            told = metadata.distribution(distribution).metadata["Version"]
            if told:
                return str(told)
    return ""


def _by_module(module: str) -> str:
    """What a library says itself; empty if it cannot be imported."""
    try:
        return str(getattr(import_module(module), "__version__", ""))
    except Exception:  # whoever needs it will tell; a report of problems goes on
        return ""


def _normal(name: str) -> str:
    """A name as the folders of what is installed have it (PEP 503, with underscores)."""
    return re.sub(r"[-_.]+", "_", name).lower()
