"""What a shot tells of its curve beside the faces in it: points under exposures told, or noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.clip.chosen_frames import ChosenFrame
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.clip.frame_noise import Image, noise_levels
from facecrf_ocio.clip.jpeg_frames import holds_jpeg
from facecrf_ocio.clip.noise_light import add_noise
from facecrf_ocio.clip.shared_light import add_points
from facecrf_ocio.clip.tracked_points import FEWER, TrackedPoints, thinned
from facecrf_ocio.joint import JointModel
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.pair.exposure_grid import stops_of_shots
from facecrf_ocio.photo.shot import read_shot
from facecrf_ocio.values import Float

_LEAST_STOPS = 0.3  # [stop] of exposures that tell anything of the curve
_PAIRS = 6  # of frames that follow one another, whose noise is measured; more tell hardly more


@dataclass(frozen=True, slots=True, eq=False)
class BesideFaces:
    """The curve by all that a clip tells.

    Attributes
    ----------
    faces, whole
        Its coefficients by the faces alone, and with what is told beside them.
    exposures_told
        Whether files told exposures that differ, and points showed them.
    noise_told
        Whether the noise of frames that follow one another told the curve's exponent.
    """

    faces: Posterior
    whole: Posterior
    exposures_told: bool = False
    noise_told: bool = False


def add_beside_faces(
    faces: Posterior,
    clip: Clip,
    shot: Sequence[ChosenFrame],
    followed: TrackedPoints | None,
    model: JointModel,
) -> BesideFaces:
    """What faces leave of the prior, and then what else is told.

    Parameters
    ----------
    faces
        Coefficients by the faces of all frames.
    clip, shot
        Frames of one shot of the clip; their noise tells where they were no JPEGs.
    followed
        The same points in these frames, where enough are left.
    model
        Has the prior of the curves, and the factor that makes deviations honest.
    """
    prior, scale = model.prior, model.band_scale
    stops = _told_stops(shot)
    if followed is not None and stops is not None:
        whole = add_points(faces, thinned(followed, FEWER), stops, prior, scale)
        return BesideFaces(faces, whole, exposures_told=True)
    if clip.motion_jpeg or any(one.path and holds_jpeg(one.path) for one in shot):
        return BesideFaces(faces, faces)
    levels = noise_levels(_pairs(clip, [one.index for one in shot]))
    found = add_noise(faces, levels, prior, scale)
    return BesideFaces(faces, faces if found is None else found, noise_told=found is not None)


def _told_stops(shot: Sequence[ChosenFrame]) -> Float | None:
    """(J,) log2 of the exposures of frames, by the EXIF of their files; None where it is silent."""
    paths = [one.path for one in shot if one.path is not None]
    if len(set(paths)) < len(shot):
        return None  # frames of one video file
    told = [read_shot(path) for path in paths]
    if any(one.exposure_s <= 0.0 for one in told):
        return None
    stops = stops_of_shots(told)
    return stops if np.ptp(stops) >= _LEAST_STOPS else None


def _pairs(clip: Clip, frames: Sequence[int]) -> Iterator[tuple[Image, Image]]:
    """Some of these frames, each with the one that follows it."""
    spread = np.unique(np.linspace(0, len(frames) - 1, min(len(frames), _PAIRS)).astype(np.intp))
    firsts = {min(frames[at], len(clip.times) - 2) for at in spread}
    wanted = sorted(firsts | {index + 1 for index in firsts})
    before: tuple[int, Image] | None = None
    for index, photo in clip.read(wanted):
        if before is not None and index - 1 in firsts and before[0] == index - 1:
            yield before[1], photo.encoded
        before = index, photo.encoded
