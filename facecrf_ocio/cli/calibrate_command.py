"""`facecrf calibrate`: photos in, LUT files out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.choices import Choices
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import PHOTO_PATH, direction_options, estimation_options
from facecrf_ocio.cli.output_files import OutputFiles, folder_option, formats_option
from facecrf_ocio.cli.terminal import (
    DONE,
    FAILED,
    NOTHING,
    UNREADABLE,
    USAGE,
    complain,
    ending_well,
    exit_code_of,
    problem_of,
    require_writable,
    say,
)
from facecrf_ocio.cli.told_estimates import tell, tell_details, tell_estimate, tell_json
from facecrf_ocio.errors import FaceCRFError, LutError, OutputError
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.record.output_names import PLOT

if TYPE_CHECKING:
    from facecrf_ocio.together import Together
    from facecrf_ocio.values import Estimate, Photo


@dataclass(frozen=True, slots=True)
class _Calibration:
    """What is to be written of each photo, and how it is told."""

    outputs: OutputFiles
    as_json: bool
    choices: Choices
    together: Together | None = None

    def run(self, path: Path, message: str) -> int:
        """Calibrate one photo, tell of it, and return its exit code."""
        try:
            with status(message):
                photo, estimate, written = self._calibrate(path)
        except Exception as error:  # whatever a library raises costs this photo, not the others
            named = problem_of(error)
            foreseen = isinstance(error, FaceCRFError | MemoryError)
            named = named if foreseen else f"{path}: {named}"
            code = complain(named, exit_code_of(error) if foreseen else UNREADABLE)
            if self.as_json:
                tell_json(path, code, outcome="error", reason=named)
            return code
        options = {"as_json": self.as_json, "verbose": self.choices.verbose}
        shared = self.together is not None
        return tell(path, estimate, written, notes=photo.notes, told_before=shared, **options)

    def _calibrate(self, path: Path) -> tuple[Photo, Estimate, tuple[Path, ...]]:
        self.outputs.require_free(path)
        if self.together is None:
            photo, estimate = self.choices.read_and_estimate(path)
        else:
            from facecrf_ocio import read_photo

            photo, estimate = read_photo(path), self.together.estimate
        if estimate.found is None:
            return photo, estimate, ()
        written = self.outputs.write(path, photo, estimate, self.choices.settings)
        return photo, estimate, written


def _estimate_together(photos: tuple[Path, ...], choices: Choices) -> Together:
    """One curve of all photos; those that do not fit it are told on stderr."""
    from facecrf_ocio.together import MISFIT_LIMIT

    with status(f"calibrating {len(photos)} photos together"):
        together = choices.estimate_together(photos)
    for path, misfit, lacking in zip(photos, together.misfits, together.lacking, strict=True):
        if lacking:
            say(f"facecrf: {path}: says nothing: {lacking}", err=True)
        elif misfit > MISFIT_LIMIT:
            say(
                f"facecrf: {path}: its own evidence lies {misfit:.1f} standard deviations from "
                "the common curve; it may have another picture style",
                err=True,
            )
    return together


@click.command()
@click.argument("photos", nargs=-1, required=True, type=PHOTO_PATH)
@folder_option
@formats_option
@direction_options
@click.option(
    "--plot", is_flag=True, help=f"Also write NAME{PLOT}: curves, skin mask, pigment map."
)
@click.option(
    "--together", is_flag=True, help="One curve from all photos, which one camera took alike."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per photo and line.")
@estimation_options
@ending_well
def calibrate(
    photos: tuple[Path, ...],
    output: Path,
    formats: tuple[str, ...],
    direction: str,
    space: str | None,
    plot: bool,
    as_json: bool,
    together: bool,
    **choices: Any,
) -> int:
    """Estimate the inverse camera response of each PHOTO and write it as LUT files.

    The folder, made if it is missing, gets the photo's name with .spi1d, .cube, .clf and
    .crf.json behind it: a.jpg.spi1d and so on.
    """
    from facecrf_ocio.record.outputs import require_distinct_names

    photos = tuple(dict.fromkeys(photos))
    try:
        require_distinct_names(photos)
        outputs = OutputFiles.asked(
            output, formats, direction, space, plot=plot, overwrite=choices["overwrite"]
        )
    except (OutputError, LutError) as error:
        return complain(str(error), USAGE)
    require_writable(output)
    chosen = Choices(**choices)
    shared = _estimate_together(photos, chosen) if together else None
    if shared is not None and shared.estimate.found is not None and not as_json:
        tell_estimate(f"{counted(len(photos), 'photo')} together", shared.estimate)
        if chosen.verbose:
            tell_details(shared.estimate)
    job = _Calibration(outputs, as_json, chosen, shared)
    codes = []
    for number, path in enumerate(photos, start=1):
        place = f" ({number} of {len(photos)})" if len(photos) > 1 else ""
        codes.append(job.run(path, f"calibrating {path}{place}"))
    return next((code for code in (FAILED, UNREADABLE, NOTHING) if code in codes), DONE)
