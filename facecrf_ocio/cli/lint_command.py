"""`facecrf lint`: LUT files in, what is wrong with them out."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import click

from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.terminal import DONE, complain, ending_well, exit_code_of, one_line
from facecrf_ocio.errors import LutError

WARNED, WRONG = 5, 6


@click.command(
    epilog="Exit codes: 0 clean; 5 warnings only; 6 errors; 3 a file cannot be read.",
)
@click.argument("luts", nargs=-1, required=True, type=PHOTO_PATH, metavar="LUT...")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per finding and line.")
@ending_well
def lint(luts: tuple[Path, ...], as_json: bool) -> int:
    """Find what OpenColorIO accepts silently in each LUT: NaN, a reversed domain and the like."""
    from facecrf_ocio.lut.lint import ERROR
    from facecrf_ocio.lut.lint import lint as find

    codes = [DONE]
    for path in luts:
        try:
            findings = find(path)
        except LutError as error:
            codes.append(complain(str(error), exit_code_of(error)))
            continue
        for finding in findings:
            codes.append(WRONG if finding.severity == ERROR else WARNED)
            record = json.dumps({**asdict(finding), "path": str(path)})
            click.echo(record if as_json else one_line(str(finding)))
    return max(codes)
