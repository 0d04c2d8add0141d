"""
ICC profiles
============

A photo through its input profile to linear light, by littleCMS in Pillow.
"""

import tempfile
from pathlib import Path

import matplotlib.cbook
import numpy as np
from PIL import Image, ImageCms

from facecrf_ocio import calibrate, read_photo
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF

photo = read_photo(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False))
curve = calibrate(photo).curve
straight = InverseCRF(np.array([0.0, 1.0]), np.array([[0.0, 1.0]] * 3))
with tempfile.TemporaryDirectory() as folder:
    source = write_lut(curve, Path(folder) / "photo.icc", primaries=photo.primaries)
    linear = write_lut(straight, Path(folder) / "linear.icc", primaries=photo.primaries)
    image = Image.fromarray(np.rint(photo.encoded * 255).astype(np.uint8))
    converted = ImageCms.profileToProfile(
        image, str(source), str(linear), ImageCms.Intent.RELATIVE_COLORIMETRIC
    )
difference = np.abs(np.asarray(converted) / 255 - curve.linearize(photo.encoded)).max() * 255
print(f"littleCMS and this package differ by {difference:.2f} of 255 at most")
assert difference < 1.0  # half a step is the rounding to the 8 bits that Pillow takes
