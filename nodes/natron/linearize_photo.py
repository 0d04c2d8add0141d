"""Natron: a photo and its LUT as two linked nodes. Run it in the Script Editor, then call it.

Example: `linearize_photo(app, "/photos/a.jpg", "/luts/a.jpg.spi1d")`.
"""


def linearize_photo(app, photo, lut):
    """Return the node whose output is scene-linear."""
    read = app.createReader(photo)
    # "Linear" to "Linear": the reader passes the code values on as they are.
    read.getParam("ocioInputSpace").setValue("scene_linear")
    curve = app.createNode("fr.inria.openfx.OCIOFileTransform")
    curve.setLabel("Linearize Photo")
    curve.getParam("file").setValue(lut)
    curve.connectInput(0, read)
    return curve
