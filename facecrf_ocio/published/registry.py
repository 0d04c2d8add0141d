"""The cues by the names users call them by."""

from __future__ import annotations

from facecrf_ocio.published.answer import Cue
from facecrf_ocio.published.edge import edge_cue
from facecrf_ocio.published.face_estimator import face_cue
from facecrf_ocio.published.geometry_invariant import geometry_invariant_cue
from facecrf_ocio.published.intensity_similarity import intensity_similarity_cue
from facecrf_ocio.published.rank import rank_cue

CUES: dict[str, Cue] = {
    "face": face_cue(shaded=True),
    "face-unshaded": face_cue(shaded=False),
    "edge": edge_cue,
    "geometry-invariant": geometry_invariant_cue,
    "intensity-similarity": intensity_similarity_cue,
    "rank": rank_cue,
}
