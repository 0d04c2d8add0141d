"""
A config for two photos
=======================

An OpenColorIO config for two photos, and a pixel sent through it.
"""

import tempfile
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.ocio_config import write_config

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for photo, gamma in (("morning", 2.0), ('it\'s "evening" 100%', 2.4)):
        curve = np.linspace(0, 1, 4096) ** gamma
        rows = "\n".join(f"{value:.9g}" for value in curve)
        lut = folder / f"{photo}.spi1d"
        lut.write_text(f"Version 1\nFrom 0 1\nLength 4096\nComponents 1\n{{\n{rows}\n}}\n")
    written = write_config([folder], folder / "config.ocio")
    config = ocio.Config.CreateFromFile(str(written[0]))
    space, _ = config.getColorSpaceFromFilepath("/photos/morning.jpg")
    pixel = config.getProcessor(space, "lin_rec709").getDefaultCPUProcessor().applyRGB([0.5] * 3)
    print(f"{space}: 0.5 is {pixel[0]:.4f} scene-linear")
    assert abs(pixel[0] - 0.25) < 1e-6
