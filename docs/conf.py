"""Settings of the documentation: `sphinx-build -W docs docs/_build`."""

import re
from importlib import metadata
from pathlib import Path
from typing import Any

project = "facecrf-ocio"
copyright = "The facecrf-ocio developers"  # noqa: A001 (Sphinx's name)
release = version = metadata.version("facecrf-ocio")
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build"]
myst_heading_anchors = 3
myst_enable_extensions = ["deflist"]
napoleon_google_docstring = False
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
html_theme = "furo"
html_title = "facecrf-ocio"
html_theme_options = {"top_of_page_buttons": []}  # its link would stand outside of all landmarks
# Quick ones are run when the pages are built; the others need programs that few have.
sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/0[125]_",
    "ignore_pattern": r"make_|measure_",
    "download_all_examples": False,
    "show_memory": False,
    "abort_on_example_error": True,
}
suppress_warnings = ["config.cache"]


# What the theme leaves out and a screen reader or a keyboard needs: levels of headings, names of
# landmarks that there are two of, a way into what scrolls sideways, words of links over pictures.
BARRIERS = {
    'role="heading">': 'role="heading" aria-level="2">',
    '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="Site">',
    '<aside class="toc-drawer': '<aside aria-label="Page" class="toc-drawer',
    "<pre>": '<pre tabindex="0">',
    '<div class="table-wrapper': '<div tabindex="0" class="table-wrapper',
    r'(</noscript>\s*)(<div id="search-results">)': r"\1<h1>Search</h1>\n\2",
    r'(reference internal" href="[\w.]+")(><span class="doc">([^<]+)<)': r'\1 aria-label="\3"\2',
}


def take_barriers_away(app: Any, problem: Exception | None) -> None:
    """Mend the pages that were built; what was mended before has nothing more to find."""
    for page in Path(app.outdir).rglob("*.html") if problem is None else ():
        text = found = page.read_text(encoding="utf-8")
        for barrier, mended in BARRIERS.items():
            text = re.sub(barrier, mended, text)
        if text != found:
            page.write_text(text, encoding="utf-8")


def setup(app: Any) -> None:
    """Do it at the end of a build."""
    app.connect("build-finished", take_barriers_away)
