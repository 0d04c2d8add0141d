"""What is to be done with one photo, and what came of it: small, frozen, picklable."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

from facecrf_ocio.archive.place import Place
from facecrf_ocio.cameras.known_cameras import KnownCamera
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.lut.format_table import default_formats
from facecrf_ocio.photo.shot import Shot
from facecrf_ocio.record.output_names import EXR, HDR, RECORD, output_name
from facecrf_ocio.settings import VERDICTS, Settings
from facecrf_ocio.values import Estimate

WHOLE, GATHER, WRITE, MERGE = "whole", "gather", "write", "merge"


@dataclass(frozen=True, slots=True)
class Recipe:
    """How every photo of an archive is treated; a change of it makes outputs out of date.

    Attributes
    ----------
    estimator, fallback, prior, settings
        As `calibrate` takes them.
    min_confidence
        Verdict below which a curve is not written.
    formats
        LUT formats to write.
    exr
        Write a scene-linear OpenEXR too.
    pool
        One curve for all photos of a camera, estimator `auto` or `joint`.
    max_error
        [stop] Expected error above which a curve is not written; None for any.
    exposure
        Of the EXRs, as `find_exposure` takes it.
    merge
        Merge each bracket to one image. No photo is treated otherwise for it.
    compression
        Of the EXRs, as `write_exr` takes it.
    """

    estimator: str = "auto"
    fallback: str = "none"
    prior: str = "auto"
    min_confidence: str = VERDICTS[0]
    settings: Settings = field(default_factory=Settings)
    formats: tuple[str, ...] = field(default_factory=default_formats)
    exr: bool = False
    pool: bool = False
    max_error: float | None = None
    exposure: str = "0"
    merge: bool = False
    compression: str = COMPRESSION

    def to_json(self) -> str:
        """All of it, as the manifest keeps it."""
        return json.dumps(asdict(self), sort_keys=True)

    @classmethod
    def from_json(cls, text: str) -> Recipe:
        """The recipe that `to_json` wrote; ValueError or TypeError if none did."""
        record = json.loads(text)
        told = {"settings": Settings(**record["settings"]), "formats": tuple(record["formats"])}
        return cls(**{**record, **told})

    def sha256(self, version: str) -> str:
        """Hash of everything a result depends on besides the photo, `version` included.

        A recipe as it was before there were compressions to choose has the hash that it had.
        """
        told = asdict(self)
        del told["merge"]
        if not self.exr or self.compression == COMPRESSION:
            del told["compression"]
        text = json.dumps({"recipe": told, "version": version}, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Gathered:
    """What a photo says of its camera's curve.

    Attributes
    ----------
    evidence
        `PhotoEvidence.to_json`.
    face
        JSON: x, y, width, height [px] and score of the face it comes from; empty without one.
    samples
        See `pair/code_samples.py`.
    """

    evidence: str
    face: str = ""
    samples: bytes = b""


@dataclass(frozen=True, slots=True)
class Series:
    """The photos of a bracket, as they are to be merged.

    Attributes
    ----------
    paths, sha256
        Their files, and the hashes of these.
    stops
        Their exposures.
    center_only
        Whether f-numbers differ, as `flat_patches` takes it.
    """

    paths: tuple[Path, ...]
    sha256: tuple[str, ...]
    stops: tuple[float, ...]
    center_only: bool


@dataclass(frozen=True, slots=True)
class Task:
    """One photo to be worked on.

    Attributes
    ----------
    source
        The photo's file.
    name
        Its path relative to the archive, with slashes.
    place
        Root of the outputs.
    recipe
        How to treat it.
    overwrite
        Whether outputs that exist may be replaced.
    step
        `whole`: read, calibrate, write. `gather`: read, and give back the evidence of a photo that
        can be pooled; do the whole with any other. `write`: read, and write with the curve below.
        `merge`: merge the bracket that begins with the photo by the curve below.
    sha256
        Of the photo that the curve is for; another one is a failure. Empty if it does not matter.
    estimate
        To be written; without assumptions it gets those of the photo.
    gathered
        What the photo said before; the curve to be written is then estimated from it.
    cameras
        The user's own measured cameras; None for those of the machine that does the work.
    series
        The bracket.
    """

    source: Path
    name: str
    place: Place
    recipe: Recipe
    overwrite: bool = False
    step: str = WHOLE
    sha256: str = ""
    estimate: Estimate | None = None
    gathered: Gathered | None = None
    cameras: tuple[KnownCamera, ...] | None = None
    series: Series | None = None

    @property
    def planned(self) -> tuple[str, ...]:
        """Outputs relative to the place: a.jpg gets a.jpg.cube, so that a.png gets others."""
        if self.step == MERGE:
            return (output_name(self.name, HDR),)
        suffixes = [*self.recipe.formats, RECORD, *((EXR,) if self.recipe.exr else ())]
        return tuple(output_name(self.name, suffix) for suffix in suffixes)


@dataclass(frozen=True, slots=True)
class Output:
    """A written file: path relative to the folder of outputs, bytes, hash, and when [ns]."""

    name: str
    size: int
    sha256: str
    written_ns: int = field(default=0, compare=False)


@dataclass(frozen=True, slots=True)
class Timing:
    """[s] What one photo took."""

    read: float = 0.0
    estimate: float = 0.0
    write: float = 0.0


@dataclass(frozen=True, slots=True)
class Thumbnail:
    """A photo as WebP, upright, as it is and by its curve; what there is none of is empty."""

    before: bytes
    after: bytes = b""


@dataclass(frozen=True, slots=True)
class Result:
    """What came of one photo.

    Attributes
    ----------
    outcome
        One of `values.Outcome`, or `failed`.
    verdict
        One of `values.Verdict`, empty without a curve.
    estimator, reason, remedy
        As in `values.Estimate`; for a failure, its reason.
    sha256
        Of the photo's bytes; empty if they could not be read.
    camera
        Make, model, serial number and software, as the file says.
    outputs
        What was written.
    timing
        What it took.
    shot
        What EXIF tells of the exposure, if evidence was gathered.
    gathered
        What the photo says, if nothing was written yet; `outcome` is empty then.
    stop
        Why the run cannot go on (a full disk), else empty; such a photo is not done.
    lasting
        False for a failure that is not the photo's: every run tries it anew.
    merged
        Of each photo of a bracket, its stops relative to the one that the image shows, and the
        share of its pixels that moved.
    thumbnail
        For the report; None where the photo was not looked at, empty where none could be made.
    summary
        What the report tells of the record; empty without one.
    """

    outcome: str
    verdict: str = ""
    estimator: str = ""
    reason: str = ""
    remedy: str = ""
    sha256: str = ""
    camera: tuple[str, str, str, str] = ("", "", "", "")
    outputs: tuple[Output, ...] = ()
    timing: Timing = Timing()
    shot: Shot = field(default_factory=Shot)
    gathered: Gathered | None = None
    stop: str = ""
    lasting: bool = True
    merged: tuple[tuple[float, float], ...] = ()
    thumbnail: Thumbnail | None = None
    summary: str = ""


FAILED = "failed"
MERGED, NOT_MERGED = "merged", "not merged"
"""Outcomes of a bracket that was to be merged."""
