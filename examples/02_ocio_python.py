"""
OpenColorIO in Python
=====================

A photo's LUT in a FileTransform, applied to the whole photo.
"""

import tempfile
from pathlib import Path

import matplotlib.cbook
import numpy as np
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio import calibrate, read_photo, write_lut

photo = read_photo(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False))
curve = calibrate(photo).curve
with tempfile.TemporaryDirectory() as folder:
    lut = write_lut(curve, Path(folder) / "grace_hopper.clf")
    transform = ocio.FileTransform(str(lut), interpolation=ocio.INTERP_LINEAR)
    processor = ocio.Config.CreateRaw().getProcessor(transform).getDefaultCPUProcessor()

pixels = np.array(photo.encoded, np.float32, order="C")  # changed in place
processor.applyRGB(pixels)
difference = np.abs(pixels - curve.linearize(photo.encoded)).max()
print(f"OpenColorIO {ocio.GetVersion()} and this package differ by {difference:.1e} at most")
assert difference < 1e-6
