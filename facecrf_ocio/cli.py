"""The `facecrf` command: arguments in, one library call each, exit codes out.

Heavy modules are imported by the commands that need them, so that `facecrf --help` is instant.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio import __version__
from facecrf_ocio.errors import FaceCRFError, LutError, OutputError, PhotoError, SettingsError
from facecrf_ocio.settings import ESTIMATOR_NAMES, FALLBACKS, Settings

if TYPE_CHECKING:
    from facecrf_ocio.values import Estimate, Photo

DONE, FAILED, USAGE, UNREADABLE, NOTHING = 0, 1, 2, 3, 4
EXIT_CODES = """
Exit codes: 0 done; 1 an output cannot be written; 2 wrong usage; 3 a file cannot be read;
4 a photo gives nothing to calibrate from.
"""
FORMAT_NAMES = "spi1d,cube,clf"

Command = Callable[..., int]


@click.group(epilog=EXIT_CODES, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="facecrf")
def main() -> None:
    """From one photo with a face to an OCIO transform that makes it scene-linear."""


def _ending_well(command: Command) -> Command:
    """Turn our own errors into one line on stderr and the exit code they stand for."""

    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> int:
        try:
            code = command(*args, **kwargs)
        except FaceCRFError as error:
            code = _report(error)
        except MemoryError:
            code = _complain("not enough memory; use a smaller photo", FAILED)
        sys.exit(code)

    return run


def _report(error: FaceCRFError) -> int:
    codes = {
        PhotoError: UNREADABLE,
        LutError: UNREADABLE,
        OutputError: FAILED,
        SettingsError: USAGE,
    }
    return _complain(str(error), codes.get(type(error), FAILED))


def _complain(message: str, code: int) -> int:
    click.echo(f"facecrf: {message}", err=True)
    return code


_PATH = click.Path(path_type=Path)


def _estimation_options(command: Callable[..., Any]) -> Callable[..., Any]:
    options = (
        click.option(
            "--estimator",
            type=click.Choice(ESTIMATOR_NAMES),
            default="auto",
            show_default=True,
            metavar="NAME",
            help=f"One of {', '.join(ESTIMATOR_NAMES)}.",
        ),
        click.option(
            "--fallback",
            type=click.Choice(FALLBACKS),
            default="none",
            show_default=True,
            help="Curve to use where the photo gives no evidence.",
        ),
        click.option(
            "--per-channel/--shared",
            "per_channel",
            default=True,
            help="One curve for each channel (default) or one for all three.",
        ),
        click.option("--overwrite", is_flag=True, help="Replace existing outputs."),
    )
    for option in reversed(options):
        command = option(command)
    return command


@dataclass(frozen=True, slots=True)
class _Choices:
    """How to estimate, as all commands that estimate take it."""

    estimator: str
    fallback: str
    per_channel: bool
    overwrite: bool

    @property
    def settings(self) -> Settings:
        return Settings(shared_curve=not self.per_channel)

    def estimate(self, photo: Photo) -> Estimate:
        from facecrf_ocio import calibrate

        return calibrate(
            photo, estimator=self.estimator, fallback=self.fallback, settings=self.settings
        )


@main.command()
@click.argument("photos", nargs=-1, required=True, type=_PATH)
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR", help="Where to write.")
@click.option("--formats", default=FORMAT_NAMES, show_default=True, help="LUT formats, by commas.")
@click.option("--plot", is_flag=True, help="Also write NAME.png: curves, skin mask, pigment map.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per photo.")
@_estimation_options
@_ending_well
def calibrate(
    photos: tuple[Path, ...], output: Path, formats: str, plot: bool, as_json: bool, **choices: Any
) -> int:
    """Estimate the inverse camera response of each PHOTO and write it as LUT files.

    For a.jpg the folder gets a.spi1d, a.cube, a.clf and a.crf.json.
    """
    from facecrf_ocio.export import require_distinct_names

    require_distinct_names(photos)
    names = tuple(name.strip() for name in formats.split(",") if name.strip())
    codes = []
    for path in _with_progress(photos):
        try:
            codes.append(
                _calibrate_one(path, output, names, _Choices(**choices), plot=plot, as_json=as_json)
            )
        except FaceCRFError as error:
            codes.append(_report(error))
    return next((code for code in (USAGE, FAILED, UNREADABLE, NOTHING) if code in codes), DONE)


def _calibrate_one(
    path: Path,
    folder: Path,
    formats: tuple[str, ...],
    choices: _Choices,
    *,
    plot: bool,
    as_json: bool,
) -> int:
    from facecrf_ocio import read_photo
    from facecrf_ocio.export import require_outputs_free, write_outputs
    from facecrf_ocio.export.atomic import require_free

    picture = folder / f"{path.stem}.png"
    require_outputs_free(path, folder, formats, overwrite=choices.overwrite)
    if plot:
        require_free(picture, overwrite=choices.overwrite)
    photo = read_photo(path)
    estimate = choices.estimate(photo)
    written: tuple[Path, ...] = ()
    if estimate.found is not None:
        written = write_outputs(
            photo, estimate, choices.settings, folder, formats, overwrite=choices.overwrite
        )
        if plot:
            from facecrf_ocio.report.plot import write_plot

            written += (
                write_plot(picture, photo, estimate, choices.settings, overwrite=choices.overwrite),
            )
    _tell(path, estimate, written, as_json=as_json)
    return NOTHING if estimate.found is None else DONE


def _exr_options(command: Callable[..., Any]) -> Callable[..., Any]:
    options = (
        click.option("-o", "--output", required=True, type=_PATH, metavar="OUT.exr"),
        click.option("--half/--float", default=True, help="16-bit (default) or 32-bit floats."),
        click.option(
            "--compression", default="zip", show_default=True, help="OpenEXR compression."
        ),
    )
    for option in reversed(options):
        command = option(command)
    return command


@main.command()
@click.argument("photo", type=_PATH)
@_exr_options
@_estimation_options
@_ending_well
def linearize(photo: Path, output: Path, half: bool, compression: str, **choices: Any) -> int:
    """Calibrate PHOTO and write it as a scene-linear EXR."""
    from facecrf_ocio import read_photo
    from facecrf_ocio.apply import linearize_photo, write_exr
    from facecrf_ocio.export.atomic import require_free

    chosen = _Choices(**choices)
    require_free(output, overwrite=chosen.overwrite)
    with _status(f"linearizing {photo}"):
        source = read_photo(photo)
        estimate = chosen.estimate(source)
        written: tuple[Path, ...] = ()
        if estimate.found is not None:
            provenance = {
                "outcome": str(estimate.outcome),
                "estimator": estimate.estimator,
                "version": __version__,
            }
            if estimate.confidence is not None:
                provenance["confidence"] = str(estimate.confidence.verdict)
            written = (
                write_exr(
                    output,
                    linearize_photo(source, estimate.curve),
                    source,
                    provenance=provenance,
                    half=half,
                    compression=compression,
                    overwrite=chosen.overwrite,
                ),
            )
    _tell(photo, estimate, written, as_json=False)
    return NOTHING if estimate.found is None else DONE


@main.command()
@click.argument("photo", type=_PATH)
@click.option("--lut", required=True, type=_PATH, help="Any LUT file OpenColorIO reads.")
@_exr_options
@click.option("--overwrite", is_flag=True, help="Replace an existing EXR.")
@_ending_well
def apply(
    photo: Path, lut: Path, output: Path, half: bool, compression: str, overwrite: bool
) -> int:
    """Send PHOTO through a LUT made before and write it as a scene-linear EXR."""
    from facecrf_ocio import read_photo
    from facecrf_ocio.apply import apply_lut, write_exr
    from facecrf_ocio.export.atomic import require_free

    require_free(output, overwrite=overwrite)
    with _status(f"applying {lut}"):
        source = read_photo(photo)
        written = write_exr(
            output,
            apply_lut(source, lut),
            source,
            provenance={"lut": lut.name, "version": __version__},
            half=half,
            compression=compression,
            overwrite=overwrite,
        )
    click.echo(f"{photo}: {written}")
    return DONE


@main.command()
@click.option(
    "-o",
    "--output",
    default=Path("facecrf-demo"),
    show_default=True,
    type=_PATH,
    metavar="DIR",
    help="Folder for the demo's files, which replace those of an earlier demo.",
)
@_ending_well
def demo(output: Path) -> int:
    """Calibrate and linearize a portrait that comes with matplotlib (public domain)."""
    from facecrf_ocio.demo import run_demo

    with _status("calibrating a portrait of Grace Hopper"):
        photo, estimate, written = run_demo(output)
    _tell(photo, estimate, written, as_json=False)
    return DONE


def _tell(path: Path, estimate: Estimate, written: tuple[Path, ...], *, as_json: bool) -> None:
    confidence = estimate.confidence
    if as_json:
        record = {
            "photo": str(path),
            "outcome": str(estimate.outcome),
            "estimator": estimate.estimator,
            "reason": estimate.reason,
            "remedy": estimate.remedy,
            "verdict": None if confidence is None else str(confidence.verdict),
            "energy": dict(estimate.energy),
            "faces": len(estimate.faces),
            "files": [str(file) for file in written],
        }
        click.echo(json.dumps(record, ensure_ascii=False))
        return
    if estimate.found is None:
        click.echo(f"{path}: {estimate.outcome}: {estimate.reason}; {estimate.remedy}", err=True)
        return
    verdict = "" if confidence is None else f" ({confidence.verdict})"
    click.echo(f"{path}: {estimate.outcome}{verdict}: {estimate.reason}")
    for file in written:
        click.echo(f"  {file}")


@contextmanager
def _status(message: str) -> Iterator[None]:
    """A spinner on a terminal's stderr; nothing where there is no terminal."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(message):
        yield


def _with_progress(paths: tuple[Path, ...]) -> Iterator[Path]:
    """The paths one by one, with a bar on a terminal's stderr."""
    if not sys.stderr.isatty():
        yield from paths
        return
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    yield from track(paths, description="calibrating", console=console, transient=True)
