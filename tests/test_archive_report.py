"""The report of an archive: what the page holds, and what a reader can do with it in a browser."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
import sqlite3
import sys
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from urllib.parse import urljoin, urlsplit
from urllib.request import url2pathname

import cv2
import numpy as np
import pytest
from axe_core_python.selenium import Axe
from browser import asked_for, chromium, use_theme
from command_line import names_in, write_noise
from PIL import Image
from selenium.webdriver import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.wait import WebDriverWait

from facecrf_ocio.archive.job import Job
from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.report import write_report
from facecrf_ocio.archive.report.contents import in_order
from facecrf_ocio.archive.report.links import relative_url
from facecrf_ocio.archive.report.reason_kinds import reason_kinds
from facecrf_ocio.archive.run import run
from facecrf_ocio.archive.task import Recipe
from facecrf_ocio.archive.walk import photos_under
from facecrf_ocio.record.calibration_record import read_record

ODD = 'odd "name" <script>alert(1)<!-- & \n line.png'
REPORT = "facecrf-report.html"


class Scripts(HTMLParser):
    """Elements and the text of scripts and styles, as a browser tells them apart."""

    def __init__(self, page: bytes) -> None:
        super().__init__()
        self.texts: dict[str, str] = {}
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.inside = ""
        self.feed(page.decode())
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self.inside = dict(attrs).get("id") or tag if tag in ("script", "style") else ""

    def handle_data(self, data):
        if self.inside:
            self.texts[self.inside] = self.texts.get(self.inside, "") + data

    def handle_endtag(self, tag):
        self.inside = ""

    @property
    def data(self):
        return json.loads(self.texts["data"])

    def word(self, column, row):
        return self.data["words"][self.data["columns"][column][row]]

    def row(self, name):
        return self.data["columns"]["name"].index(name)

    def pictures(self, name):
        at = self.data["columns"]["picture"][self.row(name)]
        block = json.loads(self.texts[f"pictures-{at // self.data['block']}"])
        return [decoded(text) for text in block[at % self.data["block"]]]


def decoded(text: str):
    return np.asarray(Image.open(BytesIO(base64.b64decode(text))).convert("RGB")) / 255.0


def smooth_photo(path: Path, seed: int, size=(120, 180)) -> Path:
    y, x = np.mgrid[0 : size[0], 0 : size[1]] / size[1]
    phase = np.random.default_rng(seed).uniform(0, 6, 3)
    codes = 0.5 + 0.45 * np.sin(4 * x[..., None] + 3 * y[..., None] + phase)
    Image.fromarray(np.rint(255 * codes).astype(np.uint8)).save(path)
    return path


def make_archive(place: Path, *, photos: int = 2) -> Path:
    source, output = place / "photos", place / "luts"
    (source / "sub").mkdir(parents=True)
    for number in range(photos):
        smooth_photo(source / "sub" / f"n{number:03d}.png", number)
    smooth_photo(source / "film.jpg", 7, (360, 240))
    smooth_photo(source / "gone.png", 8)
    smooth_photo(source / "changed.png", 9)
    smooth_photo(source / ODD, 10)
    write_noise(source / "cut.png")
    (source / "cut.png").write_bytes((source / "cut.png").read_bytes()[:200])
    (source / "empty.jpg").touch()
    recipe = Recipe("mean", formats=("spi1d",))
    run(Job(source, output, recipe), photos_under(source), lambda _: None)
    (source / "gone.png").unlink()
    smooth_photo(source / "changed.png", 99, (100, 100))
    return output


def change(output: Path, *statements: tuple[str, ...]) -> None:
    with sqlite3.connect(output / FILE) as base:
        for text, *values in statements:
            base.execute(text, values)
    base.close()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return make_archive(tmp_path_factory.mktemp("made"))


@pytest.fixture
def archive(made, tmp_path):
    shutil.copytree(made.parent, tmp_path / "archive")
    output = tmp_path / "archive" / made.name
    source = str(output.parent / "photos")
    change(output, ("UPDATE about SET value = ? WHERE key = 'source'", source))
    return output


def page_of(output: Path, **options) -> Scripts:
    return Scripts(write_report(output, overwrite=True, **options).path.read_bytes())


def test_every_photo_of_the_manifest_is_in_the_page(archive):
    page = page_of(archive)
    base = sqlite3.connect(archive / FILE)
    names = [name for (name,) in base.execute("SELECT name FROM photos ORDER BY name")]
    base.close()
    assert sorted(page.data["columns"]["name"]) == names
    kinds = {n: page.data["kinds"][page.data["columns"]["kind"][page.row(n)]] for n in names}
    assert {n for n, kind in kinds.items() if kind == "failed"} == {"cut.png", "empty.jpg"}
    assert kinds["film.jpg"] == "prior only"
    assert page.word("reason", page.row("empty.jpg")).startswith("is empty (zero bytes)")


def test_names_come_in_the_order_of_their_numbers():
    names = ["a/1.jpg", "head 2.jpg", "Head 3.jpg", "head 010.jpg", "head 10.jpg", "head 10b.jpg"]
    names += ["head 11/2.jpg", "head 11/10.jpg", "head 11-1/1.jpg", f"n{'9' * 5000}.jpg"]
    for seed in range(5):
        shuffled = np.random.default_rng(seed).permutation(names).tolist()
        assert sorted(shuffled, key=in_order) == names


def test_opencv_has_the_threads_that_it_had_before(archive):
    former = cv2.getNumThreads()
    try:
        cv2.setNumThreads(3)
        page_of(archive)
        assert cv2.getNumThreads() == 3
    finally:
        cv2.setNumThreads(former)


def test_curves_and_bands_are_those_of_the_records(archive):
    page = page_of(archive)
    row = page.row("film.jpg")
    text = json.loads(page.texts["curves"])[page.data["columns"]["curve"][row]]
    linear, half, above, half_stops = (
        np.frombuffer(base64.b64decode(text), "<u2").reshape(4, -1) / 65535
    )
    record = read_record(archive / "film.jpg.crf.json").estimate
    codes = np.linspace(0, 1, linear.size)
    there = record.curve.encoded
    truth = np.interp(codes, there, record.curve.linear[1])
    sigma = record.confidence.sigma[1]
    assert np.abs(linear - truth).max() <= 1 / 65535
    assert np.abs(half - 1.645 * np.interp(codes, there, sigma)).max() <= 1 / 65535
    mean = 100 * 1.645 * np.mean(record.confidence.sigma)
    assert page.data["columns"]["band"][row] == pytest.approx(mean, abs=0.01)
    expected = record.confidence.in_stops
    grid = np.linspace(0, 1, 256)
    srgb = np.where(grid <= 0.04045, grid / 12.92, ((grid + 0.055) / 1.055) ** 2.4)
    ratio = np.interp(grid, there, record.curve.linear[1])[1:] / srgb[1:]
    stops = np.interp(codes[2:], grid[1:], np.log2(ratio / ratio[127]))
    assert np.abs(8 * (2 * above[2:] - 1) - stops).max() <= 1e-3
    shown = np.interp(codes, grid, 1.645 * expected.sigma[1])
    assert np.abs(8 * half_stops - np.minimum(shown, 8)).max() <= 1e-3
    assert page.data["columns"]["stops"][row] == pytest.approx(expected.mid, abs=0.001)
    assert page.data["columns"]["shadows"][row] == pytest.approx(expected.shadows, abs=0.001)


@pytest.mark.parametrize("name", ["film.jpg", "sub/n001.png", ODD])
def test_thumbnails_show_the_photo_as_encoded_and_linearized(archive, name):
    before, after = page_of(archive).pictures(name)
    with Image.open(archive.parent / "photos" / name) as image:
        full = np.asarray(image.convert("RGB")) / 255.0
    record = read_record(archive / f"{name}.crf.json").estimate.found
    curves = zip(np.moveaxis(full, -1, 0), record.linear, strict=True)
    linear = np.stack([np.interp(x, record.encoded, curve) for x, curve in curves], axis=-1)
    shown = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    size = before.shape[1::-1]
    assert max(size) == 96
    for picture, truth in ((before, full), (after, shown)):
        image = Image.fromarray(np.rint(255 * truth).astype(np.uint8))
        small = image.resize(size, Image.Resampling.BOX)
        assert np.abs(picture - np.asarray(small) / 255).mean() < 0.02
    assert np.abs(before - after).mean() > 0.02


def test_large_pictures_are_for_the_first_photos_that_are_worth_a_look(archive, monkeypatch):
    module = sys.modules["facecrf_ocio.archive.report.write_report"]  # a function hides it
    monkeypatch.setattr(module, "LARGE", 4)
    page = page_of(archive)
    large = [name for name in page.texts if name.startswith("large-")]
    assert 1 <= len(large) <= 4
    before, after = (decoded(text) for text in json.loads(page.texts[large[0]]))
    assert before.shape == after.shape
    assert max(before.shape) > 96


def test_each_photo_says_what_to_expect_and_names_its_files(archive):
    page = page_of(archive)
    row = page.row("film.jpg")
    record = json.loads((archive / "film.jpg.crf.json").read_text(encoding="utf-8"))
    assert page.word("line", row)
    assert record["summary"].startswith(page.word("line", row))
    assert "--together" not in page.word("steps", row)
    assert page.word("steps", row).splitlines()[0].startswith("Apply it")
    assert page.word("files", row).splitlines() == ["*.spi1d", "*.crf.json"]
    assert page.data["links"] == ["../photos", "."]


def test_reasons_of_one_kind_stand_together():
    said = [
        'is cut short (JPEG error: ends ("/tmp/a/picture.jpg"))',
        "is cut short (TIFF error: no tag 7)",
        "is 5 pixels high",
        "is 7 pixels high",
        "holds 'x'; alone of its kind (16-bit)",
    ]
    kinds = reason_kinds(said)
    assert kinds[0] == kinds[1] == "is cut short"
    assert kinds[2] == kinds[3] == "is … pixels high"
    assert kinds[4] == said[4]


@pytest.mark.parametrize("name", ["a b.jpg", "ü#?.jpg", "100%.jpg"])
def test_addresses_lead_from_the_page_to_the_file(tmp_path, name):
    page, target = tmp_path / "out" / "page.html", tmp_path / "in" / name
    there = urljoin(page.as_uri(), relative_url(page, target))
    assert Path(url2pathname(urlsplit(there).path)) == target


def test_the_page_of_one_photo_holds_its_pictures_and_links_its_files(facecrf, archive):
    photo, record = archive.parent / "photos" / "film.jpg", archive / "film.jpg.crf.json"
    page = archive.parent / "one.html"
    ended = facecrf("show", photo, "--record", record, "-o", page)
    assert ended.code == 0
    shown = Scripts(page.read_bytes())
    before, after = (decoded(text) for text in json.loads(shown.texts["large-0"]))
    assert before.shape == after.shape == (360, 240, 3)
    names = [name.replace("*", "film.jpg") for name in shown.word("files", 0).splitlines()]
    assert names == ["film.jpg.spi1d", "film.jpg.crf.json"]
    assert shown.data["links"] == ["photos", "luts"]
    (archive / "film.jpg.exr").touch()
    assert facecrf("show", photo, "--record", record, "-o", page).code == 0
    assert "*.exr" in Scripts(page.read_bytes()).word("files", 0).splitlines()
    (archive / "film.jpg.exr").unlink()
    assert facecrf("show", photo, "--record", record, "-o", page).code == 0  # replaces its own
    other = facecrf("show", archive.parent / "photos" / ODD, "--record", record, "-o", page)
    assert other.code == 2
    assert "record of another photo" in other.err


def test_a_photo_without_a_curve_has_a_page_that_says_why(facecrf, tmp_path):
    photo = write_noise(tmp_path / "noise.png")
    ended = facecrf("show", photo, "-o", tmp_path / "noise.html")
    assert ended.code == 4
    shown = Scripts((tmp_path / "noise.html").read_bytes())
    assert shown.data["columns"]["curve"] == [-1]
    assert shown.word("reason", 0)
    assert shown.word("steps", 0)


def test_a_turned_photo_is_shown_upright(facecrf, tmp_path):
    (tmp_path / "photos").mkdir()
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.new("RGB", (300, 200), "teal").save(tmp_path / "photos" / "turned.jpg", exif=exif)
    facecrf("batch", tmp_path / "photos", "-o", tmp_path / "luts", "--estimator", "mean")
    before, after = page_of(tmp_path / "luts").pictures("turned.jpg")
    assert before.shape == after.shape == (96, 64, 3)


def test_what_cannot_be_shown_says_why(archive):
    page = page_of(archive)
    missing = {name: page.word("missing", page.row(name)) for name in page.data["columns"]["name"]}
    assert missing["gone.png"] == "The photo is no longer there."
    assert missing["changed.png"] == "The photo has changed since it was calibrated."
    assert missing["empty.jpg"] == "Not opened again, since it could not be read before."
    assert missing["film.jpg"] == ""


def test_without_its_source_the_page_says_so(facecrf, archive):
    shutil.rmtree(archive.parent / "photos")
    ended = facecrf("report", archive)
    assert ended.code == 0
    assert "is not there" in ended.err
    page = Scripts((archive / REPORT).read_bytes())
    assert page.data["sourceThere"] is False
    assert page.data["columns"]["curve"][page.row("film.jpg")] >= 0


def test_nothing_in_a_name_or_reason_becomes_markup(archive):
    change(archive, ("UPDATE photos SET reason = '</script><img src=x onerror=alert(1)>'",))
    page = page_of(archive)
    assert ODD in page.data["columns"]["name"]
    assert page.word("reason", 0) == "</script><img src=x onerror=alert(1)>"
    assert "img" not in {tag for tag, _ in page.elements}


def test_the_page_refers_to_nothing_outside_and_runs_only_its_own_script(archive):
    page = page_of(archive)
    every = [item for _, attributes in page.elements for item in attributes.items()]
    links = [value for key, value in every if key in ("src", "href")]
    assert links
    assert all(link.startswith("#") for link in links)
    policy = next(a["content"] for _, a in page.elements if a.get("http-equiv"))
    for name in ("script", "style"):
        digest = base64.b64encode(hashlib.sha256(page.texts[name].encode()).digest()).decode()
        assert f"{name}-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy


def test_photos_and_outputs_stay_as_they_are(facecrf, archive):
    def state():
        places = (archive.parent / "photos", archive)
        files = [path for place in places for path in place.rglob("*") if path.is_file()]
        return {
            path: (path.read_bytes(), path.stat().st_mtime_ns)
            for path in files
            if "manifest" not in path.name
        }

    before = state()
    page = archive.parent / "page.html"
    assert facecrf("report", archive, "-o", page).code == 0
    assert state() == before
    assert facecrf("report", archive).code == 0
    assert facecrf("verify", archive).code == 0


def test_a_report_replaces_its_own_page_and_no_other_file(facecrf, archive):
    page = archive / REPORT
    assert facecrf("report", archive).code == 0
    page.write_bytes(page.read_bytes().replace(b"</html>", b"<!-- older --></html>"))
    assert facecrf("report", archive).code == 0
    assert b"<!-- older -->" not in page.read_bytes()
    page.write_text("mine", encoding="utf-8")
    ended = facecrf("report", archive)
    assert ended.code == 1
    assert "--overwrite" in ended.err
    assert page.read_text(encoding="utf-8") == "mine"
    assert facecrf("report", archive, "--overwrite").code == 0
    assert page.read_bytes().startswith(b"<!DOCTYPE html>")


def test_a_photo_is_never_taken_for_the_report(facecrf, archive):
    photo = archive.parent / "photos" / "film.jpg"
    before = photo.read_bytes()
    ended = facecrf("report", archive, "-o", photo, "--overwrite")
    assert ended.code == 1
    assert ".html" in ended.err
    assert photo.read_bytes() == before


def test_a_folder_without_a_manifest_is_refused(facecrf, tmp_path):
    ended = facecrf("report", tmp_path)
    assert ended.code == 1
    assert FILE in ended.err
    assert names_in(tmp_path) == set()


def test_beyond_the_limit_photos_are_listed_without_pictures(archive):
    page = page_of(archive, limit=3)
    columns = page.data["columns"]
    assert page.data["pictured"] == 3
    assert sum(place >= 0 for place in columns["picture"]) == 3
    assert len(columns["name"]) == 8
    assert sum(curve >= 0 for curve in columns["curve"]) == 3


def test_a_manifest_of_the_first_version_is_read(archive):
    with sqlite3.connect(archive / FILE) as base:
        base.execute(
            "CREATE TABLE older AS SELECT name, size, mtime_ns, sha256, recipe, state, outcome, "
            "verdict, estimator, reason, remedy, make, model, serial, software, read_s, "
            "estimate_s, write_s FROM photos"
        )
        for table in ("photos", "cameras", "brackets", "evidence"):
            base.execute(f"DROP TABLE {table}")
        base.execute("ALTER TABLE older RENAME TO photos")
    base.close()
    page = page_of(archive)
    assert page.pictures("film.jpg")[1].shape == (96, 64, 3)
    assert page.data["groups"] == []


CURVE = json.dumps(
    {"encoded": [0, 0.5, 1], "linear": [[0, 0.2, 1]] * 3, "sigma": [[0, 0.03, 0]] * 3}
)
POOLED = (
    (
        "UPDATE photos SET camera = 'c1', curve = 'camera', misfit = 0.5, make = 'Nikon', "
        "model = 'D70' WHERE name LIKE 'sub/%'",
    ),
    ("UPDATE photos SET make = 'Nikon', model = 'D100' WHERE name = 'film.jpg'",),
    ("UPDATE photos SET misfit = 4.25, curve = 'own' WHERE name = 'sub/n001.png'",),
    ("UPDATE photos SET bracket = 'film.jpg', duplicate_of = 'film.jpg' WHERE name = 'gone.png'",),
)
CAMERA = {
    "key": "c1",
    "make": "Nikon",
    "model": "D70",
    "serial": "17",
    "software": "v2",
    "style": "vivid",
    "members": 2,
    "telling": 2,
    "used": 1,
    "misfits": 1,
    "verdict": "weak",
    "reason": "two photos",
    "curve": CURVE,
}
BRACKET = {
    "name": "film.jpg",
    "camera": "c1",
    "photos": 3,
    "stops": 4.0,
    "used": 1,
    "reason": "wide enough",
    "rmse": 0.021,
    "curve": CURVE,
}
MERGE = {
    "name": "film.jpg",
    "state": "done",
    "outcome": "merged",
    "reason": "three exposures; light was cut",
    "file": "film.jpg.hdr.exr",
}


def pool(output: Path) -> None:
    """Record what a run with one curve per camera finds."""
    change(output, *POOLED)
    with sqlite3.connect(output / FILE) as base:
        for table, values in (("cameras", CAMERA), ("brackets", BRACKET), ("merges", MERGE)):
            kinds = {row[1]: row[2] for row in base.execute(f"PRAGMA table_info({table})")}
            row = [values.get(name, "" if kind == "TEXT" else 0) for name, kind in kinds.items()]
            marks = ", ".join("?" * len(row))
            base.execute(f"INSERT INTO {table} VALUES ({marks})", row)  # noqa: S608
    base.close()


def test_cameras_misfits_brackets_and_duplicates_are_told(archive):
    pool(archive)
    page = page_of(archive)
    (group,), (bracket,) = page.data["groups"], page.data["brackets"]
    assert (group["members"], group["misfits"], group["verdict"]) == (2, 1, "weak")
    assert (bracket["photos"], bracket["stops"], bracket["rmse"]) == (3, 4.0, 2.1)
    assert (bracket["merged"], bracket["mergeReason"]) == ("film.jpg.hdr.exr", MERGE["reason"])
    text = json.loads(page.texts["curves"])[group["curve"]]
    linear = np.frombuffer(base64.b64decode(text), "<u2").reshape(4, -1)[0] / 65535
    assert linear[linear.size // 2] == pytest.approx(0.2, abs=1e-5)
    misfit = dict(zip(page.data["columns"]["name"], page.data["columns"]["misfit"], strict=True))
    assert {name: value for name, value in misfit.items() if value} == {"sub/n001.png": 4.25}
    assert page.word("duplicateOf", page.row("gone.png")) == "film.jpg"


# In a real browser


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    place = tmp_path_factory.mktemp("browser")
    with chromium(place / "profile") as driver:
        output = make_archive(place / "archive", photos=60)
        pool(output)
        yield driver, write_report(output).path.as_uri()


@pytest.fixture
def window(opened):
    driver, page = opened
    asked_for(driver)
    driver.get(page)
    yield driver
    assert asked_for(driver) <= {page}
    assert driver.get_log("browser") == []


class Page:
    """What a reader sees and does."""

    def __init__(self, window) -> None:
        self.window = window

    def all(self, selector):
        return self.window.find_elements("css selector", selector)

    def one(self, selector):
        return self.window.find_element("css selector", selector)

    @property
    def names(self):
        # At one moment: between two calls the page may have drawn other rows.
        script = "return [...document.querySelectorAll('#body th .link')].map(e => e.textContent)"
        return self.window.execute_script(script)

    @property
    def count(self):
        return self.one("#count").text

    @property
    def focused(self):
        return self.window.switch_to.active_element

    def press(self, *keys):
        ActionChains(self.window).send_keys(*keys).perform()

    def wait(self, true):
        WebDriverWait(self.window, 20).until(lambda _: true())


@pytest.mark.slow
def test_a_reader_searches_sorts_filters_and_turns_pages(window):
    page = Page(window)
    assert page.count == "Photos 1 to 50 of 66"
    assert page.one("#table").get_attribute("aria-rowcount") == "67"
    names = page.names

    page.one(".pager [data-step=Next]").click()
    assert page.count == "Photos 51 to 66 of 66"
    assert not set(page.names) & set(names)
    assert page.one(".pager [data-step=Next]").get_attribute("aria-disabled") == "true"

    page.one("#search").send_keys("N01 sub")
    page.wait(lambda: len(page.names) == 10)
    assert page.names == [f"sub/n{number:03d}.png" for number in range(10, 20)]
    assert page.one("#count").get_attribute("role") == "status"
    page.one("[data-key=name] button").click()
    assert page.names == [f"sub/n{number:03d}.png" for number in range(19, 9, -1)]
    assert page.one("[data-key=name]").get_attribute("aria-sort") == "descending"
    page.one("#reset").click()
    assert "66" in page.count

    page.one("#verdicts [data-kind='4']").click()
    assert sorted(page.names) == ["cut.png", "empty.jpg"]
    assert page.one("#verdicts [data-kind='4']").get_attribute("aria-pressed") == "true"
    page.one("#reset").click()
    page.one("#why tbody button").click()
    assert len(page.names) == 1
    assert "Only photos with the reason" in page.one("#reason-filter").text
    page.one("#reason-filter button").click()

    page.one("[data-key=reason] button").click()
    reasons = [element.text for element in page.all("#body td.reason")]
    assert reasons == sorted(reasons)
    page.one("#search").send_keys("nothing has this name")
    page.wait(lambda: page.names == [])
    assert "No photo matches" in page.count


@pytest.mark.slow
def test_cameras_come_in_the_order_of_their_numbers(window):
    page = Page(window)
    page.one("[data-key=camera] button").click()
    first = page.names
    assert "film.jpg" not in first
    page.one(".pager [data-step=Next]").click()
    named = [name for name in (*first, *page.names) if name == "film.jpg" or "sub/" in name]
    assert named[-1] == "film.jpg"  # of the D100, behind the photos of the D70
    options = [each.text for each in page.all("#camera option")]
    assert options[-2:] == ["Nikon D70", "Nikon D100"]


@pytest.mark.slow
def test_names_are_shown_as_they_are_and_pictures_load(window):
    page = Page(window)
    assert 'odd "name" <script>alert(1)<!-- & \\n line.png' in page.names
    loaded = "return [...document.images].map(i => i.complete && i.naturalWidth)"
    page.wait(lambda: all(window.execute_script(loaded)))
    pictures = page.all("#body img")
    assert len(pictures) > 50
    assert all(picture.get_attribute("alt") for picture in pictures)
    assert "The photo is no longer there." in page.one("#body").text
    curve = page.one("#body svg")
    told = curve.get_attribute("aria-label")
    assert re.match(r"Curve: the middle code value is \d+ % give or take", told)


@pytest.mark.slow
def test_cameras_misfits_and_brackets_lead_to_their_photos(window):
    page = Page(window)
    assert "no. 17, v2, vivid" in page.one("#cameras").text
    page.one("#cameras button").click()
    page.wait(lambda: "of 60" in page.count)
    (merged,) = [a for a in page.all("#brackets a") if a.text == "EXR"]
    assert merged.get_attribute("href").endswith("film.jpg.hdr.exr")
    page.one("#brackets button").click()
    assert page.names == ["gone.png"]
    page.one("#reset").click()
    page.one("#mark option[value=misfit]").click()
    assert page.names == ["sub/n001.png"]
    assert "does not fit its camera: 4.25 s.d." in page.one("#body").text


@pytest.mark.slow
def test_it_can_be_used_with_the_keyboard_alone(window):
    page = Page(window)
    page.press(Keys.TAB)
    assert page.focused.text == "Skip to the table of photos"
    assert page.focused.value_of_css_property("outline-style") == "solid"
    page.press(Keys.ENTER)
    assert page.focused.get_attribute("id") == "photos"
    for _ in range(20):
        page.press(Keys.TAB)
        if page.focused.get_attribute("data-step") == "Next":
            break
    page.press(Keys.SPACE)
    assert page.count == "Photos 51 to 66 of 66"
    assert page.focused.get_attribute("data-step") == "Next"
    for _ in range(20):
        page.press(Keys.TAB)
        if page.focused.get_attribute("class") == "link":
            break
    name = page.focused.text
    page.press(Keys.ENTER)
    assert page.one("#details h2").text == name
    assert page.focused.text == "Close"
    page.press(Keys.ESCAPE)
    assert page.focused.text == name


@pytest.mark.slow
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_it_follows_the_system_and_has_no_barriers(window, theme):
    page = Page(window)
    use_theme(window, theme)
    color = page.one("body").value_of_css_property("background-color")
    brightest = max(map(int, re.findall(r"\d+", color)[:3]))
    assert (brightest < 60) == (theme == "dark")
    page.one("#legend summary").click()
    found = Axe().run(window)["violations"]
    page.one("#body .link").click()
    found += Axe().run(window, context="#details")["violations"]
    assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in found] == []


@pytest.mark.slow
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_phone_shows_cards_and_nothing_to_scroll_sideways(window, theme):
    use_theme(window, theme)
    size = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
    window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        page = Page(window)
        assert window.execute_script("return document.documentElement.scrollWidth") == 390
        row = page.one("#body tr")
        assert row.value_of_css_property("display") == "block"
        assert page.one("#head").is_displayed() is False
        assert "headings" not in page.one("#caption").text
        page.one("#sort option[value=kind]").click()
        found = Axe().run(window)["violations"]
        page.one("#body .link").click()
        found += Axe().run(window, context="#details")["violations"]
        assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in found] == []
    finally:
        window.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.slow
def test_a_photo_is_compared_with_the_keyboard_at_any_exposure(window):
    page = Page(window)
    page.one("#search").send_keys("film")
    page.wait(lambda: page.names == ["film.jpg"])
    page.one("#body .link").click()
    slider = page.one("#details [type=range]")
    slider.send_keys(Keys.HOME)
    at = "return document.querySelector('.stage').style.getPropertyValue('--at')"
    assert window.execute_script(at) == "0%"
    slider.send_keys(Keys.ARROW_RIGHT)
    assert window.execute_script(at) == "1%"
    brighter = page.one("#details .exposures [aria-label='2 stops brighter']")
    brighter.send_keys(Keys.ENTER)
    assert brighter.get_attribute("aria-pressed") == "true"
    table = page.one("feFuncR").get_dom_attribute("tableValues").split()
    linear = 4 * ((100 / 255 + 0.055) / 1.055) ** 2.4
    assert float(table[100]) == pytest.approx(1.055 * linear ** (1 / 2.4) - 0.055, abs=1e-4)
    assert "exposed" in page.one(".stage").get_attribute("class")
    unsure = page.one("#details .unsure")
    assert unsure.find_element("css selector", "img").value_of_css_property("filter") != "none"
    tables = page.all("#unsure feComponentTransfer:first-child feFuncG")
    stops = [float(v) for v in tables[0].get_dom_attribute("tableValues").split()]
    middle = len(stops) // 2
    assert stops[middle] < 0.02 < max(stops[:middle]) <= 1.0  # stops apart from code 128 grow
    links = [each.get_attribute("href") for each in page.all("#details .files a")]
    assert [link.rsplit("/", 1)[1] for link in links] == [
        *("film.jpg", "film.jpg.spi1d", "film.jpg.crf.json")
    ]
    assert all(Path(url2pathname(urlsplit(link).path)).is_file() for link in links)


@pytest.mark.slow
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400])
def test_the_page_of_one_photo_has_no_barriers(window, tmp_path, width, theme, facecrf):
    use_theme(window, theme)
    photo = smooth_photo(tmp_path / "a.png", 3)
    assert facecrf("show", photo, "--estimator", "mean", "-o", tmp_path / "a.html").code == 0
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        window.get((tmp_path / "a.html").as_uri())
        assert "prior only" in window.find_element("css selector", ".says").text
        typed = [each.text for each in window.find_elements("css selector", ".steps code")]
        assert "facecrf linearize" in typed
        assert "`" not in window.find_element("css selector", "body").text
        assert window.execute_script("return document.documentElement.scrollWidth") == width
        assert Axe().run(window)["violations"] == []
    finally:
        window.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        asked_for(window)
