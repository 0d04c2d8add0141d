"""What a run over an archive is asked, and what it tells of each photo."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from facecrf_ocio.archive.manifest.database import DONE
from facecrf_ocio.archive.task import Recipe, Result
from facecrf_ocio.archive.work.cluster import Cluster
from facecrf_ocio.archive.work.processes import Limits

REOPENED, BRACKET = "reopened", "bracket"


@dataclass(frozen=True, slots=True)
class Job:
    """What is asked of a run.

    Attributes
    ----------
    source, folder
        Root of the photos, and of the outputs.
    recipe
        How to treat each photo.
    jobs, limits
        Number of worker processes, and what one photo may cost.
    overwrite
        Replace files that are not outputs of this archive.
    retry
        Try photos again that failed before, though nothing changed.
    cluster
        Work there instead of in processes of this machine; `jobs` is without effect then.
    again
        Photos whose outputs are to be made again though they look as they were written. If there
        are any, nothing is found out of others.
    """

    source: Path
    folder: Path
    recipe: Recipe
    jobs: int = 1
    limits: Limits = field(default_factory=Limits)
    overwrite: bool = False
    retry: bool = False
    cluster: Cluster | None = None
    again: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Event:
    """Something came of a photo.

    Attributes
    ----------
    name, result
        The photo, and what came of it.
    fresh
        False if it was done by an earlier run.
    step
        `DONE`: it is accounted for. `GATHERED`: its evidence is known. `REOPENED`: it was accounted
        for, with this result, and is now written again with another curve of its camera.
        `BRACKET`: of the bracket that begins with it; the outcome is `merged`, `not merged` or
        `failed`.
    """

    name: str
    result: Result
    fresh: bool
    step: str = DONE
