"""Gaffer: a photo and its LUT as two linked nodes. Run it in the Python Editor, then call it.

Example: `linearize_photo(root, "/photos/a.jpg", "/luts/a.jpg.spi1d")`.
"""

import GafferImage


def linearize_photo(parent, photo, lut):
    """Add the nodes to `parent` and return the one whose output is scene-linear."""
    read = GafferImage.ImageReader("Photo")
    read["fileName"].setValue(photo)
    # The working space as the file's own: the reader passes the code values on as they are.
    read["colorSpace"].setValue("scene_linear")
    curve = GafferImage.LUT("LinearizePhoto")
    curve["in"].setInput(read["out"])
    curve["fileName"].setValue(lut)
    curve["interpolation"].setValue(GafferImage.LUT.Interpolation.Linear)
    parent.addChild(read)
    parent.addChild(curve)
    return curve
