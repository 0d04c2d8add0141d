"""What the noise of a clip tells of its curve: the exponent, which exposures that move leave open.

The variance of a sensor's noise is a straight line over light, a (g + b): photons, and what reading
adds. Through the curve, variance of codes is that over the square of the slope of the inverse
response g, so that noise against level gives the slope, and the curve with its exponent (Takamatsu,
Matsushita, Ikeuchi, "Estimating radiometric response functions from image noise variance", ECCV
2008). Neither a nor b is told by anybody, and both are solved for.
"""

from __future__ import annotations

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
# [standard deviation a coefficient] by which noise may contradict faces. A camera that denoises by
# edges and over time bends noise against level: 1.0; of 18 clips without, 15 are below 0.6.
_AGREED = 0.6
_LEAST = 0.1  # [squared code value] median variance below which rounding to 8 bits decides
_ROUNDING = float((LUMINANCE**2).sum()) / 12.0  # [squared code value] of 8 bits
# Both by the errors and bands of 20 clips: of 0.05 to 0.2 and 0.02 to 0.1 the widest.
_LEVEL = 0.2  # [ln of variance] by which levels stray: texture that is left, an encoder's steps
_TILT = 0.1  # [ln of variance a stop of code values] by which all stray together
# Variance of each coefficient that is added to what faces leave, in units of the prior's: their
# bands are too narrow for the bends that noise tells better. By the same clips, of 0 to 1.
_FINE = 0.3
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
    share = np.maximum(levels.finest, 1e-6)
    # By blocks: levels of few of them stray by chance.
    mean = float(np.average(np.log(share), weights=levels.blocks))
    strays = float(np.average((np.log(share) - mean) ** 2, weights=levels.blocks)) ** 0.5
    if np.exp(mean) < _KEPT or strays > _STEADY:
        return None
    size = faces.mean.size
    before = scale**2 * faces.covariance + _FINE * np.eye(size)
    known = np.linalg.cholesky(np.linalg.inv(before)).T
    trusted = np.linalg.cholesky(np.linalg.inv(_strays(levels))).T
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
    apart = known @ (found.x[:size] - faces.mean)
    if float(np.sqrt((apart**2).mean())) > _AGREED:
        return None
    covariance = np.linalg.inv(found.jac.T @ found.jac)[:size, :size]
    return Posterior(np.ones(1), found.x[None, :size], covariance[None] / scale**2)


def _strays(levels: NoiseLevels) -> Float:
    """(B, B) covariance of the logarithms of variances."""
    stops = np.log2(255.0 * levels.codes @ LUMINANCE / 100.0)
    each = 2.0 / (_TERMS * levels.blocks) + _LEVEL**2
    return np.asarray(np.diag(each) + _TILT**2 * np.outer(stops, stops))


def _expected(values: Float, levels: NoiseLevels, prior: FamilyPrior) -> Float:
    """(B,) logarithm of the variance of luminance that coefficients, ln a and ln b give."""
    size = values.size - 2
    roots = prior.roots(values[:size])
    root = np.maximum(np.interp(levels.codes, prior.grid, roots), _LEAST_ROOT)
    slopes = np.gradient(roots, prior.grid)
    slope = np.maximum(np.interp(levels.codes, prior.grid, slopes), _LEAST_SLOPE)
    channels = (root**2 + np.exp(values[-1])) / (2.0 * root * slope) ** 2
    return np.asarray(np.log(np.exp(values[-2]) * (channels @ LUMINANCE**2) + _ROUNDING))
