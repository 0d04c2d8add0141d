"""Photos of linear heads through drawn responses, reduced to the counts that are learned from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.geometry import face_geometry
from facecrf_ocio.face.view import FaceView
from facecrf_ocio.joint.noise_counts import NoiseCounts, count_noise
from facecrf_ocio.joint.statistics import FACE_CUES, Statistics, face_statistics, resampled
from facecrf_ocio.joint.windows import SIDE, Window, face_windows, photo_windows
from facecrf_ocio.settings import Settings
from facecrf_ocio.training.before_camera import Head, stage
from facecrf_ocio.training.curves import CurveSource, Draw
from facecrf_ocio.training.draw_process import FROM_CAMERAS, Shares, draw_process
from facecrf_ocio.training.layout import Layout, draw_layout, some_windows
from facecrf_ocio.training.process import Process, Response, photograph
from facecrf_ocio.values import Float

Light = npt.NDArray[np.float32]
_MEASURED = 0.3  # of the photos of training, the share through a measured response as it is
_FACE_SIDE = 300  # px: larger faces are made at this width, with less noise
_LOOKS = 4  # photos that are tried before a head in one light is given up


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """What one simulated photo shows, and the response behind it.

    Attributes
    ----------
    head
        Name of the image.
    drawn
        The truth.
    photo, skin
        What its windows hold.
    of_face
        Statistics of the face at working size, by cue.
    sample
        (N, 3) encoded values of the skin.
    process, layout
        What was done.
    """

    head: str
    drawn: Draw
    photo: NoiseCounts
    skin: NoiseCounts
    of_face: dict[str, Float]
    sample: Float
    process: Process
    layout: Layout


def simulate(
    heads: Sequence[Head],
    around: tuple[Light, ...],
    source: CurveSource,
    count: int,
    seed: Sequence[int],
    shares: Shares = FROM_CAMERAS,
    measured: float = _MEASURED,
) -> Iterator[Example]:
    """Take `count` photos, one head after the other; some show too little skin and are left out.

    `measured` is the share of those through a measured response as it is.
    """
    generator = np.random.default_rng(seed)
    for number in range(count):
        head = heads[number % len(heads)]
        drawn = source.draw(generator, measured=generator.random() < measured)
        for _ in range(_LOOKS):
            example = take(head, around, drawn, draw_process(generator, shares), generator)
            if example is not None:
                yield example
                break


def take(
    head: Head,
    around: tuple[Light, ...],
    drawn: Draw,
    process: Process,
    generator: np.random.Generator,
) -> Example | None:
    """One photo; None where the face shows too little skin for an estimate."""
    layout = draw_layout(head, around, generator)
    picture = stage(head, generator)
    response = Response.of(drawn.inverse)
    view = _view(layout, picture, process, response, generator)
    of_face = face_statistics(view, Settings())
    if of_face is None:
        return None
    scaled = process.scale < 1.0
    photo = _counted(
        photo_windows(layout.height, layout.width),
        (3, 128) if scaled else (4, SIDE),
        (layout, picture, process, response),
        generator,
    )
    skin = _counted(
        face_windows(layout.face.landmarks_xyz, layout.height, layout.width),
        (1, 144) if scaled else (2, 160),
        (layout, picture, process, response),
        generator,
        (of_face, view),
    )
    sample = of_face.encoded
    by_cue = {cue: of_face.by_cue[cue] for cue in FACE_CUES if cue in of_face.by_cue}
    return Example(head.name, drawn, photo, skin, by_cue, sample, process, layout)


def _view(
    layout: Layout,
    picture: Light,
    process: Process,
    response: Response,
    generator: np.random.Generator,
) -> FaceView:
    """The face at working size, as `cut_face` has it."""
    points = layout.face.landmarks_xyz[:, :2]
    margin = 0.05 * layout.face.box_xy[2]
    left, top = np.maximum(np.floor(points.min(axis=0) - margin), 0).astype(int).tolist()
    low = (left + 1, top + 1)
    right, bottom = (
        np.clip(np.ceil(points.max(axis=0) + margin), low, [layout.width, layout.height])
        .astype(int)
        .tolist()
    )
    stored = (bottom - top, right - left)
    face_width = float(np.ptp(points[:, 0]))
    sensor = face_width / process.scale
    coarse = min(1.0, _FACE_SIDE / sensor)
    made = _times(stored, coarse / process.scale)
    light = layout.light(picture, (slice(top, bottom), slice(left, right)), made, generator)
    seen = _smaller(stored, made)
    encoded = photograph(light, process, response, seen, generator, coarse)
    working = min(1.0, Settings().face_width / face_width)
    size = _times(stored, working)
    if size != seen:
        encoded = np.asarray(cv2.resize(encoded, size[::-1], interpolation=cv2.INTER_AREA))
    geometry = face_geometry(layout.face, size, origin=(float(left), float(top)), scale=working)
    frame = (float(left), float(top), float(stored[1]), float(stored[0]))
    return FaceView(layout.face, encoded, geometry, frame)


def _counted(
    windows: list[Window],
    most: tuple[int, int],
    photo: tuple[Layout, Light, Process, Response],
    generator: np.random.Generator,
    face: tuple[Statistics, FaceView] | None = None,
) -> NoiseCounts:
    layout, picture, process, response = photo
    parts, stands_for = some_windows(windows, *most, generator)
    taken, masks = [], []
    for part in parts:
        size = (part[0].stop - part[0].start, part[1].stop - part[1].start)
        light = layout.light(picture, part, _times(size, 1.0 / process.scale), generator)
        taken.append(photograph(light, process, response, size, generator))
        if face is not None:
            masks.append(resampled(face[0].skin, face[1].frame, part))
    return count_noise(taken, masks if face else None, [stands_for] * len(taken))


def _times(size: tuple[int, int], factor: float) -> tuple[int, int]:
    return max(1, round(size[0] * factor)), max(1, round(size[1] * factor))


def _smaller(one: tuple[int, int], other: tuple[int, int]) -> tuple[int, int]:
    return one if one[0] < other[0] else other
