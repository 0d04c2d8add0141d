"""Merges of synthetic brackets by this project, OpenCV and colour-hdri, in one table.

Four exposures of a scene over nine stops, noise of a small sensor, 8 bits, the curve given to all;
still, and with a ball that moves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.benchmark.peers.peer_table import MissingPeerError, peer
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.pair.bracket_pixels import small_bracket
from facecrf_ocio.pair.merge import merge_bracket
from facecrf_ocio.response.model import dorf_model, inverse_crf
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import InverseCRF, Photo

Image = npt.NDArray[np.float32]
Merge = Callable[[list[Photo]], Image]

CURVE = gamma_curve(2.2)  # between those of cameras; it is given to all
STOPS = np.array([-4.0, -2.0, 0.0, 2.0])  # [stop] as cameras bracket at their widest
SCENES = 5  # of which the table gives the mean
_SIZE = 240  # [px]
_SOFT = 16.0  # [px] blur of the scene's light
_READ, _PHOTON = 1e-5, 1e-4  # variance of light 0, and of each unit of light
_RANGES = ((-6.0, -3.0), (-3.0, 0.0), (0.0, 3.0))  # [stop] dark, middle, bright


def scene(seed: int, larger: int = 1) -> Image:
    """(H, W, 3) light from 1/64 to 8, and colors up to a stop from gray."""
    generator = np.random.default_rng(seed)
    size = larger * _SIZE

    def soft(channels: int) -> Image:
        noise = generator.normal(size=(_SIZE, _SIZE, channels)).astype(np.float32)
        blurred = np.asarray(cv2.GaussianBlur(noise, (0, 0), _SOFT), np.float32)
        if larger > 1:
            blurred = np.asarray(cv2.resize(blurred, (size, size)), np.float32)
        noise = blurred.reshape(size, size, channels)
        return np.asarray((noise - noise.min()) / np.ptp(noise), np.float32)

    return np.asarray(np.exp2(9.0 * soft(1) - 6.0 + soft(3) - 0.5), np.float32)


def shots(lights: list[Image], seed: int, curve: InverseCRF = CURVE) -> list[Photo]:
    """One photo of each light, at its exposure."""
    generator = np.random.default_rng(seed)
    photos = []
    for light, stop in zip(lights, STOPS, strict=True):
        exposed = light * 2.0**stop
        noise = generator.normal(size=light.shape) * np.sqrt(_READ + _PHOTON * exposed)
        codes = np.rint(encode(np.clip(exposed + noise, 0, 1).astype(np.float32), curve) * 255)
        photos.append(Photo(codes.astype(np.float32) / np.float32(255), bit_depth=8))
    return photos


def with_a_ball(light: Image, x: int) -> Image:
    """A dark ball that stands at x."""
    return np.asarray(cv2.circle(light.copy(), (x, _SIZE // 2), 24, (0.05,) * 3, -1), np.float32)


def ours(photos: list[Photo]) -> Image:
    """As `facecrf merge` does it."""
    bracket = small_bracket(photos, STOPS)
    return merge_bracket(lambda index: photos[index], bracket, CURVE).linear


def opencv(kind: str) -> Merge:
    """`MergeDebevec` or `MergeRobertson`."""
    levels = np.linspace(0, 1, 256)
    response = np.stack([np.interp(levels, CURVE.encoded, row) for row in CURVE.linear], axis=1)
    table = np.maximum(response, 1e-5)[:, None].astype(np.float32)

    def merge(photos: list[Photo]) -> Image:
        images = [np.rint(photo.encoded * 255).astype(np.uint8) for photo in photos]
        times = np.exp2(STOPS).astype(np.float32)
        made = getattr(cv2, f"createMerge{kind}")().process(images, times, table)
        return np.asarray(made, np.float32)

    return merge


def colour_hdri(photos: list[Photo]) -> Image:
    """colour-hdri's merge of photos that were linearized before, its default weights."""
    hdri = peer("colour_hdri", "colour-hdri")
    stack = hdri.ImageStack()
    for photo, stop in zip(photos, STOPS, strict=True):
        told = hdri.Metadata(f_number=1.0, exposure_time=float(2.0**stop), iso=100.0)
        linear = CURVE.linearize(photo.encoded).astype(np.float64)
        stack.append(hdri.Image(data=linear, metadata=told))
    return np.asarray(hdri.image_stack_to_HDRI(stack), np.float32)


def one_photo(curve: InverseCRF) -> Merge:
    """The middle exposure alone, by a curve."""

    def merge(photos: list[Photo]) -> Image:
        bracket = small_bracket(photos, STOPS)
        return curve.linearize(photos[bracket.reference].encoded)

    return merge


def errors(made: Image, light: Image, where: npt.NDArray[np.bool_]) -> list[float]:
    """RMS errors [stop] after one factor: of all, and of dark, middle and bright light."""
    off = np.log2(np.maximum(made, 1e-6) / light).mean(axis=2)
    off -= np.median(off[where])
    stops = np.log2(light).mean(axis=2)
    parts = [where, *(where & (stops >= low) & (stops < high) for low, high in _RANGES)]
    return [float(np.sqrt((off[part] ** 2).mean())) for part in parts]


def measured(merge: Merge, scenes: int = SCENES) -> list[float]:
    """The row of a merge: four errors of still scenes, and one of scenes with a moving ball."""
    rows = []
    everywhere = np.ones((_SIZE, _SIZE), np.bool_)
    for seed in range(scenes):
        light = scene(seed)
        still = errors(merge(shots([light] * len(STOPS), seed)), light, everywhere)
        balls = [with_a_ball(light, x) for x in (60, 100, 140, 180)]
        photos = shots(balls, seed)
        seen = balls[small_bracket(photos, STOPS).reference]
        rows.append([*still, errors(merge(photos), seen, everywhere)[0]])
    return list(map(float, np.mean(rows, axis=0)))


def merge_rows(missing: Callable[[str], None], scenes: int = SCENES) -> Iterator[str]:
    """Markdown, a line at a time; peers that are missing are told and left out."""
    yield "| merge | still | dark | middle | bright | moving ball |"
    yield "|---|---|---|---|---|---|"
    grid = dorf_model().grid
    mean, srgb = (
        inverse_crf(grid, np.array([row] * 3)) for row in (dorf_model().mean, decode_srgb(grid))
    )
    merges: dict[str, Merge] = {
        "`facecrf merge`": ours,
        "OpenCV MergeDebevec": opencv("Debevec"),
        "OpenCV MergeRobertson": opencv("Robertson"),
        "colour-hdri, linearized before": colour_hdri,
        "one photo alone, its curve": one_photo(CURVE),
        "one photo alone, mean curve": one_photo(mean),
        "one photo alone, sRGB": one_photo(srgb),
    }
    for name, merge in merges.items():
        try:
            cells = measured(merge, scenes)
        except MissingPeerError as error:
            missing(str(error))
            continue
        yield f"| {name} | {' | '.join(f'{cell:.3f}' for cell in cells)} |"
