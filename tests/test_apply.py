"""Linear pixels, against the curve itself and against `oiiotool`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from photo_files import CURVE, GRID, oiiotool, random_codes, write, write_spi1d

from facecrf_ocio.errors import LutError
from facecrf_ocio.image.apply import apply_lut, linearize_photo
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import InverseCRF, Photo


def write_cube(path: Path, size: int = 9) -> Path:
    """A three-dimensional LUT of noise: channels depend on each other."""
    rows = np.random.default_rng(3).random((size**3, 3))
    lines = "\n".join("{:.7f} {:.7f} {:.7f}".format(*row) for row in rows)
    path.write_text(f"LUT_3D_SIZE {size}\n{lines}\n")
    return path


class TestCurve:
    @pytest.mark.parametrize("bits", [8, 10, 12, 16])
    def test_equals_the_curve_at_every_code(self, bits: int) -> None:
        codes = np.arange(2**bits).reshape(2 ** (bits // 2), -1)
        encoded = np.stack([codes, codes[::-1], codes.T.reshape(codes.shape)], axis=2)
        encoded = (encoded / (2**bits - 1)).astype(np.float32)
        photo = Photo(encoded, bit_depth=bits)
        assert np.array_equal(linearize_photo(photo, CURVE), CURVE.linearize(encoded))

    def test_equals_the_curve_between_codes(self) -> None:
        encoded = np.random.default_rng(5).random((20, 30, 3), np.float32)
        alpha = np.full((20, 30), 0.5, np.float32)
        for photo in (Photo(encoded), Photo(encoded, bit_depth=8, alpha=alpha)):
            assert np.array_equal(linearize_photo(photo, CURVE), CURVE.linearize(encoded))

    def test_scene_linear_photos_pass_through(self) -> None:
        encoded = np.random.default_rng(5).random((20, 30, 3), np.float32) * 7
        photo = Photo(encoded, scene_linear=True)
        assert np.array_equal(linearize_photo(photo, CURVE), encoded)


class TestLut:
    @pytest.mark.parametrize("name", ["a.png", "a.tif"])
    @pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
    @pytest.mark.parametrize("make_lut", [write_spi1d, write_cube])
    def test_equals_oiiotool(self, tmp_path: Path, name: str, dtype: Any, make_lut: Any) -> None:
        kind = oiio.UINT8 if dtype is np.uint8 else oiio.UINT16
        photo = write(tmp_path / name, random_codes(dtype=dtype), kind)
        suffix = ".spi1d" if make_lut is write_spi1d else ".cube"
        lut = make_lut(tmp_path / f"lut{suffix}")
        expected = oiiotool(photo, lut, tmp_path / "expected.exr")
        assert np.abs(apply_lut(read_photo(photo), lut) - expected).max() < 1e-6

    @pytest.mark.parametrize("bit_depth", [None, 8, 16])
    def test_equals_the_curve_it_holds(self, tmp_path: Path, bit_depth: int | None) -> None:
        encoded = (random_codes() / 255).astype(np.float32)
        photo = Photo(encoded, bit_depth=bit_depth)
        applied = apply_lut(photo, write_spi1d(tmp_path / "a.spi1d"))
        assert np.abs(applied - CURVE.linearize(encoded)).max() < 3e-7

    def test_a_file_that_changed_is_read_again(self, tmp_path: Path) -> None:
        photo = Photo(np.full((2, 2, 3), 0.5, np.float32))
        lut = write_spi1d(tmp_path / "a.spi1d")
        before = apply_lut(photo, lut)
        write_spi1d(lut, InverseCRF(GRID, np.stack([GRID] * 3)))
        assert np.allclose(apply_lut(photo, lut), 0.5, atol=1e-6)
        assert not np.allclose(before, 0.5, atol=1e-2)

    @pytest.mark.parametrize("name", ["a $HOME b.spi1d", "100%x%.spi1d", "${A}.spi1d", "ü ñ.spi1d"])
    def test_names_are_taken_literally(self, tmp_path: Path, name: str) -> None:
        photo = Photo(np.full((2, 2, 3), 0.5, np.float32))
        applied = apply_lut(photo, write_spi1d(tmp_path / name))
        assert np.allclose(applied, CURVE.linearize(photo.encoded), atol=1e-6)

    @pytest.mark.parametrize(
        ("name", "content", "problem"),
        [
            ("a.spi1d", None, "does not exist"),
            ("a.spi1d", "", "no size is given"),
            ("a.spi1d", "not a LUT\n", "no size is given"),
            ("a.xyz", "not a LUT\n", "cannot read"),
            ("a.cube", "LUT_1D_SIZE 3\n0 0 0\n", "1 entries where 3 are promised"),
            ("a.spi1d", "Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\nnan\nnan\n}\n", "NaN"),
        ],
    )
    def test_bad_files(self, tmp_path: Path, name: str, content: str | None, problem: str) -> None:
        if content is not None:
            (tmp_path / name).write_text(content)
        with pytest.raises(LutError, match=problem) as caught:
            apply_lut(Photo(np.full((2, 2, 3), 0.5, np.float32)), tmp_path / name)
        text = str(caught.value)
        assert text.startswith(f"{tmp_path / name}: ")
        assert "; " in text
        assert "\n" not in text

    def test_folder(self, tmp_path: Path) -> None:
        with pytest.raises(LutError, match="is a folder"):
            apply_lut(Photo(np.full((2, 2, 3), 0.5, np.float32)), tmp_path)
