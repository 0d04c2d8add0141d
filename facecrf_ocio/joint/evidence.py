"""What one photo says of its camera's response: small enough to keep for every photo of an archive.

The straight line from here: statistics of the photo and its largest face (`statistics.py`), a
message of each cue (`messages.py`), their product with the prior (`fuse.py`, `prior.py`), and the
curve with its band (`conclusion.py`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.no_face import lacking_faces
from facecrf_ocio.face.second_look import NOBODYS, is_nobodys
from facecrf_ocio.face.view import cut_face
from facecrf_ocio.files.threads import OtherThread
from facecrf_ocio.joint.face_parts import odd_parts
from facecrf_ocio.joint.few_levels import few_levels
from facecrf_ocio.joint.messages import Networks, shipped_networks
from facecrf_ocio.joint.metadata import UNTOLD, modern_leaning, phone_leaning
from facecrf_ocio.joint.prior import Message
from facecrf_ocio.joint.single_curve import no_photograph, strange_skin, toned
from facecrf_ocio.joint.statistics import (
    Statistics,
    counted_statistics,
    face_statistics,
    photo_counts,
    skin_counts,
)
from facecrf_ocio.response.coverage import COVERAGE_BINS, coverage_counts
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.values import Face, Float, Lacking, Photo

_COLOR = "use a color version"
_LARGER = "use a larger version of the photo"


@dataclass(frozen=True, slots=True, eq=False)
class PhotoEvidence:
    """The messages of one photo's cues.

    Attributes
    ----------
    messages
        For each cue the photo shows, a Gaussian likelihood over the prior's coefficients.
    coverage
        (3, 64) share of the evidence in each bin of encoded values.
    leaning
        Log odds for a modern response, from what the file says of its camera.
    phone
        Log odds for a phone's among modern ones, from the same.
    stretch
        Factor on the deviation of what follows: above 1 where training saw no such photo.
    lacking, remedy
        Why the photo says nothing, and what the user can do; empty if it does say something.
    camera
        Make and model, as the file names them: what was measured of it is one more message.
    doubt
        What speaks against any single curve of the camera; empty where nothing does.
    adapted
        By what the file says that its camera bent the curve to the scene; see `Photo`.
    face
        The face used, if any; not stored.
    """

    messages: Mapping[str, Message]
    coverage: Float
    leaning: float = UNTOLD
    phone: float = 0.0
    lacking: str = ""
    remedy: str = ""
    stretch: float = 1.0
    camera: tuple[str, str] = ("", "")
    doubt: str = ""
    adapted: tuple[str, ...] = ()
    face: Face | None = field(default=None, repr=False)

    def to_json(self) -> str:
        """As text for a manifest; `from_json` gives back the same numbers."""
        return json.dumps(
            {
                "messages": {
                    cue: [m.mean.tolist(), m.precision.tolist()] for cue, m in self.messages.items()
                },
                "coverage": np.asarray(self.coverage).tolist(),
                "leaning": self.leaning,
                "phone": self.phone,
                "lacking": self.lacking,
                "remedy": self.remedy,
                "stretch": self.stretch,
                "camera": list(self.camera),
                "doubt": self.doubt,
                "adapted": self.adapted,
            }
        )

    @staticmethod
    def from_json(text: str) -> PhotoEvidence:
        """Read what `to_json` wrote.

        Raises
        ------
        SettingsError
            If the text is something else.
        """
        try:
            stored = json.loads(text)
            messages = {
                cue: Message(np.array(mean), np.array(precision))
                for cue, (mean, precision) in stored["messages"].items()
            }
            return PhotoEvidence(
                messages,
                np.array(stored["coverage"]),
                stored["leaning"],
                stored.get("phone", 0.0),
                stored["lacking"],
                stored["remedy"],
                stored.get("stretch", 1.0),
                _named(stored.get("camera", ("", ""))),
                str(stored.get("doubt", "")),
                tuple(map(str, stored.get("adapted", ()))),
            )
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise SettingsError(f"no evidence of a photo: {error}") from error


@typed
def gather(
    photo: Photo, settings: JointSettings | None = None, networks: Networks | None = None
) -> PhotoEvidence:
    """Ask every cue of one photo.

    A photo without a face, or without color, gives evidence without messages that says why.
    """
    networks = networks or shipped_networks()
    leaning = modern_leaning(photo.camera, photo.primaries), phone_leaning(photo.camera)
    seen = observe(photo, settings or JointSettings())
    if isinstance(seen, Lacking):
        nothing = np.zeros((3, COVERAGE_BINS))
        return PhotoEvidence({}, nothing, *leaning, seen.reason, seen.remedy)
    messages = networks.messages(seen.statistics.by_cue)
    stretch = networks.stretch(seen.statistics.by_cue)
    coverage = _histograms(seen.statistics.encoded)
    camera = photo.camera.make, photo.camera.model
    return PhotoEvidence(
        *(messages, coverage, *leaning),
        stretch=stretch,
        camera=camera,
        doubt=seen.doubt,
        adapted=photo.adapted,
        face=seen.face,
    )


def _named(stored: Sequence[str]) -> tuple[str, str]:
    make, model = stored
    return str(make), str(model)


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """What every cue measures in one photo, the face it is measured on, and what is doubtful."""

    statistics: Statistics
    face: Face
    doubt: str = ""


def observe(photo: Photo, settings: JointSettings) -> Observation | Lacking:
    """Statistics of one photo and its largest face, or why there are none."""
    if photo.grayscale:
        return _colorless(photo)
    # The networks that find a face leave a core free for what needs none to be found.
    with OtherThread() as other:
        return _observed(photo, settings, other)


def _observed(photo: Photo, settings: JointSettings, other: OtherThread) -> Observation | Lacking:
    ask_tone = other.begin(partial(toned, photo.pixels, settings))
    count = other.begin(partial(photo_counts, photo.pixels))
    found = find_faces(photo.pixels, settings, most=1)
    if not found.faces:
        return lacking_faces(found, settings)
    face = found.faces[0]
    unfit = no_photograph(photo.pixels, face.box_xy, settings)
    if unfit is not None:
        return unfit
    # The networks know 8-bit photos: rounding is part of the noise they learned from.
    finer = photo.bit_depth != 8
    view = cut_face(photo, face, settings, to_8_bits=finer, other=other)
    ask_levels = other.begin(partial(few_levels, photo.pixels, face.box_xy, settings))
    of_face = face_statistics(view, settings)
    doubts = list(filter(None, [strange_skin(photo.pixels, face.box_xy)]))
    doubts += odd_parts(view, photo.pixels, settings)
    doubts += [NOBODYS] if is_nobodys(photo.pixels, face) else []
    for found_out in (ask_levels(), ask_tone()):
        if isinstance(found_out, Lacking):
            return found_out
        doubts += [found_out] if found_out else []
    if of_face is None:
        return Lacking("the face shows too little skin of one hue", _LARGER)
    of_skin = partial(skin_counts, photo.pixels, view, of_face.skin)
    count_left = other.begin(partial(of_skin, slice(None, None, 2)))
    right = of_skin(slice(1, None, 2))
    counted = counted_statistics(count(), count_left().plus(right))
    of_face = replace(of_face, by_cue={**counted, **of_face.by_cue})
    return Observation(of_face, face, ", ".join(doubts))


def _colorless(photo: Photo) -> Lacking:
    if photo.pixels.min() == photo.pixels.max():
        return Lacking("all pixels have one color", "use a photo with a face")
    return Lacking("the photo is grayscale, and skin shows its response only in color", _COLOR)


def _histograms(encoded: Float) -> Float:
    return np.array([coverage_counts(channel) for channel in encoded.T]) / max(1, len(encoded))
