"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.settings import ESTIMATOR_NAMES, FALLBACKS, Settings

if TYPE_CHECKING:
    from facecrf_ocio.values import Estimate, Photo

COMPRESSIONS = (
    *("none", "rle", "zip", "zips", "piz"),
    *("pxr24", "b44", "b44a", "dwaa", "dwab"),
)


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


# Not to be readable is no wrong usage, and one such photo must not keep the others.
PHOTO_PATH = click.Path(readable=False, path_type=Path)
TEXT_PATH = TextPath(readable=False, path_type=Path)


def estimation_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that `Choices` holds."""
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
class Choices:
    """How to estimate, as all commands that estimate take it."""

    estimator: str
    fallback: str
    per_channel: bool
    overwrite: bool

    @property
    def settings(self) -> Settings:
        """The default settings, changed as asked."""
        return Settings(shared_curve=not self.per_channel)

    def read_and_estimate(self, path: Path) -> tuple[Photo, Estimate]:
        """Read one photo and estimate its curve."""
        from facecrf_ocio import calibrate, read_photo

        photo = read_photo(path)
        return photo, calibrate(
            photo, estimator=self.estimator, fallback=self.fallback, settings=self.settings
        )


def exr_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of an EXR to be written."""
    options = (
        click.option("-o", "--output", required=True, type=TEXT_PATH, metavar="OUT.exr"),
        click.option("--half/--float", default=True, help="16-bit (default) or 32-bit floats."),
        click.option(
            "--compression",
            type=click.Choice(COMPRESSIONS),
            default="zip",
            show_default=True,
            metavar="NAME",
            help=f"OpenEXR's; one of {', '.join(COMPRESSIONS)}.",
        ),
    )
    for option in reversed(options):
        command = option(command)
    return command
