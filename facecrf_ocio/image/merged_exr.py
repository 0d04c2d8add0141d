"""A bracket and a curve in, one tagged scene-linear EXR out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from facecrf_ocio import __version__
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.image.apply import write_exr
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.pair.bracket_pixels import SmallBracket
from facecrf_ocio.pair.merge import merge_bracket
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Estimate, Float


@dataclass(frozen=True, slots=True, eq=False)
class MergedFile:
    """What became of each photo of a bracket.

    Attributes
    ----------
    stops
        (J,) exposures relative to the reference, as the pixels have them.
    moved
        Share of each photo's pixels that was set aside as moved.
    notes
        As `WrittenExr` has them.
    """

    stops: Float
    moved: tuple[float, ...]
    notes: tuple[str, ...] = ()


def write_merged(
    path: Path,
    bracket: SmallBracket,
    estimate: Estimate,
    *,
    still: bool = False,
    half: bool = True,
    compression: str = COMPRESSION,
    overwrite: bool = False,
    most_moved: float = 1.0,
) -> MergedFile:
    """Merge the photos of a bracket, read again in full size, and write the light.

    Parameters
    ----------
    path
        The EXR.
    bracket
        Its `stops` as they are to be used.
    estimate
        With a curve.
    still, half, compression, overwrite
        As `merge_bracket` and `write_exr` take them.
    most_moved
        Share of a photo's pixels that may show something else.

    Raises
    ------
    OutputError
        If the EXR cannot be written.
    PhotoError
        If a photo cannot be read, or more of it moved than may.
    """
    merged = merge_bracket(
        lambda index: read_photo(bracket.paths[index]),
        bracket,
        estimate.curve,
        sigma=estimate.confidence.sigma if estimate.confidence else None,
        still=still,
    )
    worst = int(np.argmax(merged.moved))
    if merged.moved[worst] > most_moved:
        raise PhotoError(
            bracket.paths[worst],
            f"shows something else than the bracket in {100.0 * merged.moved[worst]:.0f} % of it",
            "merge those of one scene by hand: facecrf merge",
        )
    relative = bracket.stops - bracket.stops[bracket.reference]
    listed = ", ".join(
        f"{plain_text(p.name)} {s:+.2f}" for p, s in zip(bracket.paths, relative, strict=True)
    )
    written = write_exr(
        path,
        merged.linear,
        replace(merged.reference, alpha=None),
        provenance={
            "outcome": str(estimate.outcome),
            "estimator": estimate.estimator,
            "bracket": listed,
            "version": __version__,
        },
        half=half,
        compression=compression,
        overwrite=overwrite,
    )
    return MergedFile(relative, merged.moved, written.notes)
