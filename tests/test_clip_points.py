"""Points that frames of a clip share: exposures told give the curve, untold ones its drift."""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import linear_face

from facecrf_ocio.benchmark.images import find_linear_images
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.clip.clip_source import open_clip
from facecrf_ocio.clip.shared_light import add_points
from facecrf_ocio.clip.tracked_points import TrackedPoints, track
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.photo.shot import read_shot

sys.path.append(str(Path(__file__).parents[1] / "examples" / "measure_clips"))
from clips_known import CELLS, Cell, ClipPlan, _alike, choose_cells, run_clips
from virtual_clip import EVEN, STEPS, Take, _course, drifted, take_clip

PRIOR = shipped_joint().prior
SIZE = PRIOR.basis.shape[0]
KNOWN_NOTHING = Posterior(np.ones(1), np.zeros((1, SIZE)), np.eye(SIZE)[None])
GRID = np.linspace(0.0, 1.0, 1024)
STOPS = np.linspace(-1.0, 1.0, 6)


def points(curves, stops=STOPS, count=200):
    """Gray points of known light, encoded by the inverse responses of each frame."""
    light = np.exp2(np.linspace(-5.0, -1.2, count))
    codes = [
        np.rint(255.0 * np.interp(light * 2.0**stop, curve, GRID))
        for curve, stop in zip(curves, stops, strict=True)
    ]
    three = np.repeat(np.array(codes)[:, :, None], 3, axis=2)
    usable = (three.min(axis=2) > 5) & (three.max(axis=2) < 247)
    return TrackedPoints(three, usable, np.zeros((count, 2)))


@pytest.mark.parametrize("exponent", [1.8, 2.2, 2.6])
def test_exposures_that_files_tell_give_the_curve_whatever_faces_say(exponent):
    curve = GRID**exponent
    found = add_points(KNOWN_NOTHING, points([curve] * 6), STOPS, PRIOR, 1.0)
    ours = np.interp(GRID, PRIOR.grid, PRIOR.samples(found.mean))
    seen = (GRID > 0.25) & (GRID < 0.85)
    apart = np.log2(ours[seen] / curve[seen])
    assert np.abs(apart - apart.mean()).max() < 0.03  # [stop]


def test_points_are_followed_through_movement_and_exposure():
    light = np.clip(cv2.GaussianBlur(linear_face(3), (0, 0), 2.0), 1e-4, 1.0).astype(np.float32)
    frames = []
    for shift, stop in ((0, -0.5), (3, 0.0), (6, 0.3)):
        moved = np.roll(light, shift, axis=1) * np.float32(2.0**stop)
        frames.append(np.clip(moved, 0.0, 1.0) ** np.float32(1 / 2.2))
    found = track(frames)
    assert found is not None
    both = found.usable[0] & found.usable[2]
    stops = 2.2 * np.log2(found.codes[2, both] / found.codes[0, both])
    assert np.median(stops) == pytest.approx(0.8, abs=0.03)


def test_too_few_points_are_none():
    assert track([np.zeros((64, 64, 3), np.float32)] * 3) is None


class TestVirtualClip:
    def test_jpegs_tell_their_exposures_if_asked(self, tmp_path):
        take = Take(None, swing=1.0, frames=3, told=True)
        take_clip(linear_face(3), (GRID**2.2,) * 2, take, np.random.default_rng(0), tmp_path)
        times = [read_shot(path).exposure_s for path in sorted(tmp_path.iterdir())]
        assert np.ptp(np.log2(times)) == pytest.approx(1.0, abs=0.1)

    def test_a_video_is_h264_of_as_many_frames(self, tmp_path):
        pytest.importorskip("av")
        take = Take(10.0, frames=4)
        path = take_clip(linear_face(3), (GRID**2.2,) * 2, take, np.random.default_rng(0), tmp_path)
        assert len(open_clip(path).times) == 4

    def test_a_drift_is_as_large_as_asked(self):
        end = drifted(GRID**2.2, GRID**1.8, 0.03)
        assert np.sqrt(((end - GRID**2.2) ** 2).mean()) == pytest.approx(0.03)
        with pytest.raises(SettingsError, match=r"less than 0\.5"):
            drifted(GRID**2.2, GRID**1.8, 0.5)


def test_rows_are_asked_for_by_parts_of_their_names():
    named = [cell for cell in CELLS if "JPEG" in cell.name]
    assert 0 < len(named) < len(CELLS)
    assert list(choose_cells("JPEG")) == named
    with pytest.raises(SettingsError, match="no row 'vhs'"):
        choose_cells("vhs")


@pytest.mark.slow
def test_the_bench_of_clips_measures_and_goes_on(tmp_path):
    np.savez(tmp_path / "curves.npz", inverse=np.array([GRID**2.2, GRID**1.6]))
    face = linear_face(3).astype(np.float32)
    spec = oiio.ImageSpec(face.shape[1], face.shape[0], 3, "float")
    out = oiio.ImageOutput.create(str(tmp_path / "face.exr"))
    out.open(str(tmp_path / "face.exr"), spec)
    out.write_image(face)
    out.close()
    plan = ClipPlan(
        find_linear_images(tmp_path, "face.exr").images,
        read_responses(tmp_path / "curves.npz"),
        count=1,
        cells=(Cell("told", Take(None, 1.5, frames=6, told=True)),),
    )
    text, files = run_clips(plan, tmp_path / "out")
    assert "| told" in text
    assert {path.name for path in files} == {"clips.md", "clips.csv"}
    before = (tmp_path / "out" / "clips.jsonl").read_bytes()
    assert run_clips(plan, tmp_path / "out")[0] == text
    assert (tmp_path / "out" / "clips.jsonl").read_bytes() == before


def test_exposures_of_known_clips_go_evenly_or_in_steps():
    times, generator = np.linspace(0.0, 1.0, 24), np.random.default_rng(0)
    even = _course(EVEN, times, generator)
    assert np.ptp(np.diff(even)) == pytest.approx(0.0, abs=1e-9)
    assert sorted(even[[0, -1]]) == [-1.0, 1.0]
    levels = np.unique(_course(STEPS, times, generator))
    assert levels == pytest.approx([-1.0, -1 / 3, 1 / 3, 1.0])


def test_errors_of_frames_count_as_alike_by_how_far_they_are_apart():
    near, far = _alike(np.array([[2.0], [2.0], [-1.0], [-1.0]]))
    assert near == pytest.approx((4.0 - 2.0 + 1.0) / 3.0)
    assert far == pytest.approx(-2.0)  # the first and the last alone
