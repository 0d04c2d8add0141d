"""
OpenImageIO node
================

An ImageBuf through a photo's LUT, half-float out; without a profile its primaries are unknown.
"""

import sys
import tempfile
from pathlib import Path

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio import calibrate, read_photo, write_lut

sys.path.insert(0, str(Path(__file__).parents[1] / "nodes" / "oiio"))  # or pip install nodes/oiio
from facecrf_oiio import linearize

portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
photo = read_photo(portrait)
curve = calibrate(photo).curve
with tempfile.TemporaryDirectory() as folder:
    lut = write_lut(curve, Path(folder) / "grace_hopper.spi1d")
    linear = linearize(oiio.ImageBuf(str(portrait)), str(lut))
print(linear.spec().format, linear.spec().get_string_attribute("oiio:ColorSpace"))
expected = curve.linearize(photo.encoded).astype(np.float16).astype(np.float32)
difference = np.abs(linear.get_pixels(oiio.FLOAT) - expected).max()
print(f"the node and this package differ by {difference:.1e} at most")
assert difference <= 2.0**-11  # one step of half floats near white
