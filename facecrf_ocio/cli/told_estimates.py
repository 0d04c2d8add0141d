"""How commands tell what came of a photo: lines for people, or one JSON object."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from facecrf_ocio.cli.terminal import DONE, NOTHING, complain, one_line, say
from facecrf_ocio.errors import in_options

if TYPE_CHECKING:
    from facecrf_ocio.values import Estimate


def tell_estimate(whose: str, estimate: Estimate) -> None:
    """Print on one line what to expect of a curve."""
    from facecrf_ocio.wording.sentence import COMMAND_LINE, sentence

    told = estimate.confidence
    outcome = str(estimate.outcome) if told is None else f"{estimate.outcome} ({told.verdict})"
    say(f"{whose}: {outcome}: {in_options(sentence(estimate, COMMAND_LINE))}")


def tell_details(estimate: Estimate) -> None:
    """Print what a curve rests on, a line each."""
    from facecrf_ocio.wording.sentence import details

    for line in details(estimate):
        say(f"  {line}")


def tell_notes(notes: Iterable[str], *, err: bool = False) -> None:
    """Print what was mended, chosen or cut on the way, a line each."""
    for note in notes:
        say(f"  note: {note}", err=err)


def tell(
    path: Path,
    estimate: Estimate,
    written: tuple[Path, ...],
    *,
    notes: tuple[str, ...] = (),
    as_json: bool = False,
    verbose: bool = False,
    told_before: bool = False,
) -> int:
    """Print what came of a photo: results on stdout, the lack of one on stderr.

    Of an estimate that was told before, as of photos that share one, only the files are told.
    """
    from facecrf_ocio.wording.expectation import expectation
    from facecrf_ocio.wording.sentence import COMMAND_LINE, sentence

    expected = expectation(estimate)
    told = estimate.confidence
    verdict = None if told is None else str(told.verdict)
    code = DONE
    if estimate.found is None:
        message = f"{path}: {estimate.outcome}: {in_options(sentence(estimate, COMMAND_LINE))}"
        code = complain(message, NOTHING)
        tell_notes(() if as_json else notes, err=True)
    elif not as_json:
        if told_before:
            say(str(path))
        else:
            tell_estimate(str(path), estimate)
        tell_notes(notes)
        if verbose and not told_before:
            tell_details(estimate)
        for file in written:
            click.echo(one_line(f"  {file}"))
    if as_json:
        tell_json(
            path,
            code,
            outcome=str(estimate.outcome),
            estimator=estimate.estimator,
            reason=estimate.reason,
            remedy=estimate.remedy,
            summary=sentence(estimate),
            expected=None if expected is None else expected.record(),
            verdict=verdict,
            differs_from_srgb=None if told is None else told.differs_from_srgb,
            energy=dict(estimate.energy),
            faces=len(estimate.faces),
            notes=list(notes),
            files=[str(file) for file in written],
        )
    return code


def tell_json(path: Path, code: int, **record: object) -> None:
    """Print one JSON object on a line of its own, in ASCII, which any stdout can hold."""
    click.echo(json.dumps({"photo": str(path), "exit_code": code, **record}))
