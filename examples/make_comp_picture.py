"""Draw examples/images/comp.png: defocus and exposure, in code values and in linear light.

`python examples/make_comp_picture.py [FOLDER]`. The photo is matplotlib's portrait of Grace Hopper
(US Navy, public domain). Four small lamps, eight times as bright as the photo's white, are added to
the linear photo; in the encoded one they can be no brighter than white. Both are then defocused by
a round aperture and underexposed by two stops, as a camera would, and shown with the photo's curve.
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

RADIUS = 9  # of the aperture's disk, pixels
STOPS = -2.0
LAMPS = ((90, 60), (70, 430), (210, 470), (230, 40))
LAMP_LIGHT = 8.0  # photo's white is 1


def defocused(image: np.ndarray) -> np.ndarray:
    """Convolve with a disk, which is what a lens out of focus does to light."""
    y, x = np.mgrid[-RADIUS : RADIUS + 1, -RADIUS : RADIUS + 1]
    disk = (x**2 + y**2 <= RADIUS**2).astype(np.float32)
    return cv2.filter2D(image, -1, disk / disk.sum(), borderType=cv2.BORDER_REPLICATE)


def with_lamps(image: np.ndarray, light: float) -> np.ndarray:
    lit = image.copy()
    for row, column in LAMPS:
        cv2.circle(lit, (column, row), 3, (light, light, light), -1)
    return lit


def main(folder: Path) -> Path:
    photo = read_photo(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False))
    curve = calibrate(photo).curve
    codes = np.array(photo.encoded, np.float32)
    linear = with_lamps(curve.linearize(codes), LAMP_LIGHT)
    codes = with_lamps(codes, 1.0)
    gain = 2.0**STOPS
    panels = {
        "photo with four lamps": codes,
        "defocus in code values": defocused(codes),
        "defocus in linear light": curve.encode(np.clip(defocused(linear), 0, 1)),
        "... two stops down, code values": defocused(codes) * gain,
        "... two stops down, linear light": curve.encode(np.clip(defocused(linear) * gain, 0, 1)),
    }
    figure = Figure(figsize=(15, 2.75), layout="constrained")
    for axes, (title, image) in zip(figure.subplots(1, len(panels)), panels.items(), strict=True):
        axes.imshow(image[:420])
        axes.set_title(title)
        axes.axis("off")
    target = folder / "comp.png"
    figure.savefig(target, dpi=90, bbox_inches="tight")
    return target


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())))
