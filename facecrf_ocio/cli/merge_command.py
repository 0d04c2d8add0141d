"""`facecrf merge`: exposures of one scene in, one scene-linear EXR of all its light out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from facecrf_ocio.cli.bracket_command import solve, stops_option
from facecrf_ocio.cli.linearize_command import require_exr_free, with_remedy
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import PHOTO_PATH, exr_options
from facecrf_ocio.cli.terminal import NOTHING, complain, ending_well, say
from facecrf_ocio.cli.told_estimates import tell_notes
from facecrf_ocio.errors import in_options

if TYPE_CHECKING:
    from facecrf_ocio.pair.calibrate_bracket import BracketEstimate
    from facecrf_ocio.values import Estimate

# Share of a photo that moved: of a still scene less than 0.01, of one with people less than half.
_ANOTHER_SCENE = 0.5


@click.command()
@click.argument("photos", nargs=-1, required=True, type=PHOTO_PATH, metavar="BRACKET...")
@exr_options("OUT.exr")
@stops_option
@click.option(
    "--curve",
    "source",
    default="auto",
    show_default=True,
    metavar="HOW",
    help="bracket: its own; faces: estimated from faces in it; a file: a record's (.crf.json) or a "
    "1-D LUT's; auto: the bracket's if it tells, else the faces'.",
)
@click.option("--still", is_flag=True, help="Nothing moved: use all photos everywhere.")
@click.option("--overwrite", is_flag=True, help="Replace an existing EXR.")
@ending_well
def merge(
    photos: tuple[Path, ...],
    output: Path,
    half: bool,
    compression: str,
    given: str | None,
    source: str,
    still: bool,
    overwrite: bool,
) -> int:
    """Merge exposures of one scene into one scene-linear EXR.

    Photos are aligned, exposures by EXIF are refined by the pixels, noise decides how much each
    counts, and what moved is taken from the photo that shows most. 1 is that photo's white.
    """
    from facecrf_ocio.image.merged_exr import write_merged
    from facecrf_ocio.pair.merge_exposures import merge_exposures

    require_exr_free(output, overwrite=overwrite)
    photos = tuple(dict.fromkeys(photos))
    with status(f"merging {len(photos)} photos"):
        solved = solve(photos, given)
        if solved.wrong_order:
            told = in_options(solved.wrong_order)
            return complain(f"{photos[0]}: not merged: {told}", NOTHING)
        estimate = _curve(source, photos, solved)
        if estimate.found is None:
            told = in_options(f"{estimate.reason}; {estimate.remedy}")
            return complain(f"{photos[0]}: {estimate.outcome}: {told}", NOTHING)
        exposures = merge_exposures(solved, estimate.found)
        false = in_options(f"{exposures.false}; {exposures.remedy}") if exposures.false else ""
        merged = write_merged(
            output,
            exposures.bracket,
            estimate,
            still=still,
            half=half,
            compression=compression,
            overwrite=overwrite,
        )
    say(f"{output}: {len(photos)} exposures, curve by {estimate.estimator}")
    tell_notes(with_remedy(merged.notes))
    for path, stop, gone in zip(photos, merged.stops, merged.moved, strict=True):
        say(f"  {path.name}: {stop:+.2f} stops, {100.0 * gone:.1f} % moved")
    if false:
        say(f"facecrf: {output}: {false}", err=True)
        return 0
    for path, gone in zip(photos, merged.moved, strict=True):
        if gone > _ANOTHER_SCENE:
            say(
                f"facecrf: {path}: {100.0 * gone:.0f} % of it disagrees with the others: another "
                "scene, or not the exposure that its EXIF tells; merge without it, or give --stops",
                err=True,
            )
    return 0


def _curve(source: str, photos: tuple[Path, ...], solved: BracketEstimate) -> Estimate:
    """The curve that was asked for, as an estimate; without one, why."""
    from facecrf_ocio import calibrate_together, read_photo
    from facecrf_ocio.values import Outcome

    if source not in ("auto", "bracket", "faces"):
        return _of_file(Path(source))
    if source == "bracket" or (source == "auto" and solved.estimate.found is not None):
        return solved.estimate
    estimate = calibrate_together(read_photo(path) for path in photos).estimate
    if estimate.outcome is Outcome.FALLBACK:
        return replace(
            solved.estimate if source == "auto" else estimate,
            outcome=Outcome.NOT_CALIBRATED,
            remedy="give a record or a LUT of this camera: --curve FILE",
            found=None,
        )
    return estimate


def _of_file(path: Path) -> Estimate:
    """The curve of a record, or of a LUT, which tells of no band."""
    from facecrf_ocio.files.plain_text import plain_text
    from facecrf_ocio.image.lut_curve import curve_of_lut
    from facecrf_ocio.record.calibration_record import read_record
    from facecrf_ocio.values import Estimate, Outcome

    if path.suffix.lower() == ".json":
        return read_record(path).estimate
    by = f"the LUT {plain_text(path.name)}"
    return Estimate(Outcome.CALIBRATED, by, "as it is", found=curve_of_lut(path))
