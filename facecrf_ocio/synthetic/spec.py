"""What a synthetic face is asked to be, and all that is known of it once it is rendered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.values import Bool, Float

Color = tuple[float, float, float]
Image = npt.NDArray[np.float32]


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise SettingsError(f"synthetic face: {message}")


def rgb(color: Color) -> Image:
    """(3,) float32, so that products with images stay float32."""
    return np.asarray(color, dtype=np.float32)


@dataclass(frozen=True, slots=True)
class Light:
    """One distant light.

    Attributes
    ----------
    direction
        Toward the light; x right, y up, z toward the camera; any length.
    color
        Linear RGB irradiance of a surface that faces the light, up to the exposure.
    """

    direction: Color = (-0.5, 0.6, 0.9)
    color: Color = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        _require(float(np.linalg.norm(self.direction)) > 0, "a light needs a direction")
        _require(min(self.color) >= 0 < max(self.color), "a light's color must be positive")

    def unit(self) -> Float:
        """(3,) unit vector toward the light."""
        direction = np.asarray(self.direction, dtype=np.float64)
        vector: Float = direction / np.linalg.norm(direction)
        return vector


@dataclass(frozen=True, slots=True)
class SyntheticSpec:
    """One synthetic portrait; the same spec always gives the same pixels.

    Attributes
    ----------
    seed
        Picks the skin's marks, head shape, hair, clothes, background and noise.
    height, width
        [px] Size of the image.
    face_width
        [px] Width of the frontal face.
    yaw, pitch, roll
        [degree] Positive where the nose points to the right of the image, up, and where the head
        tilts clockwise.
    lights
        Distant lights.
    ambient
        Linear RGB irradiance from everywhere.
    skyward
        How much more of the ambient light comes from above: it is multiplied by
        1 + skyward * (vertical component of the normal); [0, 1].
    cast_shadows
        Let the head cast (soft) shadows on itself.
    highlight
        Strength of the skin's highlights: their peak under a light of color 1 in units of
        `exposure`; in nature about 0.15 on fair skin and more on dark.
    full_well
        [electrons] at linear 1.0, sets the photon noise; 0 for none.
    read_noise
        [electrons] standard deviation of the read noise; used only with photon noise.
    exposure
        Median over the bare skin of its brightest channel, before highlights and `gains`.
    gains
        Factors on the linear channels: illuminant color, white balance.
    tone
        From fair (0) over medium (0.5) to dark (1) skin.
    melanin_contrast, hemoglobin_contrast
        Scale of the pigments' variation over the face; 1 is a face with marks, 0 none.
    ideal
        Make the paper's model hold exactly: the first light alone, ambient light of its color, no
        highlights, no cast shadows, no noise.
    """

    seed: int = 0
    height: int = 480
    width: int = 400
    face_width: float = 240.0
    yaw: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0
    lights: tuple[Light, ...] = (Light(),)
    ambient: Color = (0.3, 0.3, 0.3)
    skyward: float = 0.3
    cast_shadows: bool = False
    highlight: float = 0.15
    full_well: float = 20000.0
    read_noise: float = 5.0
    exposure: float = 0.45
    gains: Color = (1.0, 1.0, 1.0)
    tone: float = 0.3
    melanin_contrast: float = 1.0
    hemoglobin_contrast: float = 1.0
    ideal: bool = False

    def __post_init__(self) -> None:
        _require(min(self.height, self.width, self.face_width) > 0, "sizes must be positive")
        _require(len(self.lights) > 0, "a face needs at least one light")
        _require(min(self.gains) > 0, "gains must be positive")
        _require(0 < self.exposure < 1, "exposure must lie between 0 and 1")
        _require(0 <= self.tone <= 1 and 0 <= self.skyward <= 1, "tone, skyward are in [0, 1]")
        scales = (self.melanin_contrast, self.hemoglobin_contrast, self.highlight, *self.ambient)
        _require(min(self.full_well, self.read_noise, *scales) >= 0, "none may be negative")


@dataclass(frozen=True, slots=True, eq=False)
class SyntheticFace:
    """A rendered face and the truth behind it: linear = albedo * shading + specular (+ noise).

    On bare skin log(albedo) = base + melanin * directions[0] + hemoglobin * directions[1].

    Attributes
    ----------
    linear
        (H, W, 3) relative linear light, [0, 1], clipped as a sensor clips.
    albedo, shading, specular
        (H, W, 3) the factors and the highlight of `linear` before noise and clipping, over the
        whole image. Shading holds the lights' colors, the exposure and the gains.
    normals
        (H, W, 3) unit normals, x right, y up, z toward the camera; NaN outside of the face mesh
        and the skull that continues it.
    skin
        (H, W) bare skin of the head, where the equation above holds: without eyes, brows, lips,
        nostrils, ears, neck and outlines.
    melanin, hemoglobin
        (H, W) optical density relative to `base`, in units of `directions`; NaN where
        `normals` are.
    base
        (3,) log RGB of the skin's plain color.
    directions
        (2, 3) unit vectors in log RGB of melanin and hemoglobin; negative, they absorb.
    landmarks_xyz
        (468, 3) vertices of the face mesh in pixels; x right, y down, z away from the camera;
        pixel centers at one half.
    """

    linear: Image
    albedo: Image
    shading: Image
    specular: Image
    normals: Image
    skin: Bool
    melanin: Image
    hemoglobin: Image
    base: Float
    directions: Float
    landmarks_xyz: Float
