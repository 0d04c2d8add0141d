"""The rival ISCRF: probabilistic intensity similarity, that is, noise in uniform regions.

J. Takamatsu, Y. Matsushita, K. Ikeuchi, "Estimating Camera Response Functions using Probabilistic
Intensity Similarity", CVPR 2008. Two observations of one irradiance differ by noise alone, and
their similarity is the probability of that under a physical noise model: Gaussian in linear
light, variance affine in the irradiance (photons and read-out). The curve is the one under which
all pairs are most similar.

Kept from the paper: the noise model with two unknown parameters per channel; observations of one
irradiance as the only evidence; a maximum of their likelihood. What differs, and why:

- The paper's observations of one irradiance are several photos of a static scene. From one photo
  (as in the comparison of Li et al.) they are the pixels of uniform regions: square blocks in
  which no channel has structure beyond white noise.
- The paper maximizes over all pairs. Under its model the likelihood depends on the curve through
  the noise's variance and asymmetry at each brightness (`energy.noise_symmetry`), so these two are
  measured at each level and fitted: the same maximum to the order of the noise, from hundreds
  of numbers in place of millions of pairs.
- Variance alone cannot tell read noise from the curve (see `energy.noise_symmetry`). Where the
  noise is too small to show its asymmetry, the response model and a wide prior on read noise
  decide.
- Rounding to integer codes adds variance; its expected share is taken off, and levels whose noise
  drowns in it are not used.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.published.answer import Answer, FittedCurve
from facecrf_ocio.published.energy.log_slope import curve_of, log_slope_prior
from facecrf_ocio.published.energy.noise_symmetry import RegionNoise, fit_noise
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import CHANNELS, Float, Lacking, Photo

BLOCK = 8  # [px] side of a block: 64 pixels measure a variance within 18 %
MAX_BLOCKS = 65_536  # of a photo; more cost memory in proportion
# Variance of the four quadrant means over that of white noise: F(3, 60) exceeds it in 0.4 %.
MAX_STRUCTURE = 5.0
# Variance from differences of neighbors over that of the block (von Neumann's ratio): 1 for white
# noise, 0.33 where an edge runs along the block's border.
MIN_WHITENESS = 0.45
# Largest variance of a block over the median of its level.
MAX_VARIANCE = 1.75

LEVELS = 128  # of brightness: one is two 8-bit codes
MIN_BLOCKS = 4  # of a level, for a median and a variance
# Blocks whose mean lies within so many standard deviations of black or white are cut off there.
CLIPPING_MARGIN = 3.5
# Share of blocks with clipped pixels beyond which a level is cut off nonetheless.
MAX_CLIPPED = 0.01
# [codes] Below this standard deviation, rounding hides the noise.
MIN_NOISE = 0.3
MIN_LEVELS = 32  # a quarter of `LEVELS`, or the prior would draw the curve
MIN_RANGE = 0.3  # [encoded] from the darkest to the brightest level
SUMMARY_SIZE = 256  # quantiles by which an answer tells where its evidence lies


def intensity_similarity_answer(
    photo: Photo, model: ResponseModel, settings: PublishedSettings
) -> Answer:
    """Measure the noise of uniform blocks at each level, and fit the curve that explains it."""
    step = 0.0 if photo.bit_depth is None else 1.0 / (2**photo.bit_depth - 1)
    blocks = uniform_blocks(photo.encoded)
    channels = [noise_levels(blocks[:, :, c], step) for c in range(len(CHANNELS))]
    lacking = _lacking(channels, len(blocks))
    if lacking is not None:
        return lacking
    prior = log_slope_prior(model)
    together = [channels] if settings.shared_curve else [[levels] for levels in channels]
    curves = [curve_of(fit_noise(levels, prior).log_slopes, model.grid) for levels in together]
    quantiles = np.linspace(0.0, 1.0, SUMMARY_SIZE)
    pixels = min(int(levels.pixels.sum()) for levels in channels)
    return FittedCurve(
        np.array(curves if len(curves) > 1 else curves * len(CHANNELS)),
        np.array([np.quantile(levels.encoded, quantiles) for levels in channels]).T,
        f"noise of {pixels} pixels per channel in uniform regions "
        f"at {min(levels.encoded.size for levels in channels)} brightness levels",
    )


def uniform_blocks(encoded: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Square blocks without structure in any channel.

    Parameters
    ----------
    encoded
        (H, W, 3).

    Returns
    -------
    numpy.ndarray
        (N, BLOCK * BLOCK, 3).
    """
    rows, columns = (size // BLOCK for size in encoded.shape[:2])
    every = max(1, int(np.ceil(np.sqrt(rows * columns / MAX_BLOCKS))))
    grid = encoded[: rows * BLOCK, : columns * BLOCK]
    blocks = grid.reshape(rows, BLOCK, columns, BLOCK, 3)[::every, :, ::every]
    blocks = blocks.transpose(0, 2, 1, 3, 4).reshape(-1, BLOCK, BLOCK, 3)
    half = BLOCK // 2
    quadrants = blocks.reshape(-1, 2, half, 2, half, 3).mean(axis=(2, 4), dtype=np.float64)
    between = quadrants.reshape(-1, 4, 3).var(axis=1, ddof=1) * half**2
    within = blocks.var(axis=(1, 2), ddof=1, dtype=np.float64)
    steps = [np.diff(blocks, axis=axis).astype(np.float64) for axis in (1, 2)]
    nearby = ((steps[0] ** 2).mean(axis=(1, 2)) + (steps[1] ** 2).mean(axis=(1, 2))) / 4.0
    uniform = (between <= MAX_STRUCTURE * within) & (nearby >= MIN_WHITENESS * within)
    found = blocks[uniform.all(axis=1)].reshape(-1, BLOCK * BLOCK, 3)
    return np.asarray(found, dtype=np.float32)


def noise_levels(blocks: Float, step: float) -> RegionNoise:
    """Variance and skewness of one channel of uniform blocks, by level.

    Parameters
    ----------
    blocks
        (N, P) encoded values.
    step
        Difference between neighboring codes; 0 where they are not rounded.
    """
    size = blocks.shape[1]
    mean = blocks.mean(axis=1, dtype=np.float64)
    offsets = blocks - mean[:, None]
    squares = (offsets**2).sum(axis=1) / (size - 1)
    cubes = (offsets**3).sum(axis=1) * size / ((size - 1) * (size - 2))
    clipped = np.asarray(((blocks <= 0.0) | (blocks >= 1.0)).any(axis=1))
    level = np.minimum((mean * LEVELS).astype(np.intp), LEVELS - 1)
    found = []
    for number in range(LEVELS):
        here = level == number
        if here.sum() < MIN_BLOCKS:
            continue
        margin = CLIPPING_MARGIN * np.sqrt(np.median(squares[here]))
        here &= (mean > margin) & (mean < 1.0 - margin)
        if here.sum() < MIN_BLOCKS:
            continue
        # A block of pure noise exceeds this in one of ten thousand; texture hides above it.
        here &= squares <= MAX_VARIANCE * np.median(squares[here])
        if clipped[here].mean() > MAX_CLIPPED:
            continue
        here &= ~clipped
        total = float(squares[here].mean())
        variance = without_rounding(total, step)
        if variance > (MIN_NOISE * step) ** 2:
            skewness = float(cubes[here].mean()) / variance**1.5
            pixels = float(here.sum() * size)
            found.append((mean[here].mean(), variance, skewness, pixels, total / variance))
    return RegionNoise(*np.array(found, dtype=np.float64).reshape(-1, 5).T)


def without_rounding(variance: float, step: float) -> float:
    """Variance of Gaussian noise that measures `variance` after rounding to multiples of `step`.

    With v in squared steps, averaged over where the mean lies between two codes,
    `measured(v) = v + 1/12 - sum_k exp(-(2 pi k)^2 v) / (2 pi^2 k^2)`: 0 for v = 0, and Sheppard's
    v + 1/12 from v = 0.2 on.
    """
    if step == 0.0:
        return variance
    noise = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 2000)])
    k = np.arange(1, 200)[:, None]
    series = (np.exp(-((2.0 * np.pi * k) ** 2) * noise) / (2.0 * np.pi**2 * k**2)).sum(axis=0)
    measured = noise + 1.0 / 12.0 - series
    in_steps = variance / step**2
    if in_steps > measured[-1]:
        return variance - step**2 / 12.0
    return float(np.interp(in_steps, measured, noise)) * step**2


def _lacking(channels: list[RegionNoise], blocks: int) -> Lacking | None:
    fewest = min(levels.encoded.size for levels in channels)
    if fewest < MIN_LEVELS:
        return Lacking(
            f"{blocks} uniform blocks show noise at {fewest} brightness levels "
            f"({MIN_LEVELS} are needed)",
            "use a photo with plain surfaces and visible noise, not denoised",
        )
    width = min(float(np.ptp(levels.encoded)) for levels in channels)
    if width < MIN_RANGE:
        return Lacking(
            f"the uniform regions span {width:.0%} of the code range ({MIN_RANGE:.0%} are needed)",
            "use a photo with plain surfaces from dark to light",
        )
    return None
