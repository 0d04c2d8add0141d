"""The refusal of a photo without a face that can be used."""

from __future__ import annotations

from facecrf_ocio.face.detect import FoundFaces
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Lacking


def lacking_faces(found: FoundFaces, settings: FaceSettings) -> Lacking:
    """Why no face of a photo can be used."""
    if found.too_small:
        return Lacking(
            f"{count_faces(found.too_small)} found, narrower than {settings.min_face_width} px",
            "use a larger version of the photo",
        )
    return Lacking("no face found", "use a photo with a face")


def count_faces(count: int) -> str:
    """As words."""
    return "1 face" if count == 1 else f"{count} faces"
