"""What the bytes of an output depend on besides photo and recipe: the versions of the software."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version

from facecrf_ocio import __version__

_LIBRARIES = ("numpy", "scipy", "opencv-python-headless", "OpenImageIO", "opencolorio", "rawpy")


def versions() -> dict[str, str]:
    """Version by name of this package and of the libraries that pixels and curves go through."""
    return {"facecrf-ocio": __version__, **{name: _version(name) for name in _LIBRARIES}}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # under another name, such as opencv-python
        return "of unknown version"


def difference(here: Mapping[str, str], there: Mapping[str, str]) -> str:
    """Return the first thing that differs as `name 1 there, 2 here`, empty if nothing does."""
    for name in here:
        if there.get(name) != here[name]:
            return f"{name} is {there.get(name, 'missing')} there and {here[name]} here"
    return ""
