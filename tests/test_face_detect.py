"""Every usable face of a photo is found, and nothing else."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import cv2
import numpy as np
import pytest
from face_photos import eight_bit, grace_hopper, linear_light, rendered_heads, shrink, turn

from facecrf_ocio.face import landmarks
from facecrf_ocio.face.blazeface import detect_blazeface
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.no_face import lacking_faces
from facecrf_ocio.face.yunet import detect_yunet
from facecrf_ocio.settings import Settings

SETTINGS = Settings()
IRISES = [468, 473]
PUPILS_BY_HAND = np.array([[221.5, 190.0], [304.5, 187.0]])
WIDTH = 170.0  # [px] of Grace Hopper's face


def the_face(photo, settings=SETTINGS):
    (face,) = find_faces(photo, settings).faces
    return face


def mean_distance(a, b):
    return np.linalg.norm(a - b, axis=1).mean()


def cartoon():
    picture = np.full((480, 640, 3), (0.9, 0.8, 0.6), np.float32)
    cv2.circle(picture, (320, 240), 150, (1.0, 0.85, 0.2), -1)
    for x in (265, 375):
        cv2.ellipse(picture, (x, 200), (14, 22), 0, 0, 360, (0, 0, 0), -1)
    cv2.ellipse(picture, (320, 280), (80, 50), 0, 10, 170, (0.6, 0.1, 0.1), 8)
    return picture


def test_portrait_has_one_face_with_its_landmarks_in_place():
    found = find_faces(grace_hopper(), SETTINGS)
    assert found.too_small == 0
    (face,) = found.faces
    assert face.score > 0.9
    assert face.landmarks_xyz.shape == (478, 3)
    assert np.abs(face.landmarks_xyz[IRISES, :2] - PUPILS_BY_HAND).max() < 3.0
    x, y, width, height = face.box_xy
    inside = (face.landmarks_xyz[:, :2] > (x - 20, y - 20)).all()
    inside &= (face.landmarks_xyz[:, :2] < (x + width + 20, y + height + 20)).all()
    assert inside
    assert width == pytest.approx(WIDTH, rel=0.1)


def test_landmark_depth_grows_away_from_the_camera():
    z = the_face(grace_hopper()).landmarks_xyz[:, 2]
    nose_tip, ears = z[1], z[[234, 454]]
    assert 0.3 * WIDTH < (ears - nose_tip).min() < (ears - nose_tip).max() < WIDTH


def test_all_faces_are_returned_widest_first():
    large, small = grace_hopper(), shrink(grace_hopper(), 0.5)
    photo = np.full((600, 800, 3), 0.5, np.float32)
    photo[200:500, :256] = small
    photo[:, 288:] = large
    found = find_faces(photo, SETTINGS)
    assert len(found.faces) == 2
    assert found.faces[0].box_xy[2] > 1.5 * found.faces[1].box_xy[2]
    assert found.faces[0].landmarks_xyz[1, 0] > 288 > found.faces[1].landmarks_xyz[1, 0]


def test_the_widest_face_alone_costs_no_landmarks_of_the_others(monkeypatch):
    photo = np.full((600, 800, 3), 0.5, np.float32)
    photo[200:500, :256] = shrink(grace_hopper(), 0.5)
    photo[:, 288:] = grace_hopper()
    passes = []
    run = landmarks._run
    monkeypatch.setattr(landmarks, "_run", lambda crop: (passes.append(1), run(crop))[1])
    every = find_faces(photo, SETTINGS).faces
    taken = len(passes)
    (widest,) = find_faces(photo, SETTINGS, most=1).faces
    # It is sought on a part of the copy, and the network sees the edge of that.
    assert mean_distance(widest.landmarks_xyz, every[0].landmarks_xyz) < 0.002 * WIDTH
    assert len(passes) - taken < taken


def test_small_faces_are_counted_but_not_returned():
    photo = np.full((400, 400, 3), 0.5, np.float32)
    tiny = shrink(grace_hopper(), 20.0 / WIDTH)
    photo[100 : 100 + tiny.shape[0], 150 : 150 + tiny.shape[1]] = tiny
    found = find_faces(photo, SETTINGS)
    assert found.faces == ()
    assert found.too_small == 1


def test_least_width_is_in_pixels_of_the_photo():
    wide = cv2.resize(grace_hopper(), None, fx=3.0, fy=3.0)  # searched on a smaller copy
    assert find_faces(wide, Settings(min_face_width=int(3 * WIDTH * 0.9))).faces
    found = find_faces(wide, Settings(min_face_width=int(3 * WIDTH * 1.2)))
    assert (found.faces, found.too_small) == ((), 1)


def test_heads_whose_face_is_not_to_be_seen_are_counted_and_told():
    blurred = cv2.GaussianBlur(grace_hopper(), (0, 0), 15.0)
    found = find_faces(blurred, SETTINGS)
    assert (found.faces, found.too_small, found.turned_away) == ((), 0, 1)
    told = lacking_faces(found, SETTINGS)
    assert told.reason.startswith("no face found that can be measured: 1 head turned away")
    assert told.remedy == "use a photo that shows a face from the front"


@pytest.mark.parametrize("scale", [4.0, 2.0, 0.5])
def test_landmarks_scale_with_the_photo(scale):
    photo = grace_hopper()
    method = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    resized = np.clip(cv2.resize(photo, None, fx=scale, fy=scale, interpolation=method), 0, 1)
    landmarks = the_face(resized).landmarks_xyz / scale
    assert mean_distance(landmarks, the_face(photo).landmarks_xyz) < 0.02 * WIDTH


@pytest.mark.parametrize("degrees", [20, 45, 90, 135, 180, 225, 270, 315])
def test_turned_faces_keep_their_landmarks(degrees):
    turned, to_turned = turn(grace_hopper(), degrees)
    upright = the_face(grace_hopper()).landmarks_xyz
    expected = upright[:, :2] @ to_turned[:, :2].T + to_turned[:, 2]
    landmarks = the_face(turned).landmarks_xyz
    assert mean_distance(landmarks[:, :2], expected) < 0.02 * WIDTH
    assert np.abs(landmarks[:, 2] - upright[:, 2]).mean() < 0.04 * WIDTH


@pytest.mark.parametrize(
    "darken",
    [
        lambda photo: eight_bit(linear_light(photo)),
        lambda photo: eight_bit(photo / 16),
        lambda photo: eight_bit(linear_light(photo) / 16),
        lambda photo: (linear_light(photo) / 256).astype(np.float32),
    ],
    ids=["linear", "1/16 of the code", "1/16 of the light, linear", "1/256 in floating point"],
)
def test_dark_photos_keep_their_landmarks(darken):
    expected = the_face(grace_hopper()).landmarks_xyz
    found = the_face(darken(grace_hopper())).landmarks_xyz
    assert mean_distance(found, expected) < 0.03 * WIDTH


NO_FACE = {
    "one pixel": np.full((1, 1, 3), 0.5, np.float32),
    "one row": np.full((1, 5000, 3), 0.5, np.float32),
    "one column": np.full((5000, 1, 3), 0.5, np.float32),
    "black": np.zeros((300, 400, 3), np.float32),
    "white": np.ones((300, 400, 3), np.float32),
    "gray": np.full((300, 400, 3), 0.5, np.float32),
    "noise": np.random.default_rng(0).random((300, 400, 3), np.float32),
    "ramp": np.tile(np.linspace(0, 1, 400, dtype=np.float32)[:, None], (300, 1, 3)),
    "cartoon": cartoon(),
    "no head": grace_hopper()[360:],
}


@pytest.mark.parametrize("name", NO_FACE)
def test_no_face_is_seen_where_there_is_none(name):
    found = find_faces(NO_FACE[name], SETTINGS)
    assert (found.faces, found.too_small, found.turned_away) == ((), 0, 0)
    assert lacking_faces(found, SETTINGS).reason == "no face found"


def test_threads_share_the_networks():
    photos = [grace_hopper(), turn(grace_hopper(), 10)[0]] * 3
    one_by_one = [the_face(photo).landmarks_xyz for photo in photos]
    with ThreadPoolExecutor(4) as pool:
        at_once = [face.landmarks_xyz for face in pool.map(the_face, photos)]
    assert np.array_equal(one_by_one, at_once)


def test_both_detectors_agree():
    pixels = np.rint(grace_hopper() * 255).astype(np.uint8)
    (first,) = detect_yunet(pixels, 0.7)
    (second,) = detect_blazeface(pixels, 0.6)
    assert np.linalg.norm(first.eyes_xy - second.eyes_xy, axis=1).max() < 0.05 * WIDTH
    assert np.linalg.norm(first.center_xy - second.center_xy) < 0.15 * WIDTH
    for seen in (first, second):
        assert np.linalg.norm(seen.eyes_xy - PUPILS_BY_HAND, axis=1).max() < 0.08 * WIDTH


def test_portraits_have_one_face_each(development_data):
    """YuNet also sees one in the painting behind fr_biden2, which the landmarks refuse."""
    paths = [
        p for p in (development_data / "faces/encoded").iterdir() if p.suffix in {".jpg", ".png"}
    ]
    assert len(paths) == 9
    for path in paths:
        photo = cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB).astype(np.float32) / 255
        assert len(find_faces(photo, SETTINGS).faces) == 1, path.name


@pytest.mark.slow
def test_rendered_heads_are_where_the_index_says(development_data):
    for head in rendered_heads(development_data):
        face = the_face(head.encoded)
        x, y, width, height = head.box_xy
        low = np.maximum(face.box_xy[:2], (x, y))
        high = np.minimum(face.box_xy[:2] + face.box_xy[2:], (x + width, y + height))
        common = np.prod(np.maximum(high - low, 0))
        assert common / (np.prod(face.box_xy[2:]) + width * height - common) > 0.85, head.name
