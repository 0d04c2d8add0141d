"""START HERE: from a spec to a face with the truth of every intermediate step."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.synthetic.head import Material, Mesh
from facecrf_ocio.synthetic.light import cast_shadow, reflect, shade
from facecrf_ocio.synthetic.paint import HAIR_COLORS, FeaturePaint, paint_features
from facecrf_ocio.synthetic.scene import FACE_VERTICES, SeenSurface, pose_head, see, to_pixels
from facecrf_ocio.synthetic.scenery import background, cloth_albedo, hair_albedo
from facecrf_ocio.synthetic.skin_layers import (
    DIRECTIONS,
    PigmentMaps,
    base_color,
    paint_pigments,
    smooth_noise,
    to_texture,
)
from facecrf_ocio.synthetic.spec import Color, Image, SyntheticFace, SyntheticSpec, rgb
from facecrf_ocio.values import Bool, Float

LIP_MELANIN, LIP_HEMOGLOBIN = 0.05, 0.60  # density of the pigments that lips add to skin


def render_face(spec: SyntheticSpec) -> SyntheticFace:
    """Render a portrait: pose, pigments, paint, light, sensor.

    Returns
    -------
    SyntheticFace
        Linear light as the sensor records it, and the truth behind it.

    Raises
    ------
    SettingsError
        If no skin is in view.
    """
    if spec.ideal:
        spec = _idealize(spec)
    shape_rng, skin_rng, paint_rng, scenery_rng, gloss_rng, noise_rng = np.random.default_rng(
        spec.seed
    ).spawn(6)
    mesh = pose_head(spec, shape_rng)
    surface = see(mesh, spec)
    base = base_color(spec.tone)
    hair = HAIR_COLORS[int(paint_rng.integers(1 + int(2.5 * (1 - spec.tone))))]
    maps = paint_pigments(skin_rng, spec.melanin_contrast, spec.hemoglobin_contrast)
    paint = paint_features(paint_rng, mesh.uv[:FACE_VERTICES], hair)

    on_head = np.isin(surface.material, (Material.FACE, Material.SKULL))
    melanin, hemoglobin, skin = _pigments_in_view(surface, maps, paint)
    if not skin.any():
        raise SettingsError("synthetic face: no skin in view; make the face or the image larger")
    albedo = _albedo(surface, base, melanin, hemoglobin, paint)
    _add_scenery(albedo, surface, scenery_rng, hair, base)
    shading, specular = _illuminate(spec, mesh, surface, gloss_rng)

    shading *= np.float32(spec.exposure / np.median((albedo * shading)[skin], axis=0).max())
    shading[surface.material == Material.BACKGROUND] = 1.0
    _soften_outlines(_outlines(surface), albedo, shading, specular)
    shading *= rgb(spec.gains)
    specular *= rgb(spec.gains)
    return SyntheticFace(
        linear=_expose(albedo * shading + specular, spec, noise_rng),
        albedo=albedo,
        shading=shading,
        specular=specular,
        normals=np.where(on_head[..., None], surface.normals, np.float32(np.nan)),
        skin=skin,
        melanin=np.where(on_head, melanin, np.float32(np.nan)),
        hemoglobin=np.where(on_head, hemoglobin, np.float32(np.nan)),
        base=base,
        directions=DIRECTIONS,
        landmarks_xyz=to_pixels(mesh.vertices[:FACE_VERTICES], spec),
    )


def _idealize(spec: SyntheticSpec) -> SyntheticSpec:
    """The spec under which the paper's model holds exactly: shading is one scalar per pixel."""
    light = spec.lights[0]
    strength = float(np.mean(spec.ambient))
    red, green, blue = (strength * value for value in light.color)
    return replace(
        spec,
        lights=(light,),
        ambient=(red, green, blue),
        cast_shadows=False,
        highlight=0.0,
        full_well=0.0,
    )


def _dimming(base: Float) -> float:
    """Factor on all that is not skin: exposing for dark skin would burn it out otherwise."""
    return float(min(1.0, (np.exp(base).mean() / 0.4) ** 0.7))


def _sample(texture: Image, surface: SeenSurface) -> Image:
    """Look a (T, T[, C]) texture up at every pixel, bilinearly; 0 in the background."""
    position = np.nan_to_num(to_texture(surface.uv), nan=-10.0).astype(np.float32)
    x, y = position[..., 0], position[..., 1]
    return np.asarray(cv2.remap(texture, x, y, cv2.INTER_LINEAR, borderValue=0), np.float32)


def _pigments_in_view(
    surface: SeenSurface, maps: PigmentMaps, paint: FeaturePaint
) -> tuple[Image, Image, Bool]:
    """Densities at every pixel, with redder lips, and where bare skin shows."""
    on_face = surface.material == Material.FACE
    lips = _sample(paint.lips, surface) * on_face
    hidden = on_face & ((_sample(paint.cover, surface) > 0) | (lips > 0.05))
    melanin = _sample(maps.melanin, surface) + np.float32(LIP_MELANIN) * lips
    hemoglobin = _sample(maps.hemoglobin, surface) + np.float32(LIP_HEMOGLOBIN) * lips
    on_head = on_face | (surface.material == Material.SKULL)
    return melanin, hemoglobin, on_head & ~hidden & ~_outlines(surface)


def _albedo(
    surface: SeenSurface, base: Float, melanin: Image, hemoglobin: Image, paint: FeaturePaint
) -> Image:
    """(H, W, 3) Beer-Lambert skin under the paint."""
    densities = np.stack([melanin, hemoglobin], axis=-1)
    skin: Image = np.exp(densities @ DIRECTIONS.astype(np.float32) + base.astype(np.float32))
    cover = _sample(paint.cover, surface)[..., None]
    dimmed = np.float32(_dimming(base)) * _sample(paint.color, surface)
    painted: Image = skin * (1 - cover) + dimmed
    return np.where((surface.material == Material.FACE)[..., None], painted, skin)


def _add_scenery(
    albedo: Image, surface: SeenSurface, rng: np.random.Generator, hair: Color, base: Float
) -> None:
    hair_rng, cloth_rng, wall_rng = rng.spawn(3)
    on_hair, on_cloth = surface.material == Material.HAIR, surface.material == Material.CLOTH
    dimming = _dimming(base)
    red, green, blue = (dimming * value for value in hair)
    albedo[on_hair] = hair_albedo(hair_rng, surface.uv[on_hair], (red, green, blue), np.exp(base))
    albedo[on_cloth] = dimming * cloth_albedo(cloth_rng, int(on_cloth.sum()))
    behind = surface.material == Material.BACKGROUND
    albedo[behind] = background(wall_rng, *behind.shape)[behind]


def _illuminate(
    spec: SyntheticSpec, mesh: Mesh, surface: SeenSurface, rng: np.random.Generator
) -> tuple[Image, Image]:
    """Shading up to a factor, and highlights; (H, W, 3) each."""
    normals = np.nan_to_num(surface.normals)
    everywhere = np.ones(normals.shape[:2], dtype=np.float32)
    visible = [everywhere for _ in spec.lights]
    if spec.cast_shadows:
        positions = np.nan_to_num(surface.positions)
        # The cap of hair ends in a hard edge, which would draw a line on the forehead.
        solid = mesh.triangles[mesh.material != Material.HAIR]
        visible = [
            cast_shadow(light, mesh.vertices, solid, positions, normals) for light in spec.lights
        ]
    shading = shade(normals, spec.lights, visible, spec.ambient, spec.skyward)
    if spec.highlight == 0:
        return shading, np.zeros_like(shading)
    gloss = np.clip(0.75 + smooth_noise(rng, (30, 80, 200), 0.25), 0, 1)
    glossy = np.isin(surface.material, (Material.FACE, Material.SKULL, Material.OTHER_SKIN))
    specular = reflect(normals, spec.lights, visible, spec.highlight * spec.exposure)
    specular *= (_sample(gloss, surface) * glossy)[..., None]
    return shading, specular


def _outlines(surface: SeenSurface) -> Bool:
    """(H, W) pixels beside a change of material; face and skull are one."""
    material = np.where(surface.material == Material.SKULL, Material.FACE, surface.material)
    material = material.astype(np.uint8)
    kernel = np.ones((3, 3), dtype=np.uint8)
    changes: Bool = cv2.dilate(material, kernel) != cv2.erode(material, kernel)
    return changes


def _soften_outlines(outlines: Bool, albedo: Image, shading: Image, specular: Image) -> None:
    """Blend light across outlines, as a lens does; there the blend counts as albedo."""
    light = cv2.GaussianBlur(albedo * shading + specular, (3, 3), 0.7)
    albedo[outlines], shading[outlines], specular[outlines] = light[outlines], 1.0, 0.0


def _expose(light: Image, spec: SyntheticSpec, rng: np.random.Generator) -> Image:
    """Photon and read noise, then saturation."""
    if spec.full_well > 0:
        electrons = rng.poisson(np.clip(light, 0, None) * spec.full_well)
        read = rng.normal(0, spec.read_noise, light.shape)
        light = np.asarray((electrons + read) / spec.full_well, dtype=np.float32)
    return np.clip(light, 0, 1)
