"""Settings of the documentation: `sphinx-build -W docs docs/_build`."""

from importlib import metadata
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


def tell_levels(_: Any, __: str, ___: str, context: dict[str, Any], ____: Any) -> None:
    """Give the captions of tables of contents the level that a role of heading asks for."""
    for part in ("body", "furo_navigation_tree"):
        text = context.get(part) or ""
        context[part] = text.replace('role="heading">', 'role="heading" aria-level="2">')


def setup(app: Any) -> None:
    """Connect it behind the theme's own."""
    app.connect("html-page-context", tell_levels, priority=900)
