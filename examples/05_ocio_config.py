"""
A config for two photos
=======================

An OpenColorIO config for two photos, and the one laid over the other by PyOpenColorIO alone.
"""

import tempfile
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.ocio_config import write_config

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for photo, gamma in (("morning.jpg", 2.0), ('it\'s "evening" 100%.jpg', 2.4)):
        curve = np.linspace(0, 1, 4096) ** gamma
        rows = "\n".join(f"{value:.9g}" for value in curve)
        lut = folder / f"{photo}.spi1d"
        lut.write_text(f"Version 1\nFrom 0 1\nLength 4096\nComponents 1\n{{\n{rows}\n}}\n")
    written = write_config([folder], folder / "config.ocio")
    config = ocio.Config.CreateFromFile(str(written[0]))

    def linear(photo: str, code: float) -> np.ndarray:
        """A gray pixel of a photo, whose color space the config finds by the file's name."""
        space, _ = config.getColorSpaceFromFilepath(photo)
        processor = config.getProcessor(space, "scene_linear").getDefaultCPUProcessor()
        return np.array(processor.applyRGB([code] * 3))

    morning = linear("/photos/morning.jpg", 0.5)
    over = 0.5 * morning + (1 - 0.5) * linear('it\'s "evening" 100%.jpg', 0.2)
    display = config.getDefaultDisplay()
    shown = config.getProcessor(
        "scene_linear", display, config.getDefaultView(display), ocio.TRANSFORM_DIR_FORWARD
    )
    code = shown.getDefaultCPUProcessor().applyRGB(list(over))
    print(
        f"0.5 is {morning[0]:.4f} scene-linear; half over the evening it is shown as {code[0]:.4f}"
    )
    assert abs(morning[0] - 0.25) < 1e-6
    light = (0.5**2.0 + 0.2**2.4) / 2
    assert abs(code[0] - (1.055 * light ** (1 / 2.4) - 0.055)) < 1e-5

    # With the variable form there is one color space, and the context names the photo.
    written = write_config([folder], folder / "many.ocio", form="variable")
    config = ocio.Config.CreateFromFile(str(written[0]))
    context = config.getCurrentContext()
    context["FACECRF_PHOTO"] = "morning.jpg"
    chosen = config.getProcessor(context, "facecrf_photo", "scene_linear")
    assert abs(chosen.getDefaultCPUProcessor().applyRGB([0.5] * 3)[0] - 0.25) < 1e-6
