"""`facecrf verify`: whether what a batch made is as it was written, and made again if not."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from facecrf_ocio.archive.walk import as_utf8
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.terminal import DONE, FAILED, complain, ending_well, say
from facecrf_ocio.errors import in_options
from facecrf_ocio.files.plain_text import counted

if TYPE_CHECKING:
    from facecrf_ocio.archive.check_outputs import Fault


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per fault and line.")
@click.option("--repair", is_flag=True, help="Make again what is missing, altered or unreadable.")
@ending_well
def verify(folder: Path, as_json: bool, repair: bool) -> int:
    """Tell which files of a batch in FOLDER are missing, altered, unreadable or extra.

    Every file is read and its hash compared. Nothing is changed without --repair, which makes
    outputs again from the photos as the batch did, and takes nothing away that is extra.
    """
    from facecrf_ocio.archive.check_outputs import faults_in

    faults = []
    for fault in faults_in(folder):
        faults.append(fault)
        if not repair:
            _tell(fault, as_json)
    if repair:
        from facecrf_ocio.archive.repair import make_again

        made = sum(fault.photo != "" for fault in faults)
        with status(f"making {counted(made, 'file')} of {folder} again"):
            problems = make_again(folder, faults)
        for problem in problems:
            complain(in_options(problem, "facecrf batch"), FAILED)
        faults = list(faults_in(folder))
        for fault in faults:
            _tell(fault, as_json)
    code = FAILED if faults else DONE
    if as_json:
        click.echo(json.dumps({"folder": str(folder), "exit_code": code, "faults": len(faults)}))
    elif faults:
        complain(f"{folder}: {_in_sum(faults)}", code)
    else:
        say(f"{folder}: all files are as they were written")
    return code


def _in_sum(faults: Sequence[Fault]) -> str:
    """How many files are not as they were written, and how many were not written at all."""
    extra = sum(fault.photo == "" for fault in faults)
    wrong = len(faults) - extra
    are = "is not as it was" if wrong == 1 else "are not as they were"
    parts = [f"{counted(wrong, 'file')} {are} written"] if wrong else []
    parts += [f"{counted(extra, 'file')} {'is' if extra == 1 else 'are'} extra"] if extra else []
    return ", ".join(parts)


def _tell(fault: Fault, as_json: bool) -> None:
    if as_json:
        record = {"fault": fault.kind, "file": fault.name, "photo": fault.photo}
        click.echo(json.dumps(record))
    else:
        say(f"{fault.kind}: {as_utf8(fault.name)}")
