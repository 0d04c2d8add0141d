"""
One photo
=========

Estimate its curve, write it for OCIO, and look at what it makes of middle gray.
"""

import textwrap
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.cbook
import numpy as np

from facecrf_ocio import calibrate, read_photo, write_lut

portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
photo = read_photo(portrait)
estimate = calibrate(photo)

print(estimate)
print(*textwrap.wrap(estimate.summary, 72), sep="\n")

code_118 = np.full((1, 3), 118 / 255)  # what sRGB calls middle gray, 18 % of white
print("code 118 is linear", estimate.curve.linearize(code_118)[0].round(3))

print(write_lut(estimate.curve, Path(mkdtemp()) / "grace_hopper.spi1d"))

# %%
# In a notebook an estimate shows what to expect of it, and its curve with the 90 % band.
estimate
