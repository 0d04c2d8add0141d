"""What every page is made of besides its data: its HTML, style and one script, hashed."""

from __future__ import annotations

import base64
import hashlib
from html import escape
from importlib.resources import files

# Parts of the one script, in the order in which they stand in it: later ones use earlier ones.
_PARTS = (
    *("elements", "curves", "stops", "pictures", "rows", "choice", "columns", "table", "pages"),
    *("compare", "unsure", "files", "detail", "summary", "sections", "why", "cameras", "brackets"),
    *("filters", "start"),
)

ARCHIVE_PAGE = "facecrf: report of an archive"
"""Title of a report, by which an older one is known."""
PHOTO_PAGE = "facecrf: one photo"
"""Title of the page of one photo."""
_BODIES = {ARCHIVE_PAGE: "page.html", PHOTO_PAGE: "photo.html"}


def around(title: str) -> tuple[str, str]:
    """What stands before the data of a page of a title, and what after it."""
    head, body = _source("head.html"), _source(_BODIES[title])
    style, script = _source("page.css"), page_script()
    # Nothing may run or be styled but what is hashed here; nothing may be fetched at all.
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; "
        "img-src data:; base-uri 'none'; form-action 'none'; require-trusted-types-for 'script'"
    )
    body, _, tail = body.partition("<!-- data -->")
    head = head.replace("<!-- policy -->", escape(policy, quote=True))
    head = head.replace("<!-- title -->", title)
    head = head.replace("/* style */", style)
    tail = tail.replace("/* script */", script)
    return head + body, tail


def page_script() -> str:
    """Return the page's one script, put together from its parts, which share its names."""
    parts = "\n".join(_source(f"{name}.js") for name in _PARTS)
    return f'"use strict";\n(() => {{\n{parts}}})();\n'


def _source(name: str) -> str:
    place = files("facecrf_ocio.archive.report") / "page" / name
    return place.read_text(encoding="utf-8")


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"sha256-{base64.b64encode(digest).decode()}"
