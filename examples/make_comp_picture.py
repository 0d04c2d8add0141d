"""Draw docs/images/comp.jpg: the same rack focus, in code values and in linear light.

`python examples/make_comp_picture.py [FOLDER]`. The photo is matplotlib's portrait of Grace Hopper
(US Navy, public domain). Behind her the room goes dark and out of focus, with lamps that are many
times as bright as the photo's white; she is lit a stop less, and the lens glows a little. Both
pictures are made by the same four operations. On the left they work on code values, which hold no
more than white; on the right on the linear light that the photo's curve gives, which is then
encoded by that curve again.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import cv2
import matplotlib.cbook
import numpy as np
from matplotlib.figure import Figure

from facecrf_ocio import calibrate, read_photo

RADIUS = 26  # of the aperture's disk, pixels
ROOM = 0.16  # the room's light, times what it was
KEY = 0.62  # hers
GLOW = 0.06  # share of light that the lens spreads
# Lamps in the room: warm ones mostly; photo's white is 1.
LAMP_COLORS = np.array([(1.0, 0.56, 0.2), (1.0, 0.72, 0.42), (0.35, 0.6, 1.0), (1.0, 0.25, 0.18)])
SCALE = 2  # drawn larger than the photo, so that disks are round
GROUND = "#141414"


def disk_blur(image: np.ndarray, radius: int) -> np.ndarray:
    """Convolve with a disk, which is what a lens out of focus does to light."""
    y, x = np.mgrid[-radius : radius + 1, -radius : radius + 1]
    disk = (x**2 + y**2 <= radius**2).astype(np.float32)
    return cv2.filter2D(image, -1, disk / disk.sum(), borderType=cv2.BORDER_REFLECT)


def person(codes: np.ndarray) -> np.ndarray:
    """(H, W, 1) share of each pixel that is hers, by OpenCV's GrabCut."""
    small = (255 * codes).astype(np.uint8)
    height, width = small.shape[:2]
    mask = np.full((height, width), cv2.GC_PR_BGD, np.uint8)
    center = (width * 52 // 100, height * 36 // 100)
    cv2.ellipse(mask, center, (width * 21 // 100, height * 29 // 100), 0, 0, 360, cv2.GC_PR_FGD, -1)
    mask[height * 62 // 100 :, width * 5 // 100 : width * 96 // 100] = cv2.GC_PR_FGD
    cv2.ellipse(mask, center, (width * 13 // 100, height * 21 // 100), 0, 0, 360, cv2.GC_FGD, -1)
    mask[height * 80 // 100 :, width * 30 // 100 : width * 75 // 100] = cv2.GC_FGD
    mask[: height * 4 // 100] = mask[: height // 2, : width * 12 // 100] = cv2.GC_BGD
    mask[: height // 2, width * 88 // 100 :] = cv2.GC_BGD
    models = np.zeros((2, 1, 65))
    bgr = small[..., ::-1].copy()
    cv2.grabCut(bgr, mask, None, models[0], models[1], 6, cv2.GC_INIT_WITH_MASK)
    inside = np.isin(mask, (cv2.GC_FGD, cv2.GC_PR_FGD)).astype(np.uint8)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (15, 15))
    inside = cv2.morphologyEx(
        cv2.morphologyEx(inside, cv2.MORPH_CLOSE, kernel), cv2.MORPH_OPEN, kernel
    )
    return cv2.GaussianBlur(inside.astype(np.float32), (0, 0), 2.0)[..., None]


def lamps(shape: tuple[int, ...]) -> np.ndarray:
    """(H, W, 3) light of small lamps, six to sixty times the photo's white."""
    rng = np.random.default_rng(5)
    light = np.zeros(shape, np.float32)
    for _ in range(64):
        x, y = rng.uniform(0, shape[1]), rng.uniform(0, shape[0] * 0.85)
        color = LAMP_COLORS[rng.choice(4, p=(0.45, 0.35, 0.12, 0.08))] * rng.uniform(6, 60)
        cv2.circle(light, (int(x), int(y)), 3, tuple(map(float, color)), -1)
    return light


def composite(plate: np.ndarray, matte: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Room darkened, lamps added, defocused; her over it; glow. The same for both pictures."""
    empty = cv2.GaussianBlur(plate * (1 - matte), (0, 0), 30) / np.maximum(
        cv2.GaussianBlur(1 - matte, (0, 0), 30)[..., None], 0.02
    )
    room = disk_blur(np.where(matte > 0.02, empty, plate) * ROOM + light, RADIUS)
    over = plate * KEY * matte + room * (1 - matte)
    return (1 - GLOW) * over + GLOW * cv2.GaussianBlur(over, (0, 0), 40)


def main(folder: Path) -> Path:
    photo = read_photo(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False))
    curve = calibrate(photo).curve
    size = (SCALE * photo.encoded.shape[1], SCALE * photo.encoded.shape[0])
    codes = cv2.resize(photo.encoded, size, interpolation=cv2.INTER_CUBIC).clip(0, 1)
    matte = cv2.resize(person(photo.encoded), size)[..., None]
    light = lamps(codes.shape)
    # In code values no lamp can be brighter than white.
    encoded = composite(codes, matte, np.minimum(light, 1.0))
    linear = composite(curve.linearize(codes), matte, light)
    panels = {
        "composited in code values": encoded.clip(0, 1),
        "composited in linear light, by the photo's own curve": curve.encode(linear.clip(0, 1)),
    }
    figure = Figure(figsize=(16, 9.75), facecolor=GROUND)
    figure.subplots_adjust(left=0.003, right=0.997, bottom=0.01, top=0.93, wspace=0.015)
    for axes, (title, image) in zip(figure.subplots(1, len(panels)), panels.items(), strict=True):
        axes.imshow(image)
        axes.set_title(title, color="white", fontsize=19, pad=12)
        axes.axis("off")
    target = folder / "comp.jpg"
    figure.savefig(target, dpi=100, pil_kwargs={"quality": 88, "optimize": True})
    return target


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())))
