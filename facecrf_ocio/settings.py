"""What a calibration can be told: how faces are looked at, and the published method's weights."""

from __future__ import annotations

from dataclasses import dataclass, fields

from facecrf_ocio.errors import SettingsError

PRIORS = ("auto", "dorf", "modern")
VERDICTS = ("prior only", "weak", "reliable")


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of one calibration; "sec." and "eq." refer to Li, Lin, Zhou, Ikeuchi, CVPR 2017.

    Those up to `value_high` say how every estimator looks at a face, `joint` too. `shared_curve`
    is for the published estimators, `monotonicity_weight` for `face`, `face-unshaded` and `edge`,
    the others for the first two alone. What `joint` has learned is in its model, and what the other
    rivals use stands at the top of their files: with other numbers they would be other methods
    than those that were measured.

    Attributes
    ----------
    shared_curve
        Estimate one curve for all three channels instead of one for each.
    detection_long_side
        [px] Faces are sought on a copy of the photo no longer than this.
    min_face_width
        [px] Smaller faces are ignored: their normals and pigment gradients are noise.
    min_face_score
        Detector score from which a face is believed, [0, 1].
    face_width
        [px] Each face is scaled down to this width before its skin is analyzed.
    hue_half_width
        [degree] Skin hues lie within this distance of the most frequent hue (sec. 5.1).
    value_low, value_high
        Quantiles of V in HSV outside of which skin pixels are ignored (sec. 5.1).
    chromaticity_threshold
        Neighbors closer than this in chromaticity (r, g) have equal albedo (eq. 27, tau_a).
    normal_threshold
        [degree] Neighbors closer than this in normal direction have equal shading (tau_d).
    albedo_weight, shading_weight, nonlocal_weight
        Weights of the three terms of eq. 27 (w_a, w_d, and w_d on pairs of equal normals).
    gradient_low, gradient_high
        Quantiles of the density gradients that select single-pigment pairs (eq. 25).
    first_order
        Use the forward differences of eq. 12-15 as printed instead of exact log ratios.
    balance_channels
        Scale the three rows of the pigment matrices alike before their singular values are taken.
        Not in the paper, and without effect on exact data; `energy.pigment` says why it is done.
    pigment_weight, monotonicity_weight
        lambda_p and lambda_m of eq. 22.
    min_pairs
        A pigment with fewer pairs than this gives no evidence.
    """

    shared_curve: bool = False
    detection_long_side: int = 1280
    min_face_width: int = 60
    min_face_score: float = 0.7
    face_width: int = 160
    hue_half_width: float = 18.0
    value_low: float = 0.25
    value_high: float = 0.75
    chromaticity_threshold: float = 0.02
    normal_threshold: float = 5.0
    albedo_weight: float = 1.0
    shading_weight: float = 0.05
    nonlocal_weight: float = 1.0
    gradient_low: float = 0.10
    gradient_high: float = 0.95
    first_order: bool = False
    balance_channels: bool = True
    pigment_weight: float = 30000.0
    monotonicity_weight: float = 1000.0
    min_pairs: int = 8

    def __post_init__(self) -> None:
        for name in ("value_low", "value_high", "gradient_low", "gradient_high", "min_face_score"):
            _require(0.0 <= getattr(self, name) <= 1.0, f"{name} must lie in [0, 1]")
        _require(self.value_low < self.value_high, "value_low must be below value_high")
        _require(self.gradient_low < self.gradient_high, "gradient_low must be below gradient_high")
        for item in fields(self):
            value = getattr(self, item.name)
            _require(isinstance(value, bool) or value >= 0, f"{item.name} must not be negative")


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise SettingsError(message)
