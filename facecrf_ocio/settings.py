"""What a calibration can be told: each holder has what its part of the package reads alone."""

from __future__ import annotations

from dataclasses import dataclass, fields
from numbers import Integral, Real

from facecrf_ocio.errors import SettingsError

PRIORS = ("auto", "dorf", "modern")
_KINDS = {"bool": bool, "int": Integral, "float": Real}  # those of NumPy as well
_SHARES = (
    *("value_low", "value_high", "min_face_score"),
    *("most_flat", "gradient_low", "gradient_high"),
)
VERDICTS = ("prior only", "weak", "reliable")


@dataclass(frozen=True)
class FaceSettings:
    """What every estimator is told: how to look at a face, and how many curves to find.

    Attributes
    ----------
    shared_curve
        One curve for all three channels instead of one for each. `joint` gives one in any case, but
        of cameras whose channels the user has measured.
    detection_long_side
        [px] Faces are sought on a copy of the photo no longer than this.
    min_face_width
        [px] Smaller faces are ignored: their normals and pigment gradients are noise.
    min_face_score
        Detector score from which a face is believed, [0, 1].
    face_width
        [px] Each face is scaled down to this width before its skin is analyzed.
    hue_half_width
        [degree] Skin hues lie within this distance of the most frequent hue (Li, Lin, Zhou,
        Ikeuchi, CVPR 2017, sec. 5.1).
    value_low, value_high
        Quantiles of V in HSV outside of which skin pixels are ignored (the same, sec. 5.1).
    """

    shared_curve: bool = False
    detection_long_side: int = 1280
    min_face_width: int = 60
    min_face_score: float = 0.7
    face_width: int = 160
    hue_half_width: float = 18.0
    value_low: float = 0.25
    value_high: float = 0.75

    def __post_init__(self) -> None:
        for item in fields(self):
            name, value = item.name, getattr(self, item.name)
            _require(isinstance(value, _KINDS[str(item.type)]), f"{name} must be {item.type}")
            _require(name not in _SHARES or 0.0 <= value <= 1.0, f"{name} must lie in [0, 1]")
            _require(value >= 0, f"{name} must not be negative")
        _require(self.value_low < self.value_high, "value_low must be below value_high")


@dataclass(frozen=True)
class JointSettings(FaceSettings):
    """What `joint` can be told besides: which pictures no single curve of a camera explains.

    What it has learned is in its model (`JointModel`): the networks, the prior, the band's scale.

    Attributes
    ----------
    least_chroma
        Of `single_curve.chroma_share`, below which all color is a tone laid over gray. Of 216 real
        photos (three scenes) made gray and toned (sepia, selenium, cyanotype) 214 are below at JPEG
        85, weak tones 56 of 72; of the photos themselves 2 of 54, portraits in gray studio light.
    sure_chroma
        Above which color is no such tone; between the two an estimate is never reliable. Of all
        tones at JPEG 75 two of 288 are above. Ordinary photos have 0.1 and more, portraits in gray
        studio light 0.0005 to 0.08.
    fewest_colors
        Distinct colors of a picture below which it was made with a palette, which has 256 at most.
    most_flat
        Share of a face's pixels that equal their neighbors, above which it was drawn.
    sure_roughness
        Of `few_levels.roughness`, up to which brightness has all its levels; above it, an estimate
        is never reliable. Four of 549 ordinary photos are above.
    most_roughness
        Above which a face is refused, as most posters and palettes of up to 16 levels are; the
        farthest of those photos has 0.24.
    most_scatter
        [stop] By which a gain map may stray from one curve of brightness; above, places were tone
        mapped unlike each other. A Pixel phone's HDR+ has 0.15; Adobe's maps from single curves
        0.001 and 0.05, one by libultrahdr 0.04.
    """

    least_chroma: float = 0.001
    sure_chroma: float = 0.01
    fewest_colors: int = 300
    most_flat: float = 0.6
    sure_roughness: float = 0.18
    most_roughness: float = 0.35
    most_scatter: float = 0.1


@dataclass(frozen=True)
class PublishedSettings(FaceSettings):
    """What the published estimators can be told; "eq." refers to Li, Lin, Zhou, Ikeuchi (2017).

    `monotonicity_weight` is for `face`, `face-unshaded` and `edge`, the others for the first two
    alone. What the other rivals use stands at the top of their files: with other numbers they would
    be other methods than those that were measured.

    Attributes
    ----------
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
        super().__post_init__()
        _require(self.gradient_low < self.gradient_high, "gradient_low must be below gradient_high")


@dataclass(frozen=True)
class Settings(PublishedSettings, JointSettings):
    """All that `calibrate` can be told, whichever the estimator.

    See `FaceSettings` for how all look at a face, `JointSettings` and `PublishedSettings` for the
    rest; those of another estimator are without effect.
    """


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise SettingsError(message)
