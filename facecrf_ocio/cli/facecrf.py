"""The `facecrf` command: arguments in, one library call each, exit codes out.

A command's module is imported when the command is asked for, and heavy ones by the command itself.
"""

from __future__ import annotations

import click

from facecrf_ocio import __version__
from facecrf_ocio.cli.sections import EXAMPLES, Commands, Sections, examples
from facecrf_ocio.cli.terminal import EXIT_CODES, speak_any_name


@click.group(
    cls=Sections,
    commands=Commands(),
    epilog=f"{examples(EXAMPLES[''])}\n\n{EXIT_CODES}",
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, prog_name="facecrf")
def main() -> None:
    """From one photo with a face to an OCIO transform that makes it scene-linear."""
    speak_any_name()
