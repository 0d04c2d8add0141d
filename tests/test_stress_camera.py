"""The camera of the stress table does what each condition says, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from facecrf_ocio.benchmark.conditions import CELLS, SAMPLINGS, Conditions, a_day
from facecrf_ocio.benchmark.stress_camera import photograph
from facecrf_ocio.benchmark.virtual_camera import FULL_WELL_ISO_100, READ_NOISE

GRID = np.linspace(0.0, 1.0, 1024)
SQUARE = np.tile(GRID**2, (3, 1))
PLAIN = Conditions()


def scene(height=560, width=640, seed=0):
    """Smooth colored light between 0.05 and 0.5; large enough not to be enlarged."""
    coarse = np.random.default_rng(seed).uniform(0.05, 0.5, (6, 6, 3)).astype(np.float32)
    return cv2.resize(coarse, (width, height), interpolation=cv2.INTER_LINEAR)


def take(light, conditions=PLAIN, seed=0):
    return photograph(light, SQUARE, conditions, np.random.default_rng(seed))


def linear(codes):
    return (codes / 255.0) ** 2


def assert_alike(codes, wanted):
    """The same, but where a value lies halfway between two codes and 16-bit light decides."""
    difference = np.abs(codes.astype(int) - np.rint(wanted).astype(int))
    assert difference.max() <= 1
    assert np.mean(difference > 0) < 0.005


def flat(level, height=560, width=640):
    return np.full((height, width, 3), level, np.float32)


def test_without_conditions_light_goes_through_the_curve_and_is_rounded():
    light = scene()
    assert_alike(take(light), np.sqrt(light) * 255.0)


def test_exposure_multiplies_light_with_powers_of_two():
    light = scene()
    assert_alike(take(light, Conditions(exposure=-1.0)), np.sqrt(light / 2) * 255.0)
    assert take(flat(0.6), Conditions(exposure=1.0)).min() == 255


def test_gains_are_a_white_balance():
    codes = take(scene(), Conditions(gains=(1.25, 1.0, 0.75)))
    ratio = linear(codes) / linear(take(scene()))
    np.testing.assert_allclose(ratio.mean(axis=(0, 1)), (1.25, 1.0, 0.75), rtol=5e-3)


def test_saturation_moves_colors_from_a_gray_that_stays():
    light, luma = scene(), np.array([0.2126, 0.7152, 0.0722])
    gray = linear(take(light, Conditions(saturation=0.0)))
    np.testing.assert_array_equal(gray[..., 0], gray[..., 2])
    np.testing.assert_allclose(gray[..., 0], light @ luma, atol=4e-3)


def test_small_scenes_are_enlarged_before_the_camera_and_large_ones_are_not_reduced():
    small = scene(200, 160)
    assert take(small).shape[0] * take(small).shape[1] == pytest.approx(0.3e6, rel=0.01)
    codes = take(small, Conditions(megapixels=1.5))
    assert codes.shape[0] * codes.shape[1] == pytest.approx(1.5e6, rel=0.01)
    assert take(scene(), Conditions(megapixels=0.1)).shape == (560, 640, 3)


def test_noise_comes_after_the_enlargement_and_is_that_of_photons_and_reading():
    iso, level = 800.0, 0.25
    codes = take(flat(level, 100, 100), Conditions(megapixels=1.0, iso=iso))
    light = np.sqrt(linear(codes))[100:-100, 100:-100, 1]  # the root of light: twice as fine
    well = FULL_WELL_ISO_100 * 100.0 / iso
    deviation = np.sqrt(level / well + (READ_NOISE / well) ** 2) / (2.0 * np.sqrt(level))
    rounding = (1.0 / 255.0) ** 2 / 12.0
    assert light.std() == pytest.approx(np.sqrt(deviation**2 + rounding), rel=0.03)
    neighbors = np.corrcoef(light[:, :-1].ravel(), light[:, 1:].ravel())[0, 1]
    assert abs(neighbors) < 0.02


def test_a_mosaic_is_interpolated_exactly_where_light_is_neutral_and_rises_evenly():
    ramp = np.tile(np.linspace(0.1, 0.6, 640, dtype=np.float32)[None, :, None], (560, 1, 3))
    inner = np.s_[4:-4, 4:-4]
    difference = take(ramp, Conditions(mosaic=True))[inner].astype(int) - take(ramp)[inner]
    assert np.abs(difference).max() <= 1


def test_a_mosaic_keeps_flat_colors():
    light = np.tile(np.array([0.1, 0.3, 0.5], np.float32), (560, 640, 1))
    difference = take(light, Conditions(mosaic=True)).astype(int) - take(light)
    assert np.abs(difference[4:-4, 4:-4]).max() <= 1


def test_interpolated_noise_is_alike_in_neighbors():
    noisy = Conditions(iso=1600.0, mosaic=True)
    red = take(flat(0.25), noisy)[50:-50, 50:-50, 0].astype(float)
    assert np.corrcoef(red[:, :-1].ravel(), red[:, 1:].ravel())[0, 1] > 0.2


@pytest.mark.parametrize("change", [{"denoise_before": 2.0}, {"denoise_after": 10.0}])
def test_noise_reduction_lowers_noise_and_keeps_level_and_edges(change):
    light = flat(0.1)
    light[:, 320:] = 0.4
    noisy = Conditions(iso=400.0)
    before, after = take(light, noisy).astype(float), take(light, replace(noisy, **change))
    left = np.s_[50:-50, 50:250]
    assert after[left].std() < 0.6 * before[left].std()
    assert after[left].mean() == pytest.approx(before[left].mean(), abs=0.8)  # codes are whole
    assert after[300, 330].mean() - after[300, 310].mean() > 60


def test_sharpening_steepens_edges_and_leaves_flat_parts():
    light = flat(0.1)
    light[:, 320:] = 0.4
    plain, sharp = take(light).astype(int), take(light, Conditions(sharpen=0.8)).astype(int)
    assert np.ptp(sharp[300]) > np.ptp(plain[300]) + 20
    np.testing.assert_array_equal(sharp[:, :300], plain[:, :300])


def test_half_size_averages_code_values():
    codes = take(scene()).astype(float)
    half = take(scene(), Conditions(halve=True))
    mean = codes.reshape(280, 2, 320, 2, 3).mean(axis=(1, 3))
    assert half.shape == (280, 320, 3)
    assert np.abs(half - mean).max() <= 1.0


def test_chroma_is_stored_as_coarsely_as_the_sampling_says():
    """Columns of one pixel in two colors of one luma: 4:4:4 keeps them, the others blend them."""
    light = flat(0.2)
    light[:, ::2] *= np.array([1.6, 0.85, 0.8], np.float32)
    contrast = {}
    for sampling in SAMPLINGS:
        codes = take(light, Conditions(quality=98, sampling=sampling)).astype(float)
        chroma = codes[100:-100, 100:-100, 0] - codes[100:-100, 100:-100, 1]
        contrast[sampling] = np.abs(np.diff(chroma, axis=1)).mean()
    assert contrast["4:4:4"] > 4 * contrast["4:2:2"]
    assert contrast["4:4:4"] > 4 * contrast["4:2:0"]


def test_a_lower_quality_errs_more():
    light, noisy = scene(), Conditions(iso=800.0)
    plain = take(light, noisy).astype(float)
    errors = [
        np.abs(take(light, replace(noisy, quality=quality)) - plain).mean()
        for quality in (98, 92, 85)
    ]
    assert 0 < errors[0] < errors[1] < errors[2]


def test_a_day_holds_what_it_says():
    days = [a_day(np.random.default_rng(seed)) for seed in range(800)]
    exposure = np.array([day.exposure for day in days])
    assert abs(exposure.mean()) < 0.1
    assert exposure.std() == pytest.approx(1.0, abs=0.08)
    assert np.std(np.log([day.gains for day in days])) == pytest.approx(0.1, abs=0.01)
    assert all(0.5 <= day.saturation <= 1.3 and 1.5 <= day.megapixels <= 6.0 for day in days)
    assert all(100 <= day.iso <= 3200 and day.mosaic and 86 <= day.quality <= 97 for day in days)
    for named, share in (("denoise_before", 0.6), ("sharpen", 0.5), ("halve", 0.3)):
        assert np.mean([getattr(day, named) > 0 for day in days]) == pytest.approx(share, abs=0.06)


def test_every_cell_has_its_own_name_and_most_change_one_thing():
    assert len({cell.name for cell in CELLS}) == len(CELLS)
    generator = np.random.default_rng(0)
    drawn = {cell.name: cell.draw(generator) for cell in CELLS}
    assert drawn["as it is"] == Conditions()
    assert drawn["-3 EV"] == Conditions(exposure=-3.0)
    assert drawn["JPEG 85 4:2:2"] == Conditions(quality=85, sampling="4:2:2")
    assert drawn["12 MP"].own_grain
