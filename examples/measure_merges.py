"""Merges of synthetic brackets by this project, OpenCV and colour-hdri, in one table.

Four exposures of a scene over nine stops, noise of a small sensor, 8 bits, the curve given to all;
still, and with a ball that moves. `python examples/measure_merges.py` prints Markdown; peers that
are not installed (`pip install colour-hdri`) are left out and named.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.pair.bracket_pixels import small_bracket
from facecrf_ocio.pair.merge import merge_bracket
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import Photo

Image = npt.NDArray[np.float32]
Merge = Callable[[list[Photo]], Image]

CURVE = gamma_curve(2.2)
STOPS = np.array([-4.0, -2.0, 0.0, 2.0])
SCENES = 5  # of which the table gives the mean
_SIZE = 240  # [px]
_SOFT = 16.0  # [px] blur of the scene's light
_READ, _PHOTON = 1e-5, 1e-4  # variance of light 0, and of each unit of light
_RANGES = ((-6.0, -3.0), (-3.0, 0.0), (0.0, 3.0))  # [stop] dark, middle, bright


def scene(seed: int) -> Image:
    """(H, W, 3) light from 1/64 to 8, and colors up to a stop from gray."""
    generator = np.random.default_rng(seed)

    def soft(channels: int) -> Image:
        noise = generator.normal(size=(_SIZE, _SIZE, channels)).astype(np.float32)
        noise = cv2.GaussianBlur(noise, (0, 0), _SOFT).reshape(_SIZE, _SIZE, channels)
        return np.asarray((noise - noise.min()) / np.ptp(noise), np.float32)

    return np.asarray(np.exp2(9.0 * soft(1) - 6.0 + soft(3) - 0.5), np.float32)


def shots(lights: list[Image], seed: int) -> list[Photo]:
    """One photo of each light, at its exposure."""
    generator = np.random.default_rng(seed)
    photos = []
    for light, stop in zip(lights, STOPS, strict=True):
        exposed = light * 2.0**stop
        noise = generator.normal(size=light.shape) * np.sqrt(_READ + _PHOTON * exposed)
        codes = np.rint(encode(np.clip(exposed + noise, 0, 1).astype(np.float32), CURVE) * 255)
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
    from colour_hdri import (  # type: ignore[import-not-found,unused-ignore] # noqa: PLC0415
        Image as Shot,
    )
    from colour_hdri import (  # noqa: PLC0415
        ImageStack,
        Metadata,
        image_stack_to_HDRI,
    )

    stack = ImageStack()
    for photo, stop in zip(photos, STOPS, strict=True):
        told = Metadata(f_number=1.0, exposure_time=float(2.0**stop), iso=100.0)
        stack.append(Shot(data=CURVE.linearize(photo.encoded).astype(np.float64), metadata=told))
    return np.asarray(image_stack_to_HDRI(stack), np.float32)


def errors(made: Image, light: Image, where: npt.NDArray[np.bool_]) -> list[float]:
    """RMS error in stops after one factor: of all, and of dark, middle and bright light."""
    off = np.log2(np.maximum(made, 1e-6) / light).mean(axis=2)
    off -= np.median(off[where])
    stops = np.log2(light).mean(axis=2)
    parts = [where, *(where & (stops >= low) & (stops < high) for low, high in _RANGES)]
    return [float(np.sqrt((off[part] ** 2).mean())) for part in parts]


def measured(merge: Merge) -> list[float]:
    """The row of a merge: four errors of still scenes, and one of scenes with a moving ball."""
    rows = []
    everywhere = np.ones((_SIZE, _SIZE), np.bool_)
    for seed in range(SCENES):
        light = scene(seed)
        still = errors(merge(shots([light] * len(STOPS), seed)), light, everywhere)
        balls = [with_a_ball(light, x) for x in (60, 100, 140, 180)]
        photos = shots(balls, seed)
        seen = balls[small_bracket(photos, STOPS).reference]
        rows.append([*still, errors(merge(photos), seen, everywhere)[0]])
    return list(map(float, np.mean(rows, axis=0)))


def table() -> Iterator[str]:
    """Markdown, a line at a time."""
    yield "| merge | still | dark | middle | bright | moving ball |"
    yield "|---|---|---|---|---|---|"
    merges: dict[str, Merge] = {
        "facecrf merge": ours,
        "OpenCV MergeDebevec": opencv("Debevec"),
        "OpenCV MergeRobertson": opencv("Robertson"),
        "colour-hdri, linearized before": colour_hdri,
    }
    for name, merge in merges.items():
        try:
            cells = measured(merge)
        except ImportError as error:
            print(f"left out: {name}: {error}", file=sys.stderr)
            continue
        yield f"| {name} | {' | '.join(f'{cell:.3f}' for cell in cells)} |"


if __name__ == "__main__":
    for line in table():
        print(line, flush=True)
