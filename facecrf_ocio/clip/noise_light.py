"""What the noise of a clip tells of its curve: the exponent, which exposures that move leave open.

The variance of a sensor's noise is a straight line over light, a (g + b): photons, and what reading
adds. Through the curve, variance of codes is that over the square of the slope of the inverse
response g, so that noise against level gives the slope, and the curve with its exponent (Takamatsu,
Matsushita, Ikeuchi, "Estimating radiometric response functions from image noise variance", ECCV
2008). Neither a nor b is told by anybody, and both are solved for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from facecrf_ocio.clip.frame_noise import NoiseLevels
from facecrf_ocio.color.primaries import LUMINANCE
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.values import Float

_FEWEST = 6  # levels that tell a slope
# An encoder that drops fine structure leaves what its steps say and not what light says: then
# little of the finest is left, or a share that changes with the level. Left are 0.31 to 0.49 in
# JPEGs of quality 90 on three faces, 0.44 to 0.5 in H.264 of 0.17 bits a pixel (where it made one
# clip worse, 1.3 of a frame's error), 0.57 to 0.89 in H.264 of 0.8 bits, 0.55 to 0.60 behind a blur
# of 0.6 pixels, 0.95 and more where nothing was done; the share's logarithm strays by up to 0.21 in
# JPEGs, by 0.14 at most in the others.
_KEPT, _STEADY = 0.55, 0.2
_LEAST = 0.1  # [squared code value] median variance below which rounding to 8 bits decides
_ROUNDING = float((LUMINANCE**2).sum()) / 12.0  # [squared code value] of 8 bits
_WAVE = 30.0  # [code value] over how far what an encoder took is alike


@dataclass(frozen=True, slots=True)
class _Spread:
    """How levels stray about a true curve.

    Attributes
    ----------
    level
        [ln of variance] Each alone.
    lost
        Waves over `_WAVE` code values, in units of the logarithm of what an encoder left of the
        finest structure: it drops more at one brightness than at another.
    """

    level: float
    lost: float


# By 48 clips, each level alone by 0.07 of published curves and by 0.31 of those in which solving
# left waves, which no coefficients follow; waves by 1.6 and 0.8. `_BELIEVED` covers both, as what
# is too wide harms no clip; `_PLAIN` is that of smooth curves.
_BELIEVED, _PLAIN = _Spread(0.4, 3.0), _Spread(0.1, 1.6)
# [standard deviation a coefficient] by which noise, if `_PLAIN`, may contradict the faces: cameras
# that denoise by edges or over time bend it. Of nine such clips one lies below.
_AGREED = 0.6
_TILT = 0.05  # [ln of variance a stop of code values] by which all stray together, along a line
_TERMS = 24.0  # values of a block's transform that count as independent, of 54
_READING = (0.003, 1.5)  # b [light of white] and its standard deviation [ln]: ISO 100 to 6400
_UNKNOWN = 4.0  # [ln] standard deviation of a
_LEAST_ROOT, _LEAST_SLOPE = 0.01, 0.05  # of the root of light, where the model would run away


def add_noise(
    faces: Posterior, levels: NoiseLevels, prior: FamilyPrior, scale: float
) -> Posterior | None:
    """What faces leave of the prior, and then the noise of the frames.

    Parameters
    ----------
    faces
        Coefficients by the faces.
    levels
        As `noise_levels` gives them.
    prior
        Of the curves.
    scale
        Factor on the deviations of posteriors that makes them honest.

    Returns
    -------
    Posterior or None
        None where an encoder or rounding left too little of the noise, or where a camera's
        denoising bent it so that it contradicts the faces.
    """
    if len(levels.variance) < _FEWEST or float(np.median(levels.variance)) < _LEAST:
        return None
    left_over, strays = _share(levels)
    if np.exp(left_over) < _KEPT or strays > _STEADY:
        return None
    known = np.linalg.cholesky(np.linalg.inv(scale**2 * faces.covariance)).T
    plain, _ = _solved(faces, levels, prior, known, _PLAIN)
    if float(np.sqrt(((known @ (plain - faces.mean)) ** 2).mean())) > _AGREED:
        return None
    mean, covariance = _solved(faces, levels, prior, known, _BELIEVED)
    return Posterior(np.ones(1), mean[None], covariance[None] / scale**2)


def _solved(
    faces: Posterior, levels: NoiseLevels, prior: FamilyPrior, known: Float, spread: _Spread
) -> tuple[Float, Float]:
    """Coefficients (M,) by faces, whose root of precision is `known`, and by noise; covariance."""
    size = faces.mean.size
    trusted = np.linalg.cholesky(np.linalg.inv(_strays(levels, spread))).T
    told, read = np.log(levels.variance), np.log(_READING[0])
    start = np.concatenate([faces.mean, [0.0, read]])
    start[size] = float(np.median(told - _expected(start, levels, prior)))

    def left(values: Float) -> Float:
        return np.concatenate(
            [
                trusted @ (told - _expected(values, levels, prior)),
                known @ (values[:size] - faces.mean),
                (values[size:] - start[size:]) / (_UNKNOWN, _READING[1]),
            ]
        )

    found = least_squares(left, start, method="lm")
    return found.x[:size], np.linalg.inv(found.jac.T @ found.jac)[:size, :size]


def _share(levels: NoiseLevels) -> tuple[float, float]:
    """Logarithm of the share of the finest structure that is left, and how that strays."""
    share = np.log(np.maximum(levels.finest, 1e-6))
    # By blocks: levels of few of them stray by chance.
    mean = float(np.average(share, weights=levels.blocks))
    return mean, float(np.average((share - mean) ** 2, weights=levels.blocks)) ** 0.5


def _strays(levels: NoiseLevels, spread: _Spread) -> Float:
    """(B, B) covariance of the logarithms of variances."""
    codes = 255.0 * levels.codes @ LUMINANCE
    stops = np.log2(codes / 100.0)
    each = 2.0 / (_TERMS * levels.blocks) + spread.level**2
    near = np.exp(-0.5 * (np.subtract.outer(codes, codes) / _WAVE) ** 2)
    waves = (spread.lost * _share(levels)[0]) ** 2 * near
    return np.asarray(np.diag(each) + waves + _TILT**2 * np.outer(stops, stops))


def _expected(values: Float, levels: NoiseLevels, prior: FamilyPrior) -> Float:
    """(B,) logarithm of the variance of luminance that coefficients, ln a and ln b give."""
    size = values.size - 2
    roots = prior.roots(values[:size])
    root = np.maximum(np.interp(levels.codes, prior.grid, roots), _LEAST_ROOT)
    slopes = np.gradient(roots, prior.grid)
    slope = np.maximum(np.interp(levels.codes, prior.grid, slopes), _LEAST_SLOPE)
    channels = (root**2 + np.exp(values[-1])) / (2.0 * root * slope) ** 2
    return np.asarray(np.log(np.exp(values[-2]) * (channels @ LUMINANCE**2) + _ROUNDING))
