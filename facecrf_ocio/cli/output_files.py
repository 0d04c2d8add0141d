"""The files that commands write of a photo: its LUTs, its record and, if asked for, its plot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.options import TEXT_PATH, direction_options
from facecrf_ocio.cli.terminal import hush_matplotlib
from facecrf_ocio.lut.format_table import default_formats, format_names
from facecrf_ocio.record.output_names import PLOT, output_path

if TYPE_CHECKING:
    from facecrf_ocio.settings import Settings
    from facecrf_ocio.values import Estimate, Photo


def folder_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option `--output`: the folder that gets the files."""
    return click.option(
        "-o",
        "--output",
        required=True,
        type=TEXT_PATH,
        metavar="DIR",
        callback=_require_no_file,
        help="Where to write.",
    )(command)


def _require_no_file(context: click.Context, option: click.Parameter, value: Path) -> Path:
    """Fail where a file is named, after which a folder would be called."""
    suffixes = {f".{name.rpartition('.')[2]}" for name in format_names()}
    if value.suffix.lower() in suffixes and not value.is_dir():
        said = f"{value} names a file; name the folder that gets the files"
        raise click.BadParameter(said, context, option)
    return value


def formats_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option `--formats`: a tuple of endings in `format_table`."""
    return click.option(
        "--formats",
        default=",".join(default_formats()),
        show_default=True,
        metavar="LIST",
        callback=_split_formats,
        help=f"LUT formats, by commas, of {', '.join(format_names())}.",
    )(command)


def _split_formats(context: click.Context, option: click.Parameter, value: str) -> tuple[str, ...]:
    """Parse LUT formats separated by commas, or fail as wrong usage."""
    names = tuple(dict.fromkeys(name.strip().lower() for name in value.split(",") if name.strip()))
    known = ", ".join(format_names())
    unknown = [name for name in names if name not in format_names()]
    if unknown:
        raise click.BadParameter(f"no LUT format {unknown[0]!r}; known: {known}", context, option)
    if not names:
        raise click.BadParameter(f"name at least one of {known}", context, option)
    return names


def measurement_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add what all commands that measure a response offer beside `--output`."""
    options = (
        formats_option,
        direction_options,
        click.option("--plot", is_flag=True, help=f"Also write NAME{PLOT}: the curves."),
        click.option("--json", "as_json", is_flag=True, help="Print one JSON object."),
        click.option("--overwrite", is_flag=True, help="Replace existing outputs."),
    )
    for option in reversed(options):
        command = option(command)
    return command


@dataclass(frozen=True, slots=True)
class OutputFiles:
    """What is to be written of each photo, and where.

    Attributes
    ----------
    folder
        That gets the files.
    formats
        Endings of the LUTs.
    plot
        Whether the curves are drawn as well.
    overwrite
        Whether existing files are replaced.
    """

    folder: Path
    formats: tuple[str, ...]
    plot: bool
    overwrite: bool

    @staticmethod
    def asked(
        folder: Path,
        formats: tuple[str, ...],
        direction: str,
        space: str | None,
        *,
        plot: bool,
        overwrite: bool,
    ) -> OutputFiles:
        """What the options ask for.

        Raises
        ------
        LutError
            If a format cannot hold what they ask for.
        """
        from facecrf_ocio.lut.write import endings

        return OutputFiles(folder, endings(formats, direction, space or ""), plot, overwrite)

    def require_free(self, path: Path) -> None:
        """Raise OutputError unless all can be written of a photo, before it is looked at."""
        from facecrf_ocio.files.atomic import require_free
        from facecrf_ocio.record.outputs import require_outputs_free

        require_outputs_free(path, self.folder, self.formats, overwrite=self.overwrite)
        if self.plot:
            require_free(self._picture(path), overwrite=self.overwrite)

    def write(
        self, path: Path, photo: Photo, estimate: Estimate, settings: Settings
    ) -> tuple[Path, ...]:
        """Write the files of a photo, which are named after its path; all or none."""
        from facecrf_ocio.record.outputs import write_outputs

        also = []
        if self.plot:
            hush_matplotlib()
            from facecrf_ocio.plots.calibration_plot import plot_draft

            also.append(plot_draft(self._picture(path), photo, estimate, settings))
        overwrite = self.overwrite
        return write_outputs(
            photo, estimate, settings, self.folder, self.formats, overwrite=overwrite, also=also
        )

    def _picture(self, path: Path) -> Path:
        return output_path(self.folder, path, PLOT)
