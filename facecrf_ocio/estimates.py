"""The values that come out: curves, how far to trust them, and what came of a calibration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
import numpy.typing as npt

from facecrf_ocio.checks import Float, frozen, read_only, unit_floats
from facecrf_ocio.errors import NotCalibratedError, SettingsError
from facecrf_ocio.notebook.displayed import Displayed

CHANNELS = ("R", "G", "B")

# Share of the possible curves that the estimate is nearer to than sRGB, from which it differs.
DIFFERS_SHARE = 0.95


class Outcome(str, Enum):
    """What came of a calibration; `from its camera`: without evidence, but others' curve fits."""

    CALIBRATED = "calibrated"
    FROM_CAMERA = "from its camera"
    ALREADY_LINEAR = "already linear"
    NAMED = "named by the file"
    FALLBACK = "fallback"
    NOT_CALIBRATED = "not calibrated"

    def __str__(self) -> str:
        return self.value


class Verdict(str, Enum):
    """How far a curve may be trusted."""

    RELIABLE = "reliable"
    WEAK = "weak"
    PRIOR_ONLY = "prior only"

    def __str__(self) -> str:
        return self.value


@dataclass(frozen=True, slots=True, eq=False)
class InverseCRF:
    """Inverse camera response: from code value to linear light, one curve per channel (eq. 8).

    Attributes
    ----------
    encoded
        (K,) code values, strictly increasing from 0 to 1.
    linear
        (3, K) relative linear light, strictly increasing from 0 to 1. Between samples the curve
        is linear, as every LUT reader will have it.
    """

    encoded: Float
    linear: Float

    def __post_init__(self) -> None:
        encoded = frozen(self.encoded)
        linear = frozen(self.linear)
        if encoded.ndim != 1 or encoded.size < 2 or linear.shape != (3, encoded.size):
            raise SettingsError(
                f"an inverse CRF needs encoded (K,) and linear (3, K), not {encoded.shape} "
                f"and {linear.shape}"
            )
        if not (np.isfinite(encoded).all() and np.isfinite(linear).all()):
            raise SettingsError("an inverse CRF must be finite")
        ends = (encoded[0], encoded[-1], *linear[:, 0], *linear[:, -1])
        if ends != (0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0):
            raise SettingsError("an inverse CRF must run from (0, 0) to (1, 1) in every channel")
        if (np.diff(encoded) <= 0).any() or (np.diff(linear, axis=1) <= 0).any():
            raise SettingsError("an inverse CRF must increase strictly")
        object.__setattr__(self, "encoded", encoded)
        object.__setattr__(self, "linear", linear)

    def linearize(self, encoded: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """Map code values to linear light.

        Parameters
        ----------
        encoded
            (..., 3) code values: floats in [0, 1], those outside are clamped, as OCIO does; or
            8-bit or 16-bit integers, which are divided by 255 or 65535.

        Returns
        -------
        numpy.ndarray
            (..., 3) float32, relative linear light in [0, 1].

        Raises
        ------
        SettingsError
            If they are other integers, or floats that nobody divided by the maximum code.
        """
        values = unit_floats(encoded)
        return self._map(values, tuple((self.encoded, curve) for curve in self.linear))

    def __repr__(self) -> str:
        middle = ", ".join(f"{value:.3f}" for value in self.linearize([[0.5] * 3])[0])
        return f"<InverseCRF of {self.encoded.size} samples, 0.5 -> {middle}>"

    def encode(self, linear: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """Map linear light to code values: the exact inverse of `linearize`."""
        return self._map(linear, tuple((curve, self.encoded) for curve in self.linear))

    @staticmethod
    def _map(
        values: npt.ArrayLike, tables: tuple[tuple[Float, Float], ...]
    ) -> npt.NDArray[np.float32]:
        given = np.asarray(values)
        if given.shape[-1:] != (3,) or given.dtype.kind not in "biuf":
            raise SettingsError(f"expected (..., 3) values, not {given.shape} of {given.dtype}")
        result = np.empty(given.shape, np.float32)
        for channel, (x, y) in enumerate(tables):
            result[..., channel] = np.interp(given[..., channel], x, y)
        return result


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """One detected face.

    Attributes
    ----------
    box_xy
        (4,) x, y, width, height in pixels of the upright photo.
    landmarks_xyz
        (478, 3) pixels of the upright photo, which spans x from 0 to its width (pixel centers lie
        at 0.5, 1.5, ...); x right, y down, z away from the camera, in the same unit as x.
    score
        Detector score in [0, 1].
    """

    box_xy: Float
    landmarks_xyz: Float
    score: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "box_xy", frozen(self.box_xy))
        object.__setattr__(self, "landmarks_xyz", frozen(self.landmarks_xyz))


@dataclass(frozen=True, slots=True)
class Lacking:
    """Why the photo tells an estimator nothing, and what the user can do; one sentence each."""

    reason: str
    remedy: str


@dataclass(frozen=True, slots=True, eq=False)
class InStops:
    """How far a curve may be trusted, in stops, once the one free factor is out (code 128).

    Attributes
    ----------
    sigma
        (3, 256) standard deviation of log2 of linear light over that at mid-gray, at each 8-bit
        code.
    mid, shadows
        Expected mean error over codes 64 to 235, and 16 to 64, as `response.stops` measures it.
    """

    sigma: Float
    mid: float
    shadows: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma", frozen(self.sigma))


@dataclass(frozen=True, slots=True, eq=False)
class Confidence:
    """How far an estimate may be trusted.

    Attributes
    ----------
    sigma
        (3, K) standard deviation of `linear` at each code of the curve.
    coverage
        (3, K) share of the photo's evidence at or near each code, [0, 1].
    verdict
        In one word; of accuracy alone.
    reasons
        What else there is to say of it, in sentences.
    in_stops
        The band and the expected error in stops; None where they are not known (records of older
        versions).
    nearer_than_srgb
        Share of the curves that the photo leaves possible to which the estimate is nearer than sRGB
        decoding, in stops over codes 64 to 235; None where that was not asked.
    outvoted
        Cues, or photos, that contradict the other evidence and count less.
    doubts
        What speaks against the curve whatever its band says; told wherever the verdict is.
    """

    sigma: Float
    coverage: Float
    verdict: Verdict
    reasons: tuple[str, ...]
    in_stops: InStops | None = None
    nearer_than_srgb: float | None = None
    outvoted: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    def __repr__(self) -> str:
        stops = "" if self.in_stops is None else f", {self.in_stops.mid:.2f} stops"
        return f"<Confidence: {self.verdict}{stops}>"

    @property
    def differs_from_srgb(self) -> bool | None:
        """Whether the curve is surely another than sRGB's; None where that was not asked."""
        share = self.nearer_than_srgb
        return None if share is None else share >= DIFFERS_SHARE

    def __post_init__(self) -> None:
        for name in ("sigma", "coverage"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


@dataclass(frozen=True, slots=True, eq=False)
class Estimate(Displayed):
    """What a calibration found, or why it found nothing.

    Attributes
    ----------
    outcome
        Whether there is a curve and what it rests on.
    estimator
        Name of the estimator that made it.
    reason
        One sentence on the outcome.
    remedy
        What the user can do, empty if nothing needs doing.
    confidence
        None where there is no curve.
    coefficients
        (3, M) coefficients of the response model (eq. 9), None where none were fitted.
    energy
        Value of each energy term at the solution, weighted as minimized (eq. 22).
    faces
        The faces used.
    found
        The curve, or None; `curve` is the same and raises instead of returning None.
    assumptions
        What had to be taken for granted, in sentences.
    """

    outcome: Outcome
    estimator: str
    reason: str
    remedy: str = ""
    found: InverseCRF | None = None
    confidence: Confidence | None = None
    coefficients: Float | None = None
    energy: Mapping[str, float] = field(default_factory=dict)
    faces: tuple[Face, ...] = ()
    assumptions: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "energy", read_only(self.energy))
        if self.coefficients is not None:
            object.__setattr__(self, "coefficients", frozen(self.coefficients))

    def __repr__(self) -> str:
        told = self.confidence
        if told is None:
            return f"<Estimate by {self.estimator}: {self.outcome}: {self.reason}>"
        stops = "" if told.in_stops is None else f", {told.in_stops.mid:.2f} stops"
        return f"<Estimate by {self.estimator}: {self.outcome} ({told.verdict}{stops})>"

    @property
    def curve(self) -> InverseCRF:
        """The inverse CRF.

        Raises
        ------
        NotCalibratedError
            If the photo could not be calibrated; the text says why and what to do.
        """
        if self.found is None:
            remedy = ", or ".join(filter(None, (self.remedy, 'calibrate(..., fallback="mean")')))
            raise NotCalibratedError(f"no curve: {self.reason}; {remedy}")
        return self.found
