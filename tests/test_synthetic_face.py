"""The synthetic face keeps its promises: its truth is the truth of its pixels."""

from __future__ import annotations

from dataclasses import replace
from importlib import resources

import cv2
import numpy as np
import pytest

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.face.rasterize import rasterize
from facecrf_ocio.synthetic import (
    Light,
    SyntheticSpec,
    encode,
    gamma_curve,
    photograph,
    render_face,
)
from facecrf_ocio.synthetic.head import bust, face_head, hair_and_ears

IDEAL = SyntheticSpec(seed=11, ideal=True, lights=(Light((0.4, 0.5, 1.0), (1.0, 0.8, 0.6)),))
SMALL = replace(IDEAL, height=240, width=200, face_width=120.0)
SRGB_LIKE = gamma_curve(2.2)


@pytest.fixture(scope="module")
def ideal():
    return render_face(IDEAL)


@pytest.fixture(scope="module")
def natural():
    return render_face(SyntheticSpec(seed=3))


def without_noise(face):
    return face.albedo * face.shading + face.specular


def test_ideal_skin_obeys_beer_lambert_exactly(ideal):
    densities = np.stack([ideal.melanin, ideal.hemoglobin], axis=-1)[ideal.skin].astype(float)
    expected = ideal.base + densities @ ideal.directions
    seen = np.log(ideal.linear[ideal.skin].astype(float)) - np.log(ideal.shading[ideal.skin])
    assert np.abs(seen - expected).max() < 1e-5


def test_ideal_shading_is_one_scalar_in_the_light_s_color(ideal):
    scalar = ideal.shading[ideal.skin] / IDEAL.lights[0].color
    assert np.allclose(scalar, scalar[:, :1], rtol=1e-5)
    assert not ideal.specular.any()


@pytest.mark.parametrize("yaw", [-30.0, 0.0, 20.0])
def test_shading_is_lambert_of_the_normals(yaw):
    lights = (Light((-1.0, 0.5, 1.0), (1.0, 0.7, 0.4)), Light((1.0, 0.0, 0.5), (0.2, 0.4, 0.8)))
    spec = SyntheticSpec(seed=1, yaw=yaw, lights=lights, skyward=0.5)
    face = render_face(spec)
    normals = face.normals[face.skin]
    expected = (1 + 0.5 * normals[:, 1:2]) * np.array(spec.ambient)
    for light in lights:
        expected = expected + np.maximum(normals @ light.unit(), 0)[:, None] * light.color
    exposure = face.shading[face.skin] / expected
    assert np.allclose(exposure, exposure.mean(), rtol=1e-4)


def test_normals_are_unit_and_stand_on_the_surface_of_the_landmarks(ideal):
    """Where the mesh of the landmarks is flat, its triangles' normals agree with the image's."""
    with resources.as_file(resources.files("facecrf_ocio.face") / "models") as folder:
        triangles = np.load(folder / "canonical_face_mesh.npz")["triangles"]
    points = ideal.landmarks_xyz * (1, -1, -1)
    a, b, c = points[triangles].transpose(1, 0, 2)
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    triangle = rasterize(ideal.landmarks_xyz, triangles, *ideal.skin.shape).triangle
    both = (triangle >= 0) & ideal.skin
    normals = ideal.normals[both]
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
    angle = np.rad2deg(np.arccos(np.clip((normals * flat[triangle[both]]).sum(axis=1), -1, 1)))
    assert np.median(angle) < 6.0


def test_a_head_turned_to_the_right_of_the_image_points_its_nose_there():
    noses = [render_face(replace(SMALL, yaw=yaw)).landmarks_xyz[1] for yaw in (-25.0, 0.0, 25.0)]
    assert noses[0][0] < noses[1][0] - 10
    assert noses[2][0] > noses[1][0] + 10
    up = render_face(replace(SMALL, pitch=15.0)).landmarks_xyz[1]
    assert up[1] < noses[1][1] - 5
    tilted = render_face(replace(SMALL, roll=20.0)).landmarks_xyz
    assert tilted[10][0] > tilted[152][0] + 25


def test_the_pigments_are_independent_and_sparse(natural):
    melanin, hemoglobin = natural.melanin[natural.skin], natural.hemoglobin[natural.skin]
    assert abs(np.corrcoef(melanin, hemoglobin)[0, 1]) < 0.1
    for density in (melanin, hemoglobin):
        centered = density - density.mean()
        assert (centered**4).mean() / (centered**2).mean() ** 2 > 4.0


def test_strong_changes_of_one_pigment_come_with_none_of_the_other(natural):
    """The pairs the paper picks (eq. 25), from the true densities, are single-pigment pairs."""
    skin = natural.skin[:, 1:] & natural.skin[:, :-1]
    steps = np.abs([np.diff(d, axis=1)[skin] for d in (natural.melanin, natural.hemoglobin)])
    low, high = np.quantile(steps, 0.10, axis=1), np.quantile(steps, 0.95, axis=1)
    for one, other in ((0, 1), (1, 0)):
        picked = (steps[one] > high[one]) & (steps[other] < low[other])
        assert picked.sum() > 50
        assert (steps[other] < 0.02 * steps[one])[picked].mean() > 0.99


def test_contrast_scales_the_pigments(ideal):
    flat = render_face(replace(IDEAL, melanin_contrast=0.0))
    strong = render_face(replace(IDEAL, hemoglobin_contrast=2.0))
    assert np.abs(flat.melanin[flat.skin]).max() < 0.01  # the rim of the lips
    assert flat.hemoglobin[flat.skin].std() == pytest.approx(ideal.hemoglobin[ideal.skin].std())
    ratio = strong.hemoglobin[ideal.skin].std() / ideal.hemoglobin[ideal.skin].std()
    assert ratio == pytest.approx(2.0, rel=0.05)


def test_gains_multiply_the_channels(ideal):
    gains = (0.8, 1.0, 1.15)
    tinted = render_face(replace(IDEAL, gains=gains))
    assert np.allclose(tinted.linear[ideal.skin], ideal.linear[ideal.skin] * gains, rtol=1e-5)
    assert np.array_equal(tinted.albedo, ideal.albedo)


def test_exposure_places_the_skin():
    for exposure in (0.2, 0.45):
        face = render_face(replace(SMALL, exposure=exposure))
        assert np.median(face.linear[face.skin], axis=0).max() == pytest.approx(exposure, rel=1e-4)


def test_highlights_have_the_color_of_their_light():
    light = Light((-0.3, 0.3, 1.0), (1.0, 0.5, 0.25))
    face = render_face(SyntheticSpec(lights=(light,), highlight=0.2, exposure=0.3))
    shiny = face.specular[face.skin]
    assert 0.02 < shiny.max() <= 0.2 * 0.3 + 1e-6
    assert np.allclose(shiny[:, 1:], shiny[:, :1] * (0.5, 0.25), atol=1e-6)


def test_noise_has_the_variance_of_photons_and_readout():
    spec = SyntheticSpec(seed=2, full_well=3000.0, read_noise=12.0)
    face = render_face(spec)
    expected = without_noise(face)
    noise = (face.linear - expected)[face.skin]
    level = expected[face.skin]
    for low, high in ((0.05, 0.15), (0.15, 0.3), (0.3, 0.6)):
        band = (level > low) & (level < high)
        assert band.sum() > 1000
        model = level[band].mean() / 3000.0 + (12.0 / 3000.0) ** 2
        assert noise[band].var() == pytest.approx(model, rel=0.05)
        assert abs(noise[band].mean()) < 5 * np.sqrt(model / band.sum())


def test_without_noise_linear_is_albedo_times_shading_plus_specular_everywhere():
    face = render_face(SyntheticSpec(seed=4, full_well=0.0, cast_shadows=True))
    assert np.allclose(face.linear, np.clip(without_noise(face), 0, 1), atol=1e-6)
    assert face.linear.dtype == np.float32
    assert np.isfinite(face.albedo).all()
    assert np.isfinite(face.shading).all()


def test_cast_shadows_only_darken():
    spec = SyntheticSpec(lights=(Light((0.9, 0.3, 0.4)),), ambient=(0.2, 0.2, 0.2), full_well=0.0)
    plain, cast = render_face(spec), render_face(replace(spec, cast_shadows=True))
    ratio = cast.shading[plain.skin, 0] / plain.shading[plain.skin, 0]
    ratio /= ratio.max()  # each is exposed for its own median
    assert (ratio < 0.7).mean() > 0.01
    assert (ratio > 0.99).mean() > 0.6


def test_the_same_spec_gives_the_same_pixels_and_another_seed_others(natural):
    again = render_face(SyntheticSpec(seed=3))
    assert np.array_equal(again.linear, natural.linear)
    other = render_face(SyntheticSpec(seed=4))
    assert not np.array_equal(other.linear, natural.linear)


@pytest.mark.parametrize(
    ("yaw", "tone", "exposure"),
    [(-30.0, 0.0, 0.45), (0.0, 0.3, 0.45), (20.0, 0.6, 0.4), (0.0, 1.0, 0.2), (30.0, 1.0, 0.45)],
)
def test_yunet_finds_exactly_one_face(yaw, tone, exposure):
    photo = photograph(
        render_face(SyntheticSpec(seed=5, yaw=yaw, tone=tone, exposure=exposure)), SRGB_LIKE
    )
    bgr = np.ascontiguousarray((photo.encoded[..., ::-1] * 255).round().astype(np.uint8))
    with resources.as_file(resources.files("facecrf_ocio.face") / "models") as folder:
        model = str(folder / "face_detection_yunet_2023mar.onnx")
        detector = cv2.FaceDetectorYN.create(model, "", bgr.shape[1::-1], 0.5)
    _, found = detector.detect(bgr)
    assert len(found) == 1
    assert found[0, -1] > 0.8


def test_a_photo_is_the_linear_image_within_half_a_code(ideal):
    photo = photograph(ideal, SRGB_LIKE, bits=8)
    assert photo.bit_depth == 8
    codes = photo.encoded * 255
    assert np.allclose(codes, np.round(codes), atol=1e-4)
    half = 0.5001 / 255
    low = SRGB_LIKE.linearize(np.clip(photo.encoded - half, 0, 1))
    high = SRGB_LIKE.linearize(np.clip(photo.encoded + half, 0, 1))
    assert (low <= ideal.linear + 1e-6).all()
    assert (ideal.linear <= high + 1e-6).all()


def test_unrounded_encoding_is_undone_exactly():
    rng = np.random.default_rng(0)
    linear = rng.uniform(0, 1, (50, 3)).astype(np.float32)
    curve = gamma_curve((1.8, 2.2, 2.6))
    assert np.allclose(curve.linearize(encode(linear, curve, bits=0)), linear, atol=1e-6)
    assert np.allclose(
        encode(linear, curve, bits=0), linear ** (1 / np.array([1.8, 2.2, 2.6])), atol=2e-3
    )


def test_sixteen_bits_are_finer_than_eight(ideal):
    assert photograph(ideal, SRGB_LIKE, bits=16).bit_depth == 16
    exact = encode(ideal.linear, SRGB_LIKE, bits=0)
    assert np.abs(encode(ideal.linear, SRGB_LIKE, bits=16) - exact).max() <= 0.51 / 65535
    assert photograph(ideal, SRGB_LIKE, bits=0).bit_depth is None


@pytest.mark.parametrize("mesh", [face_head()])
def test_the_head_is_a_closed_smooth_surface(mesh):
    sides = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    forward = {tuple(side) for side in sides.tolist()}
    assert len(forward) == len(sides)
    assert all((b, a) in forward for a, b in forward)
    corners = mesh.vertices[mesh.triangles]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert 2000 < volume < 5000  # [cm^3], positive: triangles turn their outside outward


def test_meshes_are_shared_read_only():
    for mesh in (face_head(), hair_and_ears(), bust()):
        with pytest.raises(ValueError, match="read-only"):
            mesh.vertices[0, 0] = 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        {"tone": 1.5},
        {"lights": ()},
        {"gains": (1.0, 0.0, 1.0)},
        {"exposure": 0.0},
        {"height": 0},
        {"full_well": -1.0},
    ],
)
def test_impossible_specs_are_refused(wrong):
    with pytest.raises(SettingsError, match="synthetic face"):
        SyntheticSpec(**wrong)


def test_impossible_lights_curves_and_sizes_are_refused(ideal):
    with pytest.raises(SettingsError, match="direction"):
        Light((0.0, 0.0, 0.0))
    with pytest.raises(SettingsError, match="color"):
        Light((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    with pytest.raises(SettingsError, match="exponent"):
        gamma_curve(0.0)
    with pytest.raises(SettingsError, match="17 bits"):
        encode(ideal.linear, SRGB_LIKE, bits=17)
    with pytest.raises(SettingsError, match="no skin in view"):
        render_face(SyntheticSpec(height=20, width=20, face_width=2.0))
