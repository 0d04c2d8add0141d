"""Light that half floats do not hold is told wherever it is cut."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import table
from command_line import CommandLine
from photo_files import write

from facecrf_ocio import Photo
from facecrf_ocio.image.apply import write_exr
from facecrf_ocio.image.lookup import Lookup

TOLD = "light above 65504, the most half floats hold, is written as that"
DOUBLING = "Version 1\nFrom 0 100000\nLength 2\nComponents 1\n{\n0\n200000\n}\n"


@pytest.fixture
def bright(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    return write(tmp_path / "in" / "shot.0001.exr", light(1e5), oiio.FLOAT)


def light(brightest: float) -> np.ndarray:
    pixels = np.full((8, 9, 3), 0.5, np.float32)
    pixels[3, 4] = brightest
    return pixels


@pytest.mark.parametrize(("brightest", "half", "notes"), [
    (1e5, True, (TOLD,)),
    (1e5, False, ()),
    (65504.0, True, ()),
])  # fmt: skip
def test_the_writer_tells(tmp_path: Path, brightest: float, half: bool, notes: tuple) -> None:
    pixels = light(brightest)
    photo = Photo(pixels, scene_linear=True)
    assert write_exr(tmp_path / "a.exr", pixels, photo, provenance={}, half=half).notes == notes


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float16, np.float32])
def test_a_lookup_tells_of_pixels_that_were_cut_and_of_no_others(kind: type) -> None:
    def transform(values: np.ndarray, out: np.ndarray) -> None:
        out[...] = 1e5 * np.clip(np.nan_to_num(values), 0, 1)

    lookup = Lookup(transform)
    white = 1 if np.dtype(kind).kind == "f" else np.iinfo(kind).max
    lookup.apply(np.full((4, 4, 3), white * 0.5, kind), dtype=np.float16)
    assert not lookup.has_cut
    lookup.apply(np.full((4, 4, 3), white, kind), dtype=np.float16)
    assert lookup.has_cut


def test_apply(facecrf: CommandLine, bright: Path, tmp_path: Path) -> None:
    lut = tmp_path / "a.spi1d"
    lut.write_text(DOUBLING)
    options = ("--lut", lut, "--overwrite", "-o", tmp_path / "b.exr")
    assert f"note: {TOLD}; --float keeps it" in facecrf("apply", bright, *options).out
    assert TOLD not in facecrf("apply", bright, *options, "--float").out
    dim = write(tmp_path / "dim.exr", light(3e4), oiio.HALF)
    assert TOLD not in facecrf("apply", dim, *options).out


def test_batch_tells_in_its_list_and_in_the_record(
    facecrf: CommandLine, bright: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert facecrf("batch", bright.parent, "-o", out, "--exr").code == 0
    ((reason,),) = table(out, "SELECT reason FROM photos")
    assert reason.endswith(f"; {TOLD}")
    record = json.loads((out / f"{bright.name}.crf.json").read_text())
    assert record["source"]["notes"] == [TOLD]


def test_batch_and_clip_compress_as_told(
    facecrf: CommandLine, bright: Path, tmp_path: Path
) -> None:
    write(bright.with_name("shot.0002.exr"), light(3e4), oiio.FLOAT)  # one frame is no clip
    out, told = tmp_path / "out", ("--exr", "--compression", "piz")
    assert facecrf("batch", bright.parent, "-o", out, *told).code == 0
    assert facecrf("clip", bright.parent, "-o", tmp_path / "clip", *told).code == 0
    exrs = [path for path in tmp_path.glob("[co]*/**/*.exr") if path.is_file()]
    assert len(exrs) == 4
    for exr in exrs:
        assert oiio.ImageBuf(str(exr)).spec().get_string_attribute("compression") == "piz"


def test_clip(facecrf: CommandLine, bright: Path, tmp_path: Path) -> None:
    write(bright.with_name("shot.0002.exr"), light(3e4), oiio.FLOAT)
    ended = facecrf("clip", bright.parent, "-o", tmp_path / "out", "--exr")
    assert ended.code == 0
    assert f"note: in 1 frame {TOLD}" in ended.out
    again = facecrf("clip", bright.parent, "-o", tmp_path / "out", "--exr")
    assert "2 of them there already" in again.out
    assert f"note: in 1 frame {TOLD}" in again.out
