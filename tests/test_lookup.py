"""Lookups, against OpenColorIO's own CPU processor and against the curve."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from photo_files import CURVE, GRID, write_spi1d

import facecrf_ocio.image.lookup
from facecrf_ocio.errors import LutError, SettingsError
from facecrf_ocio.image.lookup import Lookup, curve_lookup
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.image.pixel_types import HALF_MAX
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF

Pixels = npt.NDArray[Any]


def by_ocio(lut: Path, values: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """What OpenColorIO makes of (..., 3) float32."""
    transform = ocio.FileTransform(src=str(lut))
    processor = ocio.Config.CreateRaw().getProcessor(transform)
    result = np.array(values, np.float32, order="C")
    processor.getOptimizedCPUProcessor(ocio.OptimizationFlags.OPTIMIZATION_LOSSLESS).applyRGB(
        result
    )
    ocio.ClearAllCaches()
    return result


def every_code(dtype: Any, channels: int = 3) -> Pixels:
    """(N, 256, C) all values of the type, another order in each channel; finite if half."""
    count = 256 if dtype is np.uint8 else 65536
    codes = np.arange(count, dtype=np.uint8 if dtype is np.uint8 else np.uint16)
    planes = [np.roll(codes, 1000 * channel) for channel in range(channels)]
    return np.stack(planes, axis=-1).view(dtype).reshape(-1, 256, channels)


def as_float(pixels: Pixels) -> npt.NDArray[np.float32]:
    if pixels.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            return pixels.astype(np.float32)
    return (pixels / np.float64(np.iinfo(pixels.dtype).max)).astype(np.float32)


TYPES = [np.uint8, np.uint16, np.float16]
FORMATS = ["spi1d", "cube", "clf", "ctf", "csp"]


class TestEqualsOcio:
    @pytest.mark.parametrize("suffix", FORMATS)
    @pytest.mark.parametrize("dtype", TYPES)
    def test_at_every_value_of_the_type(self, tmp_path: Path, dtype: Any, suffix: str) -> None:
        lut = write_lut(CURVE, tmp_path / f"a.{suffix}")
        pixels = every_code(dtype)
        expected = by_ocio(lut, as_float(pixels))
        assert np.abs(lut_lookup(lut).apply(pixels) - expected).max() < 1e-6
        half = lut_lookup(lut).apply(pixels, dtype=np.float16)
        assert half.dtype == np.float16
        assert np.array_equal(half, expected.astype(np.float16))

    @pytest.mark.parametrize("dtype", [np.float32, np.float16])
    def test_beyond_the_domain_and_nan(self, tmp_path: Path, dtype: Any) -> None:
        lut = write_spi1d(tmp_path / "a.spi1d")
        values = np.array([-np.inf, -0.5, 0, 0.25, 1, 1.5, np.inf, np.nan], dtype)
        pixels = np.repeat(values[None, :, None], 3, axis=2)
        expected = by_ocio(lut, as_float(pixels))
        assert np.array_equal(expected[0, [0, 1, 5, 6, 7], 0], [0, 0, 1, 1, 0])
        assert np.abs(lut_lookup(lut).apply(pixels) - expected).max() < 1e-6
        assert np.abs(curve_lookup(CURVE).apply(pixels) - expected).max() < 1e-6

    @pytest.mark.parametrize("dtype", [np.float32, np.float16])
    def test_floats_in_bands(self, tmp_path: Path, dtype: Any) -> None:
        lut = write_spi1d(tmp_path / "a.spi1d")
        pixels = np.random.default_rng(2).random((700, 300, 3), np.float32) * 1.2 - 0.1
        found = lut_lookup(lut).apply(pixels, dtype=dtype)
        expected = by_ocio(lut, pixels)
        assert np.array_equal(found, expected.astype(dtype))

    def test_channels_that_depend_on_each_other(self, tmp_path: Path) -> None:
        lut = write_lut(CURVE, tmp_path / "a.clf", space="acescg", primaries=None)
        pixels = every_code(np.uint8)
        lookup = lut_lookup(lut)
        assert not lookup.separable
        assert np.abs(lookup.apply(pixels) - by_ocio(lut, as_float(pixels))).max() < 1e-6


class TestCurve:
    @pytest.mark.parametrize("dtype", TYPES)
    def test_equals_the_curve(self, dtype: Any) -> None:
        pixels = every_code(dtype)
        inside = np.clip(np.nan_to_num(as_float(pixels), nan=0), 0, 1)
        expected = CURVE.linearize(inside)
        assert np.array_equal(curve_lookup(CURVE).apply(pixels), expected)

    @pytest.mark.parametrize("bits", [10, 12])
    def test_codes_of_fewer_bits(self, bits: int) -> None:
        maximum = 2**bits - 1
        codes = np.random.default_rng(1).integers(0, maximum, (20, 30, 3), np.uint16, endpoint=True)
        found = curve_lookup(CURVE).apply(codes, maximum=maximum)
        assert np.array_equal(found, CURVE.linearize((codes / maximum).astype(np.float32)))


class TestChannels:
    @pytest.mark.parametrize("dtype", [*TYPES, np.float32])
    @pytest.mark.parametrize("color", [(0, 1, 2), (4, 1, 0)])
    def test_those_that_are_no_color_keep_their_values(
        self, dtype: Any, color: tuple[int, ...]
    ) -> None:
        pixels = every_code(np.uint16 if dtype is np.float32 else dtype, 5)[20:60]
        pixels = as_float(pixels) if dtype is np.float32 else pixels
        found = curve_lookup(CURVE).apply(pixels, color=color)
        assert np.array_equal(found[..., color], CURVE.linearize(as_float(pixels)[..., color]))
        others = [channel for channel in range(5) if channel not in color]
        assert np.allclose(found[..., others], as_float(pixels)[..., others], rtol=0, atol=6e-8)

    @pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
    def test_colors_multiplied_by_alpha(self, dtype: Any) -> None:
        rng = np.random.default_rng(8)
        alpha = rng.random((30, 20, 1))
        alpha[0], alpha[1] = 0, 1
        largest = 1 if dtype is np.float32 else np.iinfo(dtype).max
        pixels = np.concatenate([rng.random((30, 20, 3)) * alpha, alpha], axis=2) * largest
        pixels = pixels.astype(dtype) if dtype is np.float32 else np.rint(pixels).astype(dtype)
        values = as_float(pixels).astype(np.float64)
        coverage = np.where(values[..., 3:] > 0, values[..., 3:], 1)
        expected = CURVE.linearize(values[..., :3] / coverage) * coverage
        found = curve_lookup(CURVE).apply(pixels, alpha=3)
        assert np.abs(found[..., :3] - expected).max() < 1e-6
        assert np.allclose(found[..., 3], values[..., 3], rtol=0, atol=6e-8)

    @pytest.mark.parametrize("dtype", [np.uint8, np.float32])
    def test_gray_goes_through_one_curve_only(self, dtype: Any) -> None:
        gray = InverseCRF(GRID, np.stack([GRID**2] * 3))
        pixels = every_code(np.uint8, 2)
        pixels = as_float(pixels) if dtype is np.float32 else pixels
        found = curve_lookup(gray).apply(pixels, color=(1,))
        assert np.abs(found[..., 1] - as_float(pixels)[..., 1] ** 2).max() < 1e-6
        assert np.array_equal(found[..., 0], as_float(pixels)[..., 0])
        with pytest.raises(SettingsError, match="unlike each other"):
            curve_lookup(CURVE).apply(pixels, color=(1,))


class TestMemory:
    @pytest.mark.parametrize("dtype", [*TYPES, np.float32])
    @pytest.mark.parametrize("kind", [np.float16, np.float32])
    def test_results_go_into_the_buffer_that_is_given(self, dtype: Any, kind: Any) -> None:
        pixels = every_code(np.uint8)[:, :200]
        pixels = as_float(pixels).astype(dtype) if np.dtype(dtype).kind == "f" else pixels
        pixels = pixels.astype(dtype)
        for buffer in (np.empty(pixels.shape, kind), np.empty((1, 400, 3), kind)[:, ::2]):
            assert curve_lookup(CURVE).apply(pixels, out=buffer) is buffer
            assert np.array_equal(buffer, curve_lookup(CURVE).apply(pixels, dtype=kind))

    def test_input_is_left_alone(self, tmp_path: Path) -> None:
        pixels = np.random.default_rng(2).random((30, 40, 3), np.float32)
        before = pixels.copy()
        lut_lookup(write_spi1d(tmp_path / "a.spi1d")).apply(pixels)
        assert np.array_equal(pixels, before)

    def test_in_place(self) -> None:
        pixels = np.random.default_rng(2).random((30, 40, 3), np.float32)
        expected = CURVE.linearize(pixels)
        curve_lookup(CURVE).apply(pixels, out=pixels)
        assert np.array_equal(pixels, expected)

    def test_no_pixels(self) -> None:
        assert curve_lookup(CURVE).apply(np.empty((0, 4, 3), np.uint8)).shape == (0, 4, 3)


class TestWithoutTablesOf16Bits:
    """OpenCV before 4.13 has none."""

    @pytest.mark.parametrize("dtype", [np.uint16, np.float16])
    @pytest.mark.parametrize("kind", [np.float16, np.float32])
    def test_numpy_gives_the_same(
        self, dtype: Any, kind: Any, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        pixels = every_code(dtype, 4)
        expected = curve_lookup(CURVE).apply(pixels, dtype=kind)
        monkeypatch.setattr(facecrf_ocio.image.lookup, "opencv_looks_up_16_bits", lambda: False)
        found = curve_lookup(CURVE).apply(pixels, dtype=kind)
        assert np.array_equal(found, expected, equal_nan=True)


class TestWhatCannotBeRepresented:
    @pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float16, np.float32])
    def test_half_is_clamped_to_its_largest_value(self, dtype: Any) -> None:
        def brighten(values: Pixels, out: Pixels) -> None:
            out[...] = values * np.float32(1e6)

        pixels = every_code(np.uint8) if dtype is np.uint8 else np.ones((2, 2, 3), dtype)
        pixels = np.full_like(pixels, 255) if dtype is np.uint8 else pixels
        pixels = np.full_like(pixels, 65535) if dtype is np.uint16 else pixels
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # numpy's own conversion
            found = Lookup(brighten).apply(pixels, dtype=np.float16)
        assert (found == HALF_MAX).all()

    @pytest.mark.parametrize("kind", [np.float16, np.float32])
    @pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float16, np.float32])
    def test_infinite_results_are_refused_where_they_occur(self, dtype: Any, kind: Any) -> None:
        def logarithm(values: Pixels, out: Pixels) -> None:
            with np.errstate(divide="ignore", invalid="ignore"):
                out[...] = np.log(values)

        pixels = np.ones((4, 5, 3), dtype)
        lookup = Lookup(logarithm, name="a.clf")
        assert np.isfinite(lookup.apply(pixels, dtype=kind)).all()
        pixels[2, 2, 1] = 0
        with pytest.raises(LutError, match=r"a\.clf: gives NaN or infinite values"):
            lookup.apply(pixels, dtype=kind)


class TestWrongUse:
    @pytest.mark.parametrize(
        ("pixels", "options", "problem"),
        [
            (np.zeros((2, 3), np.uint8), {}, "must be"),
            (np.zeros((2, 2, 3), np.int32), {}, "must be"),
            (np.zeros((2, 2, 3), np.uint8), {"dtype": np.uint8}, "must be float16 or float32"),
            (np.zeros((2, 2, 3), np.uint8), {"out": np.zeros((2, 2, 4), "f")}, "same shape"),
            (np.zeros((2, 2, 2), np.uint8), {}, "no channels"),
            (np.zeros((2, 2, 3), np.uint8), {"color": (0, 1)}, "no channels"),
        ],
    )
    def test_is_told(self, pixels: Pixels, options: dict[str, Any], problem: str) -> None:
        with pytest.raises(SettingsError, match=problem):
            curve_lookup(CURVE).apply(pixels, **options)
