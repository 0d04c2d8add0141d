"""What goes into the bench: responses, folds, photos of known response, linear images."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import facecrf_ocio
from facecrf_ocio.benchmark import cases
from facecrf_ocio.benchmark.cases import choose_estimators
from facecrf_ocio.benchmark.folds import (
    GUARD_ROWS,
    assign_folds,
    fit_held_out,
    training_rows,
)
from facecrf_ocio.benchmark.images import find_linear_images
from facecrf_ocio.benchmark.responses import Responses, read_responses, spread_rows
from facecrf_ocio.benchmark.virtual_camera import (
    FULL_WELL_ISO_100,
    READ_NOISE,
    CameraEncoding,
    count_codes,
    take_photo,
)
from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.estimators import ESTIMATOR_NAMES, FIXED_CURVES

PACKAGE = Path(facecrf_ocio.__file__).parent
GRID = np.linspace(0.0, 1.0, 1024)
GAMMA = np.array([GRID**2.2] * 3)


def powers(count, families=None):
    exponents = np.linspace(0.8, 3.0, count)
    inverse = np.repeat((GRID ** exponents[:, None])[:, None], 3, axis=1)
    names = tuple(f"curve {i}" for i in range(count))
    return Responses(inverse, names, families, Path("curves.npz"), "0" * 64)


def rng(seed=0):
    return np.random.default_rng(seed)


def ramp(height=64, width=96):
    values = rng(5).random((height, width, 3)).astype(np.float32)
    return values * np.linspace(0.0, 1.0, width, dtype=np.float32)[:, None]


class TestResponses:
    @pytest.mark.parametrize("key", ["inverse", "anything"])
    def test_one_curve_for_all_channels_or_three(self, tmp_path, key):
        curves = np.array([GRID, GRID**2, GRID**3])
        np.savez(tmp_path / "a.npz", **{key: curves})
        np.savez(tmp_path / "b.npz", **{key: np.stack([curves, curves**2])})
        single, triple = (read_responses(tmp_path / name) for name in ("a.npz", "b.npz"))
        assert single.inverse.shape == (3, 3, 1024)
        assert (single.inverse == curves[:, None]).all()
        assert triple.inverse.shape == (2, 3, 1024)
        np.testing.assert_array_equal(triple.inverse[1], curves**2)
        assert single.families is None
        assert single.names[2] == "row 2"

    def test_other_samplings_are_brought_to_1024_values(self, tmp_path):
        np.savez(tmp_path / "a.npz", inverse=[np.linspace(0, 1, 4097) ** 2])
        found = read_responses(tmp_path / "a.npz").inverse[0, 0]
        np.testing.assert_allclose(found, GRID**2, atol=1e-7)

    def test_names_makers_and_kinds_come_along(self, tmp_path):
        told = {"names": ["x", "y"], "maker": ["Nikon", "Pentax"], "kind": ["scan", "webcam"]}
        np.savez(tmp_path / "a.npz", inverse=[GRID, GRID**2], **told)
        found = read_responses(tmp_path / "a.npz")
        assert found.names == ("x", "y")
        assert found.families == ("Nikon", "Pentax")
        assert [found.kind(row) for row in (0, 1)] == ["scan", "webcam"]

    @pytest.mark.parametrize(
        "curve", [1 - GRID, 0.9 * GRID, GRID + 0.1, np.where(GRID > 0.5, np.nan, GRID)]
    )
    def test_what_does_not_rise_from_0_to_1_is_refused_by_its_row(self, tmp_path, curve):
        np.savez(tmp_path / "a.npz", inverse=[GRID, curve])
        with pytest.raises(PhotoError, match=r"a\.npz: row 1 does not rise"):
            read_responses(tmp_path / "a.npz")

    @pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04 cut"])
    def test_other_files_are_refused_by_name(self, tmp_path, content):
        (tmp_path / "a.npz").write_bytes(content)
        with pytest.raises(PhotoError, match=r"a\.npz: is neither"):
            read_responses(tmp_path / "a.npz")
        with pytest.raises(PhotoError, match=r"none\.npz: no such file"):
            read_responses(tmp_path / "none.npz")

    @settings(max_examples=60, deadline=None)
    @given(st.integers(1, 300), st.integers(1, 40), st.integers(1, 50))
    def test_rows_are_spread_over_the_file(self, count, every, limit):
        rows = spread_rows(count, every, limit)
        assert len(rows) == min(limit, -(-count // every))
        assert all(row % every == 0 and row < count for row in rows)
        assert list(rows) == sorted(set(rows))

    def test_equal_channels_count_once_in_training(self):
        responses = powers(3)
        colored = responses.inverse.copy()
        colored[1, 2] = GRID**5
        responses = replace(responses, inverse=colored)
        assert responses.training_curves(np.array([0, 1])).shape == (4, 1024)


class TestFolds:
    @settings(max_examples=60, deadline=None)
    @given(st.integers(2, 60), st.integers(2, 9))
    def test_blocks_are_contiguous_and_of_nearly_equal_size(self, count, folds):
        fold_of = assign_folds(powers(count), folds)
        sizes = np.bincount(fold_of)
        assert len(sizes) == min(folds, count)
        assert sizes.max() - sizes.min() <= 1
        assert (np.diff(fold_of) >= 0).all()

    @settings(max_examples=60, deadline=None)
    @given(st.lists(st.sampled_from("ABCDEFG"), min_size=2, max_size=40), st.integers(2, 6))
    def test_no_maker_is_split(self, makers, folds):
        responses = powers(len(makers), tuple(makers))
        if len(set(makers)) < 2:
            with pytest.raises(SettingsError, match="1 makers"):
                assign_folds(responses, folds)
            return
        fold_of = assign_folds(responses, folds)
        assert set(fold_of) == set(range(min(folds, len(set(makers)))))
        for maker in set(makers):
            assert len({f for f, m in zip(fold_of, makers, strict=True) if m == maker}) == 1

    def test_siblings_next_to_a_block_are_kept_from_its_prior(self):
        responses = powers(30)
        fold_of = assign_folds(responses, 3)
        np.testing.assert_array_equal(
            training_rows(responses, fold_of, 1),
            [*range(10 - GUARD_ROWS), *range(20 + GUARD_ROWS, 30)],
        )

    @pytest.mark.parametrize("families", [None, ("A", "B", "C") * 20])
    def test_the_prior_does_not_depend_on_the_curves_held_out(self, families):
        responses = powers(60, families)
        fold_of = assign_folds(responses, 3)
        for fold in range(3):
            spoiled = responses.inverse.copy()
            spoiled[fold_of == fold] = GRID**30
            usual = fit_held_out(responses, fold_of, fold)
            other = fit_held_out(replace(responses, inverse=spoiled), fold_of, fold)
            np.testing.assert_array_equal(usual.mean, other.mean)
            np.testing.assert_array_equal(usual.basis, other.basis)
            np.testing.assert_array_equal(usual.mixture.means, other.mixture.means)

    def test_too_few_curves_for_a_prior_are_refused(self):
        responses = powers(12)
        with pytest.raises(SettingsError, match="are left to fit the prior to"):
            fit_held_out(responses, assign_folds(responses, 3), 0)


class TestCamera:
    @pytest.mark.parametrize("bits", [8, 10, 12, 16])
    def test_code_values_are_those_of_the_response(self, bits):
        linear = ramp()
        photo = take_photo(linear, GAMMA, CameraEncoding(bits), rng())
        top = 2**bits - 1
        codes = photo.encoded.astype(np.float64) * top
        np.testing.assert_allclose(codes, np.rint(codes), atol=1e-2)
        lowest, highest = ((np.rint(codes) + d) / top for d in (-0.5, 0.5))
        g = [np.interp(bound, GRID, GAMMA[0]) for bound in (lowest, highest)]
        assert (g[0] - 1e-7 <= linear).all()
        assert (linear <= g[1] + 1e-7).all()
        assert photo.bit_depth == bits
        assert not photo.scene_linear

    def test_each_channel_has_its_own_response(self):
        linear = np.full((8, 8, 3), 0.25, np.float32)
        photo = take_photo(linear, np.array([GRID, GRID**2, GRID**0.5]), CameraEncoding(16), rng())
        np.testing.assert_allclose(photo.encoded[0, 0], [0.25, 0.5, 0.0625], atol=1e-4)

    def test_the_sensor_saturates(self):
        photo = take_photo(np.full((4, 4, 3), 7.0, np.float32), GAMMA, CameraEncoding(), rng())
        assert (photo.encoded == 1.0).all()

    def test_jpeg_is_what_another_reader_decodes_from_it(self):
        plain = take_photo(ramp(), GAMMA, CameraEncoding(), rng())
        photo = take_photo(ramp(), GAMMA, CameraEncoding(jpeg=90), rng())
        rgb = np.rint(plain.encoded * 255).astype(np.uint8)
        _, content = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])
        decoded = np.asarray(Image.open(io.BytesIO(content.tobytes())), dtype=np.int64)
        assert np.abs(decoded - np.rint(photo.encoded * 255)).max() <= 3  # decoders round apart
        assert np.abs(photo.encoded - plain.encoded).max() > 0.01

    def test_noise_has_the_variance_of_photons_and_reading(self):
        linear = np.full((200, 200, 3), 0.3, np.float32)
        identity = np.tile(GRID, (3, 1))
        photo = take_photo(linear, identity, CameraEncoding(16, iso=1600), rng(1))
        well = FULL_WELL_ISO_100 / 16
        expected = np.sqrt(0.3 * well + READ_NOISE**2) / well
        assert photo.encoded.std() == pytest.approx(expected, rel=0.02)
        assert photo.encoded.mean() == pytest.approx(0.3, abs=1e-3)

    def test_codes_are_counted_once_each(self):
        photo = take_photo(ramp(), GAMMA, CameraEncoding(), rng())
        counted = count_codes(photo)
        assert counted.shape == (3, 256)
        for channel in range(3):
            codes = np.rint(photo.encoded[..., channel] * 255)
            assert counted[channel, 17] == (codes == 17).sum()
        assert counted.sum() == photo.encoded.size
        assert count_codes(take_photo(ramp(), GAMMA, CameraEncoding(16), rng())).shape == (3, 4096)

    @pytest.mark.parametrize("wrong", [{"bits": 7}, {"bits": 16, "jpeg": 90}, {"iso": 0.0}])
    def test_impossible_files_are_refused(self, wrong):
        with pytest.raises(SettingsError):
            CameraEncoding(**wrong)


def write(path, channels, pixel_type, names=None):
    spec = oiio.ImageSpec(16, 12, channels, pixel_type)
    if names:
        spec.channelnames = names
    path.parent.mkdir(exist_ok=True)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec)
    assert file.write_image(rng().random((12, 16, channels)).astype(np.float32))
    file.close()


class TestImages:
    def test_linear_files_are_found_and_others_named(self, tmp_path):
        write(tmp_path / "a.exr", 3, "half")
        write(tmp_path / "b.tif", 3, "uint16")
        write(tmp_path / "c.png", 3, "uint16")
        write(tmp_path / "d.png", 3, "uint8")
        write(tmp_path / "e.exr", 3, "half", ("N.X", "N.Y", "N.Z"))
        (tmp_path / "notes.txt").write_text("no image")
        found = find_linear_images(tmp_path)
        assert [image.name for image in found.images] == ["a.exr", "b.tif", "c.png"]
        assert "d.png: 8 bits" in found.left_out[0]
        assert "e.exr: has no channels R, G, B" in found.left_out[1]
        only = find_linear_images(tmp_path, "*.tif").images
        assert [image.name for image in only] == ["b.tif"]

    def test_subfolders_are_searched_where_the_folder_has_no_image(self, tmp_path):
        write(tmp_path / "img" / "a.exr", 3, "half")
        assert [image.name for image in find_linear_images(tmp_path).images] == ["img/a.exr"]

    def test_a_folder_without_linear_images_is_refused(self, tmp_path):
        with pytest.raises(PhotoError, match="holds no images"):
            find_linear_images(tmp_path)
        write(tmp_path / "d.png", 3, "uint8")
        with pytest.raises(PhotoError, match="holds 1 images, none of them linear"):
            find_linear_images(tmp_path)


class TestEstimators:
    def test_all_is_every_one_but_auto_with_the_fixed_answers_last(self):
        chosen = choose_estimators("all")
        assert set(chosen) == set(ESTIMATOR_NAMES) - {"auto"}
        assert chosen[-len(FIXED_CURVES) :] == FIXED_CURVES

    def test_the_fixed_answers_join_every_choice(self):
        assert choose_estimators("face") == ("face", *FIXED_CURVES)
        assert choose_estimators("mean,face, auto") == ("auto", "face", *FIXED_CURVES)

    @pytest.mark.parametrize("names", ["nothing", "", "face,wrong"])
    def test_unknown_ones_are_refused(self, names):
        with pytest.raises(SettingsError, match="no estimator"):
            choose_estimators(names)


def test_results_depend_on_code_and_models_and_on_no_page_s_style():
    """A comment in a style sheet made results of a bench out of date."""
    measured = {path for pattern in cases._MEASURED for path in PACKAGE.glob(pattern)}
    assert {path.suffix for path in measured} == {".py", ".npz", ".halves", ".onnx"}
    assert PACKAGE / "joint" / "joint_model.npz" in measured
