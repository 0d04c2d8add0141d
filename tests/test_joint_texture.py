"""Whether what varies from pixel to pixel is a sensor's noise."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from facecrf_ocio.joint.noise_counts import count_noise
from facecrf_ocio.joint.texture import GROUPS, noise_character

SIZE = 14 * GROUPS + 12
MIDDLE = 3  # group of level of the photos here
CODE = 140.0


def character(photo: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    return noise_character(count_noise([photo]))


def photo_with(noise: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """An even photo (H, W, 3) with this noise in codes, in 8 bits."""
    return np.asarray(np.rint(CODE + noise) / 255.0, dtype=np.float32)


def normal(channels: int = 3, seed: int = 0) -> npt.NDArray[np.float64]:
    return np.random.default_rng(seed).normal(size=(400, 400, channels))


def parts(vector: npt.NDArray[np.float64]) -> dict[str, npt.NDArray[np.float64]]:
    names = ("agreement", "agreement at half size", "at a quarter", "spread", "tails",
             "tails at half size", "tails at a quarter", "coarser", "coarser still", "channels",
             "neighbors", "diagonal", "second", "rounding")  # fmt: skip
    g = GROUPS
    cuts = np.cumsum([g, g, g, 3, g, g, g, g, g, 9, g, g, g])
    return dict(zip(names, np.split(vector, cuts), strict=True))


def test_independent_normal_noise_agrees_by_chance_and_has_no_tails() -> None:
    vector = character(photo_with(4.0 * normal()))
    assert vector.shape == (SIZE,)
    found = parts(vector)
    for name in ("agreement", "agreement at half size", "tails", "tails at half size", "coarser"):
        assert np.abs(found[name]).max() < 0.03


def test_neighbors_agree_as_far_as_second_differences_overlap() -> None:
    # 1 -2 1 has 6, -4, 1 as its autocorrelation; signs agree by 2 asin(r) / pi (Sheppard).
    found = parts(character(photo_with(12.0 * normal())))
    for name, share in (("neighbors", -4 / 6), ("diagonal", 16 / 36), ("second", 1 / 6)):
        expected = 2.0 * np.arcsin(share) / np.pi
        assert found[name][MIDDLE] == pytest.approx(expected, abs=0.02)


def test_what_all_channels_share_agrees_in_sign_at_both_sizes() -> None:
    shared = parts(character(photo_with(np.repeat(4.0 * normal(1), 3, axis=2))))
    assert shared["agreement"][MIDDLE] > 0.95
    assert shared["agreement at half size"][MIDDLE] > 0.95
    assert shared["spread"].max() < 0.01


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_agreement_is_that_of_a_bivariate_normal(share: float) -> None:
    # Sheppard's formula: signs of normals with correlation r agree on average by 2 asin(r) / pi.
    noise = np.sqrt(share) * normal(1) + np.sqrt(1.0 - share) * normal(3, seed=1)
    agreement = parts(character(photo_with(12.0 * noise)))["agreement"][MIDDLE]
    assert agreement == pytest.approx(2.0 * np.arcsin(share) / np.pi, abs=0.02)


def test_two_channels_that_agree_alone_show_in_the_spread() -> None:
    noise = 6.0 * normal()
    noise[..., 1] = noise[..., 0]
    assert parts(character(photo_with(noise)))["spread"][0] > 0.05


def test_blur_makes_noise_coarser() -> None:
    blurred = cv2.GaussianBlur(40.0 * normal(), (0, 0), 1.0)
    assert parts(character(photo_with(blurred)))["coarser"][MIDDLE] > 0.5


def test_demosaicing_leaves_coarser_noise_than_a_sensor_with_three_layers() -> None:
    mosaic = np.asarray(np.rint((CODE + 4.0 * normal(1)) * 256.0), dtype=np.uint16)
    full = cv2.demosaicing(mosaic, cv2.COLOR_BayerRGGB2RGB_EA) / 256.0 - CODE
    assert parts(character(photo_with(full)))["coarser"][MIDDLE] > 0.3


def test_rare_large_differences_show_in_the_tails() -> None:
    noise = 2.0 * np.random.default_rng(0).laplace(size=(400, 400, 3)) ** 3
    assert parts(character(photo_with(noise)))["tails"][MIDDLE] > 0.3


def test_levels_that_are_not_seen_say_nothing() -> None:
    vector = parts(character(photo_with(4.0 * normal())))
    for name in ("agreement", "tails", "coarser"):
        assert (np.delete(vector[name], [MIDDLE - 1, MIDDLE, MIDDLE + 1]) == 0.0).all()


@pytest.mark.parametrize("shape", [(1, 1, 3), (2, 9, 3), (5, 4, 3), (3, 3000, 3)])
def test_photos_too_small_to_tell_give_zeros_or_numbers(shape: tuple[int, int, int]) -> None:
    generator = np.random.default_rng(0)
    vector = character(generator.integers(0, 256, shape).astype(np.float32) / 255.0)
    assert vector.shape == (SIZE,)
    assert np.isfinite(vector).all()
