"""Noise against level: what a whole photo tells of the slope of its curve."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.joint.grain import NoiseTable, measure_noise, noise_curve
from facecrf_ocio.joint.noise_counts import count_noise
from facecrf_ocio.joint.second_differences import LEVELS, RESIDUES

FULL_WELL = 4000.0
MIDDLES = (np.arange(LEVELS) + 0.5) / LEVELS


def measured(photo: npt.NDArray[np.float32]) -> NoiseTable:
    return measure_noise(count_noise([photo]))


def photo_of(power: float, *, side: int = 400, seed: int = 0) -> npt.NDArray[np.float32]:
    """A gray ramp with photon noise, encoded so that linear light is encoded ** power, 8 bits."""
    generator = np.random.default_rng(seed)
    light = np.linspace(0.0, 1.0, side)[None, :, None] ** power * np.ones((side, 1, 3))
    noisy = light + generator.normal(size=light.shape) * np.sqrt(light / FULL_WELL)
    codes = np.rint(np.clip(noisy, 0.0, 1.0) ** (1.0 / power) * 255.0)
    return np.asarray(codes / 255.0, dtype=np.float32)


def parts(vector: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], ...]:
    """Mean, curve, trust, offsets, shares of the root of light."""
    return tuple(np.split(vector, np.cumsum([1, LEVELS, LEVELS, 2])))


@pytest.mark.parametrize("power", [0.6, 1.0, 1.6, 2.2, 3.0])
def test_the_sum_of_inverse_deviations_is_the_root_of_light(power: float) -> None:
    vector = noise_curve(measured(photo_of(power)))
    assert vector is not None
    # From the third level on: nearer to black, noise is below rounding or clipped.
    shares = np.append(parts(vector)[-1], 1.0)[2:]
    truth = (np.arange(3, LEVELS + 1) / LEVELS) ** (power / 2.0)
    seen, expected = ((s - s[0]) / (s[-1] - s[0]) for s in (shares, truth))
    assert np.abs(seen - expected).max() < 0.03


def test_the_deviation_is_that_of_a_second_difference() -> None:
    # Of independent noise with deviation s in codes, 1 -2 1 x 1 -2 1 has 6 s; a normal's absolute
    # value lies below 0.3853 deviations 30 % of the time.
    generator = np.random.default_rng(3)
    codes = np.rint(128.0 + 5.0 * generator.normal(size=(600, 600, 3)))
    table = measured((codes / 255.0).astype(np.float32))
    seen = table.count > 20_000
    assert seen.any()
    deviation = np.average(table.deviation[seen], weights=table.count[seen])
    assert deviation == pytest.approx(6.0 * 0.3853 * np.hypot(5.0, 12.0**-0.5), rel=0.02)


def test_every_pixel_inside_is_counted_unless_it_or_a_neighbor_is_clipped() -> None:
    generator = np.random.default_rng(1)
    codes = generator.integers(1, 255, (40, 50, 3)).astype(np.float32)
    assert measured(codes / 255.0).count.sum(axis=1).tolist() == [38 * 48] * 3
    codes[20, 20, 0], codes[10, 10, 1] = 255.0, 0.0
    counts = measured(codes / 255.0).count.sum(axis=1)
    assert counts.tolist() == [38 * 48 - 9, 38 * 48 - 9, 38 * 48]


@pytest.mark.parametrize("code", [0.0, 1.0])
def test_a_clipped_photo_says_nothing(code: float) -> None:
    table = measured(np.full((64, 64, 3), code, np.float32))
    assert noise_curve(table) is None
    assert not table.count.any()


@pytest.mark.parametrize("shape", [(1, 1, 3), (2, 500, 3), (500, 2, 3)])
def test_a_photo_without_an_inside_says_nothing(shape: tuple[int, int, int]) -> None:
    assert noise_curve(measured(np.full(shape, 0.5, np.float32))) is None


def test_a_ramp_without_noise_has_none() -> None:
    ramp = np.broadcast_to(np.linspace(0.2, 0.8, 300, dtype=np.float32)[None, :, None], (9, 300, 3))
    # Rounding moves a code by half of one at most, of which three rows of a column agree.
    assert measured(ramp).deviation.max() < 1.0


def test_levels_and_differences_are_those_of_plain_sums() -> None:
    codes = np.random.default_rng(7).integers(1, 255, (12, 14, 3)).astype(np.int64)
    table = measured((codes / 255.0).astype(np.float32))
    kernel = np.outer([1, -2, 1], [1, -2, 1])
    for channel in range(3):
        found: list[list[int]] = [[] for _ in range(LEVELS)]
        for y in range(1, 11):
            for x in range(1, 13):
                around = codes[y - 1 : y + 2, x - 1 : x + 2, channel]
                level = int(around.sum()) * LEVELS // (9 * 255 + 1)
                found[level].append(abs(int((kernel * around).sum())))
        assert table.count[channel].tolist() == [len(values) for values in found]
        for level, values in enumerate(found):
            if values:
                quantile = table.deviation[channel, level]
                place = np.searchsorted(RESIDUES - 0.5, max(quantile - 1e-9, 0.0), side="right") - 1
                low, high = (*RESIDUES, 1024)[place : place + 2]
                kept = np.minimum(values, 1023)
                assert np.mean(kept < low) <= 0.3 + 1e-9
                assert np.mean(kept < high) >= 0.3 - 1e-9


def test_a_quarter_of_the_size_is_measured_too() -> None:
    # Counted in units of what independent noise leaves in sums of four by four pixels.
    generator = np.random.default_rng(4)
    codes = np.rint(128.0 + 12.0 * generator.normal(size=(1200, 1200, 3)))
    counts = count_noise([(codes / 255.0).astype(np.float32)])
    whole, quarter = (measure_noise(counts, size) for size in (0, 2))
    level = int(np.argmax(quarter.count[1]))
    ratio = quarter.deviation[1, level] / whole.deviation[1, level]
    assert ratio == pytest.approx(1.0, rel=0.05)


def test_masked_pixels_are_not_counted_and_weights_are() -> None:
    generator = np.random.default_rng(8)
    photo = generator.integers(90, 110, (60, 60, 3)).astype(np.float32) / 255.0
    mask = np.zeros((60, 60), bool)
    mask[20:40, 10:50] = True
    counts = count_noise([photo], [mask], [3.0])
    assert counts.histograms[0].sum(axis=(1, 2)).tolist() == [3.0 * 20 * 40] * 3
    of_all = count_noise([photo], None, [3.0])
    assert of_all.codes.sum(axis=1).tolist() == [3.0 * 3600] * 3
    # Of a part of a photo nobody asks for these.
    assert not any(found.any() for found in (counts.codes, counts.blocks, counts.edges))


def tables() -> st.SearchStrategy[NoiseTable]:
    numbers = st.lists(st.floats(0.0, 300.0), min_size=3 * LEVELS, max_size=3 * LEVELS)
    counts = st.lists(st.sampled_from([0, 5, 29, 30, 200, 10**6]), min_size=72, max_size=72)
    return st.tuples(numbers, counts).map(
        lambda drawn: NoiseTable(*(np.reshape(part, (3, LEVELS)) * 1.0 for part in drawn))
    )


@given(tables())
def test_the_curve_is_the_least_squares_solution(table: NoiseTable) -> None:
    vector = noise_curve(table)
    known = np.where(table.count >= 30, table.count / (table.count + 150.0), 0.0) * 8.0
    if not known.any():
        assert vector is None
        return
    assert vector is not None
    assert np.isfinite(vector).all()
    rows, right = [], []
    for channel, offset in ((0, LEVELS), (1, None), (2, LEVELS + 1)):
        for level in range(LEVELS):
            row = np.zeros(LEVELS + 2)
            row[level] = 1.0
            if offset is not None:
                row[offset] = 1.0
            weight = np.sqrt(known[channel, level])
            rows.append(weight * row)
            right.append(weight * np.log(table.deviation[channel, level] + 0.25))
    whole = np.eye(LEVELS + 2)
    rows += [
        *np.diff(whole[:LEVELS], 2, axis=0),
        *(np.sqrt(0.02) * np.diff(whole[:LEVELS], axis=0)),
        *(1e-3 * whole[:LEVELS]),
        *(np.sqrt(0.05) * whole[LEVELS:]),
    ]
    right += [0.0] * (len(rows) - len(right))
    expected = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
    mean, curve, trust, offsets, shares = parts(vector)
    assert np.allclose(curve + mean, expected[:LEVELS], atol=1e-5)
    assert np.allclose(offsets, expected[LEVELS:], atol=1e-5)
    assert np.allclose(np.exp(trust) - 0.05, known.sum(axis=0))
    assert np.all(np.diff(shares) > 0.0)
    assert 0.0 < shares[0] < shares[-1] < 1.0


def test_white_balance_is_an_offset_and_no_other_curve() -> None:
    photo = photo_of(1.0, side=600)
    balanced = photo_of(1.0, side=600, seed=1)
    # Gains of two on red: its noise in light is larger by the root of two at equal code values.
    light = np.linspace(0.0, 1.0, 600)[None, :] * np.ones((600, 1))
    noise = np.random.default_rng(2).normal(size=light.shape) * np.sqrt(2.0 * light / FULL_WELL)
    balanced[..., 0] = np.rint(np.clip(light + noise, 0.0, 1.0) * 255.0) / 255.0
    before, after = noise_curve(measured(photo)), noise_curve(measured(balanced))
    assert before is not None
    assert after is not None
    assert np.abs(parts(after)[1] - parts(before)[1]).max() < 0.1
    assert parts(after)[3] == pytest.approx([0.5 * np.log(2.0), 0.0], abs=0.05)


def test_smooth_shading_and_a_slope_are_no_noise() -> None:
    flat = np.random.default_rng(5).normal(0.5, 0.02, (300, 300, 1)).repeat(3, axis=2)
    slope = np.linspace(-0.2, 0.2, 300)[None, :, None]
    level = slice(8, 16)
    tables_of = [measured(np.asarray(p, np.float32)) for p in (flat, flat + slope)]
    found = [np.average(t.deviation[1, level], weights=t.count[1, level]) for t in tables_of]
    assert found[0] == pytest.approx(found[1], rel=0.05)


def test_codes_are_those_of_eight_bits_whatever_the_photo_has() -> None:
    fine = np.random.default_rng(6).uniform(0.1, 0.9, (64, 64, 3)).astype(np.float32)
    coarse = np.rint(fine * np.float32(255.0)) / np.float32(255.0)
    a, b = measured(fine), measured(coarse.astype(np.float32))
    assert np.array_equal(a.deviation, b.deviation)
    assert np.array_equal(a.count, b.count)


def test_blur_lowers_the_mean_and_leaves_the_shape() -> None:
    photo = photo_of(2.2, side=500)
    soft = cv2.GaussianBlur(photo, (0, 0), 0.6)
    sharp_vector, soft_vector = noise_curve(measured(photo)), noise_curve(measured(soft))
    assert sharp_vector is not None
    assert soft_vector is not None
    assert soft_vector[0] < sharp_vector[0] - 0.3
    bright = slice(6, LEVELS - 2)
    assert np.abs(parts(soft_vector)[1] - parts(sharp_vector)[1])[bright].max() < 0.3
