"""`facecrf lint`: LUT files in, what is wrong with them out."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import click

from facecrf_ocio.cli.live import Bar
from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.terminal import DONE, ending_well, exit_code_of, fitted, one_line, say
from facecrf_ocio.errors import LutError
from facecrf_ocio.files.plain_text import counted

WARNED, WRONG, UNUSABLE = 5, 6, 7  # exit codes, beyond those that all commands share


@click.command(
    epilog="Exit codes, of several files the highest: 0 clean; 3 a file cannot be read; 5 "
    "warnings only; 6 errors; 7 OpenColorIO cannot use a LUT, for the reason told.",
)
@click.argument("luts", nargs=-1, required=True, type=PHOTO_PATH, metavar="LUT|DIR...")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per finding and line.")
@ending_well
def lint(luts: tuple[Path, ...], as_json: bool) -> int:
    """Find what is wrong with each LUT: what OpenColorIO refuses, and what it takes silently.

    Of a folder, all LUTs in and below it are looked at.
    """
    from facecrf_ocio.lut.lint import ERROR
    from facecrf_ocio.lut.lint import lint as find

    codes, clean, looked_at = [DONE], 0, 0
    with Bar() as bar:
        files = list(_files(luts, codes, bar))
        for number, path in enumerate(files):
            bar.show(one_line(f"{number} of {len(files)}: {path}"), number, len(files))
            try:
                findings = find(path)
            except LutError as error:
                bar.say(f"facecrf: {one_line(str(error))}")
                codes.append(exit_code_of(error))
                continue
            looked_at += 1
            clean += not findings
            for finding in findings:
                code = WRONG if finding.severity == ERROR else WARNED
                codes.append(UNUSABLE if finding.unusable else code)
                told = fitted(one_line(str(finding)), sys.stdout)
                record = json.dumps({**asdict(finding), "path": str(path)})
                bar.say(record if as_json else told, err=False)
    if looked_at and not as_json:
        say(f"{counted(looked_at, 'LUT')} looked at: {_how_many(clean, looked_at)}")
    return max(codes)


def _how_many(clean: int, all_of_them: int) -> str:
    if clean == all_of_them:
        return "nothing is wrong"
    return f"{clean} clean, {all_of_them - clean} with what is told above"


def _files(named: tuple[Path, ...], codes: list[int], bar: Bar) -> Iterator[Path]:
    """The files named, and those in the folders named; a folder without any is told."""
    from facecrf_ocio.lut.lint import luts_below

    for path in named:
        found = luts_below(path) if path.is_dir() else (path,)
        if not found:
            error = LutError(f"{path}: holds no LUT; name another folder, or a file")
            bar.say(f"facecrf: {one_line(str(error))}")
            codes.append(exit_code_of(error))
        yield from found
