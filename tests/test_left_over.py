"""Damage within a JPEG's pixels that leaves blocks over: refused, and sound files never."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner
from photo_files import app1, exif_of, with_segments
from PIL import Image

from facecrf_ocio import read_photo
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.containers.jpeg_segments import take_apart
from facecrf_ocio.photo.decoding.left_over import tail_of
from facecrf_ocio.photo.decoding.orientation import as_stored, upright

ALL = [
    (sampling, size)
    for sampling in ("4:4:4", "4:2:2", "4:2:0")
    for size in ((480, 640), (472, 637))
]


def texture(height: int = 480, width: int = 640, seed: int = 0) -> np.ndarray:
    """Shapes of all sizes, as pictures have them."""
    draw = np.random.default_rng(seed)
    octaves = [
        cv2.resize(
            draw.normal(0, 12, (4 << o, 5 << o, 3)), (width, height), interpolation=cv2.INTER_CUBIC
        )
        for o in range(6)
    ]
    return np.clip(sum(octaves) + 120, 0, 255).astype(np.uint8)


def jpeg(codes: np.ndarray, **options: object) -> bytes:
    out = io.BytesIO()
    Image.fromarray(codes).save(out, "JPEG", **{"quality": 90, "subsampling": "4:2:0", **options})
    return out.getvalue()


def repeated(content: bytes, at: float = 0.8, count: int = 512) -> bytes:
    """A piece of the scan stands twice: a decoder has units too many."""
    begin = content.index(b"\xff\xda")
    place = begin + round(at * (len(content) - begin))
    while b"\xff" in content[place - 1 : place + 1] or content[place - count] == 0:
        place += 1
    return content[:place] + content[place - count : place] + content[place:]


def refused(path: Path, content: bytes) -> str:
    path.write_bytes(content)
    with pytest.raises(PhotoError) as raised:
        read_photo(path)
    return str(raised.value)


@pytest.mark.parametrize(("sampling", "size"), ALL)
def test_units_that_are_left_over_are_told(
    tmp_path: Path, sampling: str, size: tuple[int, int]
) -> None:
    content = jpeg(texture(*size), subsampling=sampling)
    (tmp_path / "sound.jpg").write_bytes(content)
    read_photo(tmp_path / "sound.jpg")
    said = refused(tmp_path / "a.jpg", repeated(content))
    assert "is damaged within its pixels" in said
    assert "copy it again" in said


@pytest.mark.parametrize("orientation", range(1, 9))
def test_in_photos_that_are_turned(tmp_path: Path, orientation: int) -> None:
    content = with_segments(jpeg(texture()), app1(exif_of({274: orientation})))
    assert "damaged within" in refused(tmp_path / "a.jpg", repeated(content))


@pytest.mark.parametrize("orientation", range(9))
def test_as_stored_undoes_upright(orientation: int) -> None:
    image = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    assert np.array_equal(as_stored(upright(image, orientation), orientation), image)


@pytest.mark.parametrize("options", [{"progressive": True}, {"restart_marker_rows": 1}])
def test_decoders_tell_it_of_several_scans_and_of_restart_marks(
    tmp_path: Path, options: dict[str, object]
) -> None:
    content = jpeg(texture(), **options)
    parts = take_apart(content)
    assert parts is not None
    assert tail_of(parts) is None
    assert "Corrupt JPEG data" in refused(tmp_path / "a.jpg", repeated(content, at=0.4))


def bordered(codes: np.ndarray) -> np.ndarray:
    codes[-200:] = 0
    return codes


@pytest.mark.parametrize(
    "codes",
    [
        bordered(texture()),
        np.full((480, 640, 3), 90, np.uint8),
        np.tile(texture(48, 64), (10, 10, 1)),
        np.random.default_rng(0).integers(0, 256, (480, 640, 3)).astype(np.uint8),
        texture(40, 640),
        texture(480, 20),
    ],
    ids=["a black border", "one color", "tiles", "noise", "low", "narrow"],
)
@pytest.mark.parametrize("quality", [30, 75, 100])
def test_sound_pictures_are_read(tmp_path: Path, codes: np.ndarray, quality: int) -> None:
    path = tmp_path / "a.jpg"
    path.write_bytes(jpeg(codes, quality=quality))
    assert read_photo(path).notes == ()


def test_bytes_that_fill_the_end_are_no_damage(tmp_path: Path) -> None:
    path = tmp_path / "a.jpg"
    path.write_bytes(jpeg(texture())[:-2] + bytes(100) + b"\xff\xd9")
    read_photo(path)


def test_the_command_says_it_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(repeated(jpeg(texture())))
    result = CliRunner().invoke(main, ["calibrate", str(tmp_path / "a.jpg"), "-o", str(tmp_path)])
    assert result.exit_code != 0
    assert "is damaged within its pixels" in result.output
    assert "Traceback" not in result.output
