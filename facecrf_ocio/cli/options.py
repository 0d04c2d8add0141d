"""Options that several commands share."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import ESTIMATOR_NAMES, ESTIMATORS, FALLBACKS, JOINT_NAMES
from facecrf_ocio.image.compression import COMPRESSION, COMPRESSIONS, require_compression
from facecrf_ocio.settings import PRIORS, VERDICTS

SPACE_NAMES = ("acescg", "lin_rec709", "lin_p3d65", "aces2065-1")


class TextPath(click.Path):
    """A path that is UTF-8 text, which is all that OpenColorIO and OpenImageIO take."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Take a path, or fail as wrong usage."""
        path = super().convert(value, param, ctx)
        try:
            str(path).encode()
        except UnicodeEncodeError:
            self.fail("the name is not UTF-8 text; choose another", param, ctx)
        return path


class _Compression(click.Choice[str]):
    """A name that OpenImageIO knows, of some with a level behind it."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Take a name, or fail as wrong usage."""
        try:
            return require_compression(value)
        except SettingsError as error:
            self.fail(str(error), param, ctx)


# Not to be readable is no wrong usage, and one such photo must not keep the others.
PHOTO_PATH = click.Path(readable=False, path_type=Path)
TEXT_PATH = TextPath(readable=False, path_type=Path)


_BEFORE_HELP = 34  # columns: Click's for the longest options and the gaps around them
_LISTED = "\b\n" + "\n".join(f"{row.name}: {row.does}" for row in ESTIMATORS.values()) + "\n\n"


class _Listed(click.Option):
    """An option with a list of values; its lines break as a terminal's width asks for."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Break lines that Click keeps as they are."""
        record = super().get_help_record(ctx)
        if record is None:
            return None
        room = click.HelpFormatter(width=ctx.terminal_width, max_width=ctx.max_content_width).width
        room -= _BEFORE_HELP
        lines = [
            textwrap.fill(line, room, subsequent_indent="  ") for line in record[1].split("\n")
        ]
        return record[0], "\n".join(lines)


def _with(
    options: Sequence[Callable[[Callable[..., Any]], Callable[..., Any]]],
    command: Callable[..., Any],
) -> Callable[..., Any]:
    """The command with options, which its help shows in their order."""
    for option in reversed(options):
        command = option(command)
    return command


def estimation_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that `choices.Choices` holds."""
    options = (
        click.option(
            "--estimator",
            cls=_Listed,
            type=click.Choice(ESTIMATOR_NAMES),
            default="auto",
            show_default=True,
            metavar="NAME",
            help=_LISTED,
        ),
        click.option(
            "--fallback",
            type=click.Choice(FALLBACKS),
            default="none",
            show_default=True,
            help="Curve to use where the photo gives no evidence.",
        ),
        click.option(
            "--prior",
            type=click.Choice(PRIORS),
            default="auto",
            show_default=True,
            help="Responses to expect: film and early cameras (dorf), digital ones (modern), both.",
        ),
        click.option(
            "--min-confidence",
            type=click.Choice(VERDICTS, case_sensitive=False),
            default=VERDICTS[0],
            help="Write nothing where the verdict is below this (exit code 4).",
        ),
        click.option(
            "--max-error",
            type=click.FloatRange(0, min_open=True),
            metavar="STOPS",
            help="Write nothing where the expected error is above this, such as 0.1 (exit code 4).",
        ),
        click.option(
            "--per-channel/--shared",
            "per_channel",
            default=None,
            help="One curve for each channel (default) or one for all three; "
            f"{' and '.join(JOINT_NAMES)} give one for all, but of cameras that you have "
            "measured, and with --shared of those too.",
        ),
        click.option("--overwrite", is_flag=True, help="Replace existing outputs."),
        click.option("-v", "--verbose", is_flag=True, help="Also tell what a curve rests on."),
    )
    return _with(options, command)


def direction_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say which way a LUT goes, and how far: `direction`, `space`."""
    options = (
        click.option(
            "--direction",
            type=click.Choice(("linearize", "encode", "both")),
            default="linearize",
            show_default=True,
            help="From code values to linear light, back (NAME.encode.clf), or a file for each.",
        ),
        space_option("clf and ctf only (NAME.acescg.clf)"),
    )
    return _with(options, command)


def space_option(how: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return the option `--to`; `how` says what it means to the files written."""
    return click.option(
        "--to",
        "space",
        type=click.Choice(SPACE_NAMES, case_sensitive=False),
        help=f"Go on to a working space by the photo's primaries; {how}.",
    )


def exr_options(output: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return what adds the options of an EXR to be written; `output` says what -o may name."""
    return lambda command: _with_exr_options(command, output)


def _with_exr_options(command: Callable[..., Any], output: str) -> Callable[..., Any]:
    options = (
        click.option("-o", "--output", required=True, type=TEXT_PATH, metavar=output),
        click.option("--half/--float", default=True, help="16-bit (default) or 32-bit floats."),
        compression_option,
    )
    return _with(options, command)


def compression_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option of how EXRs to be written are compressed."""
    return click.option(
        "--compression",
        type=_Compression(COMPRESSIONS),
        default=COMPRESSION,
        show_default=True,
        metavar="NAME[:LEVEL]",
        help=f"OpenEXR's; one of {', '.join(COMPRESSIONS)}. zip, of OpenEXR's own level, takes 1.4 "
        "times as long as zip:1 for files 2 to 8 % smaller.",
    )(command)


def require_exrs(compression: str, *, asked: bool) -> None:
    """Raise UsageError where a compression is named but no EXR asked for."""
    if compression != COMPRESSION and not asked:
        raise click.UsageError("--compression is of EXRs; pass --exr, too")


def exposure_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option that scales the light of an EXR to be written."""
    return click.option(
        "--exposure",
        default="0",
        metavar="STOPS|gray|skin",
        help="Scale the light of the EXR: by stops, its geometric mean to 0.18, or the cheek to "
        "what its tone usually reflects (skin:fair, skin:medium, skin:dark tell which). Told in "
        "the EXR.",
    )(command)
