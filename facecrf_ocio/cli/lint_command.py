"""`facecrf lint`: LUT files in, what is wrong with them out."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import click

from facecrf_ocio.cli.live import Bar
from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.terminal import DONE, ending_well, exit_code_of, one_line
from facecrf_ocio.errors import LutError

WARNED, WRONG, UNUSABLE = 5, 6, 7  # exit codes, beyond those that all commands share


@click.command(
    epilog="Exit codes, of several files the highest: 0 clean; 3 a file cannot be read; 5 "
    "warnings only; 6 errors; 7 OpenColorIO cannot use a LUT, for the reason told.",
)
@click.argument("luts", nargs=-1, required=True, type=PHOTO_PATH, metavar="LUT...")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per finding and line.")
@ending_well
def lint(luts: tuple[Path, ...], as_json: bool) -> int:
    """Find what is wrong with each LUT: what OpenColorIO refuses, and what it takes silently."""
    from facecrf_ocio.lut.lint import ERROR
    from facecrf_ocio.lut.lint import lint as find

    codes = [DONE]
    with Bar() as bar:
        for number, path in enumerate(luts):
            bar.show(one_line(f"{number} of {len(luts)}: {path}"), number, len(luts))
            try:
                findings = find(path)
            except LutError as error:
                bar.say(f"facecrf: {one_line(str(error))}")
                codes.append(exit_code_of(error))
                continue
            for finding in findings:
                code = WRONG if finding.severity == ERROR else WARNED
                codes.append(UNUSABLE if finding.unusable else code)
                record = json.dumps({**asdict(finding), "path": str(path)})
                bar.say(record if as_json else one_line(str(finding)), err=False)
    return max(codes)
