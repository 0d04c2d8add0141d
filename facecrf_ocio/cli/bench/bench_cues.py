"""`facecrf bench cues`: what each cue of `joint` earns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.bench.bench_options import prior_option
from facecrf_ocio.cli.bench.bench_plan import plan
from facecrf_ocio.cli.bench.bench_terminal import PATH, told
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import ending_well, require_writable


@click.command()
@click.option("--faces", required=True, type=PATH, metavar="DIR", help="Linear images.")
@click.option("--pattern", default="*", help="Names to take from it.")
@click.option("--curves", required=True, type=PATH, metavar="FILE", help="Responses.")
@click.option("--limit-curves", type=click.IntRange(1), help="Test so many, spread evenly.")
@click.option(
    "--protocol",
    type=click.Choice(["held-out", "paper"]),
    default="held-out",
    help="What the prior has seen: not the tested curve's fold, or all.",
)
@prior_option
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@ending_well
def cues(output: Path, **choices: Any) -> int:
    """Leave out each cue of joint, ask each alone, and put the photos of a camera together."""
    from facecrf_ocio.benchmark.cue_shares import run_cues

    unused: dict[str, Any] = {"estimators": "joint", "assignments": (), "every": 1, "folds": 5}
    camera: dict[str, Any] = {"bits": 8, "jpeg": None, "noise": None, "seed": 0}
    asked = plan(**unused, **camera, **choices)
    require_writable(output)
    output.mkdir(parents=True, exist_ok=True)
    with counting("cases", plainly=True) as tell:
        text, files = run_cues(asked, output, tell)
    return told(text, files)
