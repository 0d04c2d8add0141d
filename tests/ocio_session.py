"""Run by a host's own Python, which has OpenColorIO and not even numpy.

`ocio_session.py PIXELS OUTPUT LUT...`: float32 RGB triples through each LUT, one after the other.
"""

import sys
from array import array
from pathlib import Path

import PyOpenColorIO as ocio  # noqa: N813

codes, output, luts = Path(sys.argv[1]).read_bytes(), Path(sys.argv[2]), sys.argv[3:]
with output.open("wb") as file:
    for lut in luts:
        transform = ocio.FileTransform(src=lut, interpolation=ocio.INTERP_LINEAR)
        pixels = array("f", codes)
        processor = ocio.Config.CreateRaw().getProcessor(transform)
        processor.getDefaultCPUProcessor().applyRGB(pixels)
        file.write(pixels.tobytes())
print(ocio.GetVersion())
