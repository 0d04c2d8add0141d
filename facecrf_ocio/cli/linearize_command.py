"""`facecrf linearize`: photos in, scene-linear EXRs out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.choices import Choices
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import (
    PHOTO_PATH,
    estimation_options,
    exposure_option,
    exr_options,
    space_option,
)
from facecrf_ocio.cli.terminal import (
    DONE,
    FAILED,
    NOTHING,
    UNREADABLE,
    complain,
    ending_well,
    exit_code_of,
    one_line,
    problem_of,
    require_writable,
    say,
)
from facecrf_ocio.cli.told_estimates import tell, tell_notes
from facecrf_ocio.errors import OutputError, SettingsError
from facecrf_ocio.record.output_names import EXR, names_exr, output_path, require_exr_name

if TYPE_CHECKING:
    from facecrf_ocio.image.apply import WrittenExr
    from facecrf_ocio.values import Photo


@click.command()
@click.argument("photos", nargs=-1, required=True, type=PHOTO_PATH, metavar="PHOTO...")
@exr_options("OUT.exr|DIR")
@space_option("the EXR is tagged as such")
@click.option(
    "--hdr",
    type=click.Choice(("auto", "curve", "map")),
    default="auto",
    show_default=True,
    help="Light by the photo's gain map, with headroom above 1 as its maker rendered it; or by the "
    "calibrated curve. By the map where there is one (auto), but with --to by the curve.",
)
@exposure_option
@click.option(
    "--uncertainty",
    is_flag=True,
    help="Add a channel, facecrf.sigma: the standard deviation of each pixel's light, by the band "
    "of the curve.",
)
@estimation_options
@ending_well
def linearize(
    photos: tuple[Path, ...],
    output: Path,
    half: bool,
    compression: str,
    space: str | None,
    hdr: str,
    exposure: str,
    uncertainty: bool,
    **choices: Any,
) -> int:
    """Calibrate each PHOTO and write it as a scene-linear EXR.

    -o names the EXR, or a folder, which gets a.jpg.exr of a.jpg and so on; of several photos
    always a folder.
    """
    from facecrf_ocio.image.exposure import require_exposure

    require_exposure(exposure)
    chosen = Choices(**choices)
    if hdr == "map" and space:
        raise SettingsError("--to needs scene light, which no gain map proves; use --hdr curve")
    if hdr == "map" and exposure != "0":
        raise SettingsError("--exposure is for the calibrated curve; use --hdr curve")
    if hdr == "map" and uncertainty:
        raise SettingsError("--uncertainty is the calibrated curve's; use --hdr curve")
    exr: dict[str, Any] = {"half": half, "compression": compression, "overwrite": chosen.overwrite}
    job = _Linearization(chosen, space or "", hdr, exposure, uncertainty, exr)
    photos = tuple(dict.fromkeys(photos))
    if len(photos) == 1 and not _names_folder(output):
        return job.run(photos[0], output)
    codes = [job.run_one_of(path, target) for path, target in _targets(photos, output)]
    return next((code for code in (FAILED, UNREADABLE, NOTHING) if code in codes), DONE)


def _names_folder(output: Path) -> bool:
    """Of one photo, so that one that a pattern of the shell finds is written as several are."""
    return not names_exr(output) and (output.is_dir() or not output.suffix)


def _targets(photos: tuple[Path, ...], folder: Path) -> tuple[tuple[Path, Path], ...]:
    """Each photo with its EXR in the folder, which is made if it is missing."""
    from facecrf_ocio.files.folders import make_folder
    from facecrf_ocio.record.outputs import require_distinct_names

    if names_exr(folder):
        raise SettingsError(f"-o {folder}: names one file for {len(photos)} photos; name a folder")
    require_distinct_names(photos)
    require_writable(folder)
    make_folder(folder)
    return tuple((path, output_path(folder, path, EXR)) for path in photos)


@dataclass(frozen=True, slots=True)
class _Linearization:
    """How each photo becomes an EXR."""

    choices: Choices
    space: str
    hdr: str
    exposure: str
    uncertainty: bool
    exr: dict[str, Any]

    def run_one_of(self, path: Path, output: Path) -> int:
        """As `run`; whatever is wrong costs this photo, not the others."""
        try:
            return self.run(path, output)
        except Exception as error:  # decoders raise all kinds
            return complain(problem_of(error), exit_code_of(error))

    def run(self, path: Path, output: Path) -> int:
        """Linearize one photo, tell of it, and return its exit code."""
        require_exr_free(output, overwrite=self.choices.overwrite)
        written: tuple[Path, ...] = ()
        with status(f"linearizing {path}"):
            source = self.choices.read(path)
            by_map = self._is_by_map(source)
            if by_map:
                from facecrf_ocio.image.hdr_rendition import write_rendition

                rendition = write_rendition(output, source, **self.exr)
            else:
                from facecrf_ocio.image.exposure import find_exposure
                from facecrf_ocio.image.linearize import write_linear

                notes = source.notes
                estimate = self.choices.estimate(source)
                options = {"space": self.space, "uncertainty": self.uncertainty, **self.exr}
                if estimate.found is not None:
                    found = find_exposure(self.exposure, source, estimate.curve, estimate.faces)
                    options["exposure"] = found
                    exr = write_linear(output, source, estimate, **options)
                    written, notes = (exr.path,), (*notes, *with_remedy(exr.notes))
        if by_map:
            return _tell_rendition(path, source, rendition)
        return tell(path, estimate, written, notes=notes, verbose=self.choices.verbose)

    def _is_by_map(self, photo: Photo) -> bool:
        bound = bool(self.space) or self.exposure != "0" or self.uncertainty
        free = photo.gain_map is not None and not bound
        if self.hdr == "map" and photo.gain_map is None:
            raise SettingsError(f"{photo.path}: has no gain map; use --hdr curve")
        return self.hdr == "map" or (self.hdr == "auto" and free)


def _tell_rendition(path: Path, photo: Photo, written: WrittenExr) -> int:
    from facecrf_ocio.image.hdr_rendition import NOT_PROVEN, headroom

    assert photo.gain_map is not None  # noqa: S101 - or it would not have been written
    what = f"{photo.gain_map.standard}, {headroom(photo.gain_map):.1f} stops of headroom"
    say(f"{path}: by its gain map ({what}): {NOT_PROVEN}")
    tell_notes((*photo.notes, *with_remedy(written.notes)))
    click.echo(one_line(f"  {written.path}"))
    return DONE


def with_remedy(notes: tuple[str, ...]) -> tuple[str, ...]:
    """Return what an EXR does not hold, and the option that helps."""
    return tuple(f"{note}; --float keeps it" for note in notes)


def require_exr_free(path: Path, *, overwrite: bool) -> None:
    """Raise OutputError unless an EXR may be written, before a photo is calibrated."""
    from facecrf_ocio.files.atomic import require_free

    require_exr_name(path)
    require_free(path, overwrite=overwrite)
    require_writable(path.parent)  # first, since folders in a closed one cannot even be looked for
    if not path.parent.exists():
        raise OutputError(f"{path}: cannot be written: no such folder; create the folder first")
