"""Where a page may be written, and how it refers to files beside it."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote

from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.atomic import require_free

_HEAD = 1 << 14  # [byte] within which a page has its title, as the style sheet comes after it


def require_page(path: Path, title: str, *, overwrite: bool) -> bool:
    """Return whether a page is to replace what is there: an older page of its kind always is.

    Raises
    ------
    OutputError
        If the path is not named as a page, or another file is there and `overwrite` is false.
    """
    if path.suffix.lower() not in (".html", ".htm"):
        raise OutputError(f"{path}: is not named as a page; give it the suffix .html")
    overwrite = overwrite or _is_own(path, title)
    require_free(path, overwrite=overwrite)
    return overwrite


def _is_own(path: Path, title: str) -> bool:
    try:
        with path.open("rb") as file:
            return f"<title>{title}</title>".encode() in file.read(_HEAD)
    except OSError:
        return False  # none there, or `require_free` tells what is wrong with it


def relative_url(page: Path, target: Path) -> str:
    """Return the address of a file as a page refers to it, so that both can be moved together."""
    target = target.absolute()
    try:
        path = Path(os.path.relpath(target, page.absolute().parent))
    except ValueError:  # on another drive
        return target.as_uri()
    return "/".join(quote(os.fsencode(part)) for part in path.parts) or "."
