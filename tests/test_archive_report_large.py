"""A report of a hundred thousand photos opens in a real browser, and is searched and sorted."""

from __future__ import annotations

from pathlib import Path

import pytest
from browser import chromium
from selenium.webdriver.support.ui import WebDriverWait

from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.report import write_report
from facecrf_ocio.archive.task import FAILED, Result

COUNT = 100_000


def large_archive(folder: Path) -> Path:
    """Outputs of a batch by their manifest alone: every hundredth photo failed."""
    folder.mkdir()
    manifest = Manifest(folder)
    with manifest.transaction():
        for number in range(COUNT):
            name = f"{number // 1000:03d}/IMG_{number:06d}.jpg"
            result = Result("calibrated", "weak", "joint", "1 photo, 6 cues", sha256=f"{number}")
            if number % 100 == 0:
                result = Result(FAILED, reason=f"photos/{name}: is empty; copy it again")
            manifest.finish(name, Stamp(number, number, "recipe"), result)
    manifest.close()
    return folder


@pytest.mark.slow
def test_a_hundred_thousand_rows_open_and_are_searched_and_sorted(tmp_path: Path) -> None:
    written = write_report(large_archive(tmp_path / "luts"), limit=100)
    assert (written.photos, written.pictured) == (COUNT, 100)
    with chromium(tmp_path / "profile") as window:
        wait = WebDriverWait(window, 60)
        window.get(written.path.as_uri())

        def count() -> str:
            return str(window.find_element("css selector", "#count").text)

        def first() -> str:
            return str(window.find_element("css selector", "#body th .link").text)

        assert count() == "Photos 1 to 50 of 100,000"
        window.find_element("css selector", "#search").send_keys("img_0999")
        wait.until(lambda _: count() == "Photos 1 to 50 of 100 found, of 100,000 in all")
        window.find_element("css selector", "[data-key=name] button").click()
        wait.until(lambda _: first() == "099/IMG_099999.jpg")
        window.find_element("css selector", "#reset").click()
        window.find_element("css selector", "#verdicts [data-kind='4']").click()
        wait.until(lambda _: count() == "Photos 1 to 50 of 1,000 found, of 100,000 in all")
        assert window.get_log("browser") == []
