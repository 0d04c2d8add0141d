"""The site of the documentation: built without warnings, and without barriers on a phone."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from axe_core_python.selenium import Axe
from browser import chromium, use_theme

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
# One of each kind: text with a picture, tables, signatures, a program with its output, a gallery,
# and one that the theme makes.
PAGES = (
    "index",
    "quickstart",
    "hosts/index",
    "python",
    "gallery/01_one_photo",
    "gallery/index",
    "search",
)
WIDTHS = (390, 1400)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Built from a copy, since the gallery is written beside its source."""
    for needed in ("sphinx", "myst_parser", "furo", "sphinx_gallery", "sphinx_click"):
        pytest.importorskip(needed)
    copy = tmp_path_factory.mktemp("site")
    made = shutil.ignore_patterns("_build", "gallery")
    for folder in ("docs", "examples", "nodes"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=made)
    for page in ROOT.glob("*.md"):
        shutil.copy(page, copy)
    command = (sys.executable, "-m", "sphinx", "-W", "-q", copy / "docs", copy / "built")
    subprocess.run(command, check=True)
    return copy / "built"


@pytest.fixture(scope="module")
def window(tmp_path_factory):
    with chromium(tmp_path_factory.mktemp("profile")) as driver:
        driver.set_script_timeout(180)  # [s] of axe on a long page, where much else is at work
        yield driver


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("page", PAGES)
def test_a_page_has_no_barriers_at_any_width(site, window, page, theme):
    use_theme(window, theme)
    for width in WIDTHS:
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
        window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        window.get((site / f"{page}.html").as_uri())
        assert window.execute_script("return document.documentElement.scrollWidth") == width
        found = Axe().run(window)["violations"]
        assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in found] == []
