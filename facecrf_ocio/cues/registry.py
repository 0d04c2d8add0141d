"""The cues by the names users call them by."""

from __future__ import annotations

from facecrf_ocio.cues.edge import edge_cue
from facecrf_ocio.cues.evidence import Cue
from facecrf_ocio.cues.face import face_cue
from facecrf_ocio.cues.geometry_invariant import geometry_invariant_cue
from facecrf_ocio.cues.intensity_similarity import intensity_similarity_cue
from facecrf_ocio.cues.rank import rank_cue

CUES: dict[str, Cue] = {
    "face": face_cue(shaded=True),
    "face-unshaded": face_cue(shaded=False),
    "edge": edge_cue,
    "geometry-invariant": geometry_invariant_cue,
    "intensity-similarity": intensity_similarity_cue,
    "rank": rank_cue,
}
