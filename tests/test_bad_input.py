"""Whatever cannot be calibrated ends in one clear line and its exit code, and writes nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from command_line import CODE, CommandLine, names_in, write_noise
from face_photos import grace_hopper
from photo_files import enlarge_header, write, write_dng
from PIL import Image

from facecrf_ocio import read_photo
from facecrf_ocio.errors import PhotoError

USAGE, UNREADABLE, NOTHING = 2, 3, 4


def cut_short(path: Path) -> None:
    write_noise(path, size=(200, 300))
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def empty(path: Path) -> None:
    path.touch()


def folder(path: Path) -> None:
    path.mkdir()


def missing(path: Path) -> None:
    assert not path.exists()


def few_letters(path: Path) -> None:
    path.write_text("hello")


def much_text(path: Path) -> None:
    path.write_text("This is no photo.\n" * 100)


def not_a_number(path: Path) -> None:
    pixels = np.full((8, 8, 3), 0.5, np.float32)
    pixels[3, 4, 1] = np.nan
    write(path, pixels, oiio.FLOAT)


def infinite(path: Path) -> None:
    pixels = np.full((8, 8, 3), 0.5, np.float32)
    pixels[3, 4, 1] = np.inf
    write(path, pixels, oiio.FLOAT)


def two_hundred_megapixels(path: Path) -> None:
    write_noise(path)
    enlarge_header(path, 20000, 10000)


def cmyk(path: Path) -> None:
    Image.new("CMYK", (64, 64), (10, 80, 90, 0)).save(path)


def raw_cut_short(path: Path) -> None:
    write_dng(path, np.full((32, 32), 2000.0))
    path.write_bytes(path.read_bytes()[:-700])


@pytest.mark.parametrize(
    ("name", "make", "problem"),
    [
        ("a.jpg", cut_short, "cut short"),
        ("a.png", cut_short, "cut short"),
        ("a.tif", cut_short, "cut short"),
        ("a.jpg", empty, "is empty"),
        ("a.exr", empty, "is empty"),
        ("a.jpg", folder, "is a folder"),
        ("a.jpg", missing, "does not exist"),
        ("a.jpg", few_letters, "not an image"),
        ("a.jpg", much_text, "not an image"),
        ("a.exr", not_a_number, "NaN or infinite"),
        ("a.exr", infinite, "NaN or infinite"),
        ("a.png", two_hundred_megapixels, "200 megapixels"),
        ("a.tif", two_hundred_megapixels, "200 megapixels"),
        ("a.jpg", two_hundred_megapixels, "200 megapixels"),
        ("a.jpg", cmyk, "CMYK"),
        ("a.dng", raw_cut_short, "cut short"),
        ("a.dng", much_text, "not camera raw"),
    ],
)
def test_what_cannot_be_read(
    facecrf: CommandLine, tmp_path: Path, name: str, make: Callable[[Path], None], problem: str
) -> None:
    photo = tmp_path / name
    make(photo)
    expect_one_line(facecrf, photo, UNREADABLE, problem)


def black(path: Path) -> None:
    Image.new("RGB", (300, 300)).save(path)


def one_color(path: Path) -> None:
    Image.new("RGB", (300, 300), (200, 120, 80)).save(path)


def one_pixel(path: Path) -> None:
    Image.new("RGB", (1, 1), (200, 120, 80)).save(path)


def one_row(path: Path) -> None:
    write_noise(path, size=(1, 500))


def noise(path: Path) -> None:
    write_noise(path, size=(200, 200))


def gradient(path: Path) -> None:
    ramp = np.linspace(0, 255, 300)[None, :, None] * np.array([1.0, 0.8, 0.6])
    Image.fromarray(np.repeat(ramp, 200, axis=0).astype(np.uint8)).save(path)


def gray(path: Path) -> None:
    Image.fromarray(np.rint(255 * grace_hopper()).astype(np.uint8)).convert("L").save(path)


def tiny_face(path: Path) -> None:
    """A face of 20 pixels, which in the portrait has 230, in front of a wall."""
    scale = 20 / 230
    portrait = cv2.resize(grace_hopper(), None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    picture = np.full((200, 250, 3), (90, 110, 130), np.uint8)
    height, width = portrait.shape[:2]
    picture[60 : 60 + height, 90 : 90 + width] = np.rint(255 * portrait)
    Image.fromarray(picture).save(path)


def cartoon(path: Path) -> None:
    picture = np.full((600, 600, 3), 255, np.uint8)
    brown, white, smooth = (60, 30, 10), (255, 255, 255), cv2.LINE_AA
    cv2.circle(picture, (300, 300), 200, (255, 205, 150), -1, smooth)
    cv2.circle(picture, (300, 300), 200, (0, 0, 0), 5, smooth)
    for x in (225, 375):
        cv2.ellipse(picture, (x, 240), (35, 25), 0, 0, 360, white, -1, smooth)
        cv2.circle(picture, (x, 240), 14, brown, -1, smooth)
        cv2.ellipse(picture, (x, 200), (40, 15), 0, 180, 360, brown, 8, smooth)
    cv2.polylines(picture, [np.array([(300, 260), (285, 330), (315, 330)])], False, brown, 5)
    cv2.ellipse(picture, (300, 370), (80, 45), 0, 10, 170, (190, 60, 60), 10, smooth)
    Image.fromarray(picture).save(path)


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (black, ""),
        (one_color, "face"),
        (one_pixel, "face"),
        (one_row, "face"),
        (noise, "face"),
        (gradient, "face"),
        (gray, "grayscale"),
        (tiny_face, "narrower than 60 px"),
        (cartoon, ""),
    ],
)
def test_what_gives_nothing_to_calibrate_from(
    facecrf: CommandLine, tmp_path: Path, make: Callable[[Path], None], problem: str
) -> None:
    make(tmp_path / "a.png")
    expect_one_line(facecrf, tmp_path / "a.png", NOTHING, f"not calibrated: {problem}", problem)


def expect_one_line(facecrf: CommandLine, photo: Path, code: int, *problems: str) -> None:
    """Expect file, problem and remedy of `calibrate` in one line, and no file written."""
    before = names_in(photo.parent)
    ended = facecrf("calibrate", photo, "-o", photo.parent / "out", "--plot")
    assert (ended.code, ended.out) == (code, "")
    assert ended.err.startswith(f"facecrf: {photo}: ")
    assert ended.err.count("\n") == 1
    assert any(problem in ended.err for problem in problems)
    assert "picture.jpg" not in ended.err  # the copy a JPEG is read from
    assert len(ended.err.split("; ")[-1]) > 10  # the remedy
    assert names_in(photo.parent) == before


@pytest.mark.parametrize(
    "command", [("linearize", "-o", "b.exr"), ("apply", "--lut", "a.cube", "-o", "b.exr")]
)
def test_other_commands_complain_alike(
    facecrf: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.jpg").touch()
    ended = facecrf(*command, "a.jpg")
    assert ended.code == UNREADABLE
    assert ended.err.startswith("facecrf: a.jpg: is empty")
    assert ended.err.count("\n") == 1
    assert names_in(tmp_path) == {"a.jpg"}


@pytest.mark.parametrize("command", ["calibrate", "linearize", "show"])
def test_a_folder_is_for_another_command(
    facecrf: CommandLine, tmp_path: Path, command: str
) -> None:
    way = () if command == "show" else ("-o", tmp_path / "out")
    ended = facecrf(command, tmp_path, *way)
    assert ended.code == UNREADABLE
    told = "is a folder; name a photo inside of it, or take all of it: facecrf batch\n"
    assert ended.err == f"facecrf: {tmp_path}: {told}"


def test_linearize_without_a_face(facecrf: CommandLine, tmp_path: Path) -> None:
    photo = write_noise(tmp_path / "a.png")
    ended = facecrf("linearize", photo, "-o", tmp_path / "a.exr")
    assert (ended.code, ended.out) == (NOTHING, "")
    assert ended.err.startswith(f"facecrf: {photo}: not calibrated: no face found; ")
    assert names_in(tmp_path) == {"a.png"}


@pytest.mark.skipif(sys.platform != "linux", reason="other systems refuse such names themselves")
@pytest.mark.parametrize(("command", "out"), [("calibrate", "out"), ("linearize", "out.exr")])
def test_a_name_that_is_no_text(
    facecrf: CommandLine, tmp_path: Path, command: str, out: str
) -> None:
    write_noise(tmp_path / "a.png")
    photo = Path(os.fsdecode(os.fsencode(tmp_path) + b"/bad\xff.png"))
    (tmp_path / "a.png").rename(photo)
    ended = facecrf(command, photo, "-o", tmp_path / out, "--estimator", "srgb")
    assert ended.code == UNREADABLE
    assert "name that is not UTF-8 text; rename it" in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize(("name", "code"), [("a.png", NOTHING), ("b.png", UNREADABLE)])
def test_the_process_itself_ends_so(tmp_path: Path, name: str, code: int) -> None:
    write_noise(tmp_path / "a.png")
    cut_short(tmp_path / "b.png")
    command = [sys.executable, "-c", CODE, "calibrate", name, "-o", "out"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (code, "")
    assert ended.stderr.startswith(f"facecrf: {name}: ")
    assert ended.stderr.count("\n") == 1


def test_what_is_no_image_is_told_without_the_question_that_the_library_asks(tmp_path):
    (tmp_path / "a.jpg").write_text("no picture", encoding="ascii")
    with pytest.raises(PhotoError, match="is not an image that can be read") as told:
        read_photo(tmp_path / "a.jpg")
    assert "?" not in str(told.value)
    (tmp_path / "a.md").write_text("no picture", encoding="ascii")
    with pytest.raises(PhotoError, match=r"could not find a format reader\); if it should"):
        read_photo(tmp_path / "a.md")


def test_a_picture_that_ends_in_its_header_is_told_as_one(tmp_path):
    whole = cv2.imencode(".jpg", np.zeros((24, 32, 3), np.uint8))[1].tobytes()
    (tmp_path / "a.jpg").write_bytes(whole[:100])
    with pytest.raises(PhotoError, match=r"begins as JPEG, but .*end of JPEG file\); copy"):
        read_photo(tmp_path / "a.jpg")


def test_a_pattern_that_no_file_matches(tmp_path):
    with pytest.raises(PhotoError, match=r"\*\.cr2: matches no file; check the folder"):
        read_photo(tmp_path / "*.cr2")


@pytest.mark.parametrize(("made", "command"), [(Path.touch, "calibrate"), (Path.mkdir, "batch")])
def test_a_photo_or_a_folder_in_the_place_of_a_command(facecrf, tmp_path, made, command):
    made(tmp_path / "a b.jpg")
    ended = facecrf(tmp_path / "a b.jpg")
    assert ended.code == USAGE
    assert f"to calibrate it: facecrf {command} '{tmp_path}/a b.jpg' -o luts" in ended.err


@pytest.mark.skipif(os.name == "nt", reason="links need a right there, and names end earlier")
class TestPathsThatNoFileHas:
    """Each command tells them in one line, as what they are."""

    def test_a_link_that_leads_nowhere(self, tmp_path: Path) -> None:
        (tmp_path / "a.jpg").symlink_to("gone.jpg")
        with pytest.raises(PhotoError, match="is a link to a file that does not exist"):
            read_photo(tmp_path / "a.jpg")

    @pytest.mark.parametrize("command", ["batch", "verify", "report", "ocio-config", "lint"])
    def test_links_in_a_circle(self, facecrf: CommandLine, tmp_path: Path, command: str) -> None:
        (tmp_path / "a.cube").symlink_to("a.cube")
        self.fails(facecrf, command, tmp_path / "a.cube", tmp_path)

    @pytest.mark.parametrize(
        "command", ["batch", "verify", "report", "ocio-config", "lint", "clip"]
    )
    def test_names_longer_than_a_disk_takes(
        self, facecrf: CommandLine, tmp_path: Path, command: str
    ) -> None:
        self.fails(facecrf, command, tmp_path / ("a" * 300 + ".cube"), tmp_path)

    @staticmethod
    def fails(facecrf: CommandLine, command: str, path: Path, folder: Path) -> None:
        outputs = {"ocio-config": "out.ocio", "batch": "out", "clip": "out"}
        way = ("-o", folder / outputs[command]) if command in outputs else ()
        ended = facecrf(command, path, *way)
        assert ended.code != 0
        assert "unexpected" not in ended.err
        assert ended.err.startswith(f"facecrf: {path}")
        assert ended.err.count("\n") == 1


@pytest.mark.skipif(os.name == "nt", reason="names end earlier there")
def test_a_lut_of_the_longest_name_is_applied(facecrf: CommandLine, tmp_path: Path) -> None:
    photo, lut = write_noise(tmp_path / "a.png"), tmp_path / ("a" * 250 + ".cube")
    lut.write_text("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n")
    ended = facecrf("apply", photo, "--lut", lut, "-o", tmp_path / "a.exr")
    assert (ended.code, ended.err) == (0, "")
