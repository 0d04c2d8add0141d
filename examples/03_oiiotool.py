"""
oiiotool
========

A photo through its LUT into an EXR, as a shell script would do it.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio import calibrate, read_photo, write_lut

beside = Path(sys.executable).parent / "oiiotool"  # the OpenImageIO wheel brings it
oiiotool = str(beside) if beside.is_file() else shutil.which("oiiotool")
if oiiotool is None:
    print("skipped: there is no oiiotool here")
    sys.exit()

portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
photo = read_photo(portrait)
curve = calibrate(photo).curve
with tempfile.TemporaryDirectory() as folder:
    lut, exr = write_lut(curve, Path(folder) / "a.spi1d"), Path(folder) / "a.exr"
    # The tag is ours to set: after a LUT, oiiotool still says that the pixels are sRGB, and a
    # --tocolorspace behind it would linearize them a second time.
    known = photo.primaries is not None and photo.primaries.name == "Rec.709"
    tag = ["--iscolorspace", "lin_rec709_scene" if known else "unknown"]
    convert = ["-d", "float", "--ociofiletransform", lut, *tag, "-o", exr]
    subprocess.run([oiiotool, portrait, *convert], check=True)
    written = oiio.ImageBuf(str(exr))
    pixels = written.get_pixels(oiio.FLOAT)
    print("tagged", written.spec().get_string_attribute("oiio:ColorSpace"))
difference = np.abs(pixels - curve.linearize(photo.encoded)).max()
print(f"oiiotool and this package differ by {difference:.1e} at most")
assert difference < 1e-6
