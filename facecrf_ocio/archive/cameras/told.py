"""What a photo said, as it is stored and as it is read again."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from facecrf_ocio.archive.task import Gathered
from facecrf_ocio.joint import PhotoEvidence
from facecrf_ocio.values import Face


def face_json(evidence: PhotoEvidence) -> str:
    """Box and score of the face that evidence comes from, which its own JSON leaves out."""
    face = evidence.face
    return "" if face is None else json.dumps([*face.box_xy.tolist(), face.score])


def told_before(gathered: Gathered) -> PhotoEvidence:
    """The evidence that a photo gave before, with its face, but without the face's landmarks."""
    evidence = PhotoEvidence.from_json(gathered.evidence)
    if not gathered.face:
        return evidence
    *box, score = json.loads(gathered.face)
    return replace(evidence, face=Face(np.array(box), np.empty((0, 3)), score))
