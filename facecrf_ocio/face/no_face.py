"""The refusal of a photo without a face that can be used."""

from __future__ import annotations

from facecrf_ocio.face.detect import FoundFaces
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Lacking


def lacking_faces(found: FoundFaces, settings: FaceSettings) -> Lacking:
    """Why no face of a photo can be used."""
    if found.too_small:
        return Lacking(
            f"{counted(found.too_small, 'face')} found, narrower than {settings.min_face_width} px",
            "use a larger version of the photo",
        )
    if found.turned_away:
        seen = counted(found.turned_away, "head")
        return Lacking(
            f"no face found that can be measured: {seen} turned away, covered or blurred",
            "use a photo that shows a face from the front",
        )
    return Lacking("no face found", "use a photo with a face")
