"""The list of commands, by kind of work, and examples of each."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Iterator, MutableMapping
from importlib import import_module
from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.terminal import interrupted

SECTIONS = {
    "One photo": ("calibrate", "linearize", "show", "apply"),
    "An archive": ("batch", "report", "verify"),
    "A camera": ("pair", "bracket", "chart", "cameras"),
    "Moving pictures and brackets": ("clip", "merge"),
    "LUTs": ("ocio-config", "lint"),
    "About facecrf": ("demo", "explain", "doctor", "completion", "bench"),
}

EXAMPLES = {
    "": (
        "facecrf calibrate portrait.jpg -o luts",
        "facecrf linearize portrait.jpg -o portrait.exr",
        "facecrf batch photos -o luts",
    ),
    "calibrate": (
        "facecrf calibrate a.jpg -o luts",
        "facecrf calibrate a.jpg -o luts --formats cube --to acescg --plot",
        "facecrf calibrate a.jpg b.jpg c.jpg -o luts --together",
    ),
    "linearize": (
        "facecrf linearize a.jpg -o a.exr",
        "facecrf linearize a.jpg b.jpg -o linear --exposure gray",
    ),
    "show": ("facecrf show a.jpg --open", "facecrf show a.jpg --record luts/a.jpg.crf.json"),
    "apply": ("facecrf apply a.jpg --lut luts/a.jpg.cube -o a.exr",),
    "batch": (
        "facecrf batch photos -o luts",
        "facecrf batch photos -o luts --pool camera --exr --csv photos.csv",
    ),
    "report": ("facecrf report luts",),
    "verify": ("facecrf verify luts", "facecrf verify luts --repair"),
    "pair": ("facecrf pair a.dng a.jpg -o luts", "facecrf pair a.cr2 -o luts"),
    "bracket": ("facecrf bracket 1.jpg 2.jpg 3.jpg -o luts",),
    "chart": ("facecrf chart a.jpg -o luts",),
    "cameras": (
        "facecrf cameras list canon",
        "facecrf cameras measure raws",
        "facecrf cameras add luts/a.jpg.crf.json",
    ),
    "clip": ("facecrf clip frame.%04d.jpg -o luts --exr",),
    "merge": ("facecrf merge 1.jpg 2.jpg 3.jpg -o merged.exr",),
    "ocio-config": ("facecrf ocio-config luts/a.jpg.spi1d luts/b.jpg.spi1d -o photos.ocio",),
    "lint": ("facecrf lint luts/a.jpg.cube luts/b.jpg.cube", "facecrf lint luts"),
    "demo": ("facecrf demo",),
    "explain": ("facecrf explain verdicts",),
    "doctor": ("facecrf doctor",),
    "bench": ("facecrf bench synthetic --help",),
}


class Commands(MutableMapping[str, click.Command]):
    """The commands of `SECTIONS` by name, each imported when it is first asked for.

    Command `a-b` is the function `a_b` of `a_b_command.py`; its help ends with its examples.
    """

    def __init__(self) -> None:
        self._loaded: dict[str, click.Command | None] = {
            name: None for names in SECTIONS.values() for name in names
        }

    def __getitem__(self, name: str) -> click.Command:
        loaded = self._loaded[name]
        if loaded is None:
            function = name.replace("-", "_")
            module = import_module(f"facecrf_ocio.cli.{function}_command")
            loaded = self._loaded[name] = _with_examples(name, getattr(module, function))
        return loaded

    def __setitem__(self, name: str, command: click.Command) -> None:
        self._loaded[name] = command

    def __delitem__(self, name: str) -> None:
        del self._loaded[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._loaded)

    def __len__(self) -> int:
        return len(self._loaded)


class Sections(click.Group):
    """A group that lists its commands under headings, each with its whole first sentence."""

    def format_commands(self, _: click.Context, formatter: click.HelpFormatter) -> None:
        """Write them."""
        for heading, names in SECTIONS.items():
            _list(heading, names, self, formatter)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that was asked for; of a photo or a folder in its place tell one."""
        given = args[0]
        if given not in self.commands and os.path.lexists(given):
            command = "batch" if Path(given).is_dir() else "calibrate"
            told = f"facecrf {command} {shlex.quote(given)} -o luts"
            ctx.fail(f"{given!r} is no command; to calibrate it: {told}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command that was asked for, until Ctrl-C, also while it is being imported."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            ctx.exit(interrupted())


class Listing(click.Group):
    """A group below a command: it lists its own commands, each with its whole first sentence."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write them."""
        _list("Commands", self.list_commands(ctx), self, formatter)


def _list(
    heading: str, names: Iterable[str], group: click.Group, formatter: click.HelpFormatter
) -> None:
    with formatter.section(heading):
        formatter.write_dl([(name, _summary(group.commands[name])) for name in names])


def _with_examples(name: str, command: click.Command) -> click.Command:
    lines = EXAMPLES.get(name, ())
    if lines:
        command.epilog = "\n\n".join(filter(None, (examples(lines), command.epilog)))
    return command


def examples(lines: tuple[str, ...]) -> str:
    """As a paragraph whose lines Click keeps."""
    return "\n".join(("\b", "Examples:", *(f"  {line}" for line in lines)))


def _summary(command: click.Command) -> str:
    return command.get_short_help_str(limit=200)  # letters: more than any has
