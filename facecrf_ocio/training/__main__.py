"""Train `joint`: `python -m facecrf_ocio.training --help`.

First `simulate`, once for each part of the heads, then `fit` from what the parts stored.
"""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import click
import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.training.curves import FOLDS, read_curves, rows_outside
from facecrf_ocio.training.simulate import Example, simulate


@click.group()
def main() -> None:
    """Make the weights of the joint estimator."""


@main.command("simulate")
@click.argument("heads", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--dorf", required=True, type=click.Path(path_type=Path))
@click.option("--modern", required=True, type=click.Path(path_type=Path))
@click.option("--count", default=500, show_default=True, help="Photos of each head.")
@click.option("--seed", default=0, show_default=True)
@click.option("-o", "--output", required=True, type=click.Path(path_type=Path))
def simulate_command(
    heads: tuple[Path, ...], dorf: Path, modern: Path, count: int, seed: int, output: Path
) -> None:
    """Photograph linear HEADS through drawn responses and store their statistics."""
    cv2.setNumThreads(1)
    source = read_curves(dorf, modern)
    examples = [example for head in heads for example in simulate(head, source, count, seed)]
    output.write_bytes(pickle.dumps(examples))


@main.command("fit")
@click.argument("parts", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--fold", type=click.IntRange(0, FOLDS - 1), help="Fold of DoRF to hold out.")
@click.option("--without", multiple=True, metavar="MAKER", help="Modern maker to hold out.")
@click.option("--modern", type=click.Path(path_type=Path), help="The file that names the makers.")
@click.option("--rows", default=201, show_default=True, help="Responses in DoRF.")
@click.option("--epochs", default=20, show_default=True)
@click.option("--members", default=3, show_default=True)
@click.option("--band-scale", default=1.0, show_default=True, help="As `JointModel` explains.")
@click.option("-o", "--output", required=True, type=click.Path(path_type=Path))
def fit_command(parts: tuple[Path, ...], output: Path, **choices: Any) -> None:
    """Fit prior and networks to the PARTS that `simulate` stored (only load your own files)."""
    import torch  # noqa: PLC0415

    from facecrf_ocio.training.fit import (  # noqa: PLC0415
        Training,
        fit_networks,
        fit_prior,
        save_joint,
    )

    torch.set_num_threads(1)
    examples: list[Example] = []
    for part in parts:
        examples += pickle.loads(part.read_bytes())  # noqa: S301
    examples = _kept(examples, **choices)
    prior, analysis = fit_prior(
        np.array([e.inverse for e in examples], dtype=np.float64),
        np.array([e.family for e in examples]),
    )
    training = Training(epochs=choices["epochs"], members=choices["members"])
    networks = [
        fit_networks(examples, prior, analysis, training, seed) for seed in range(training.members)
    ]
    save_joint(output, prior, networks, choices["band_scale"])


def _kept(
    examples: list[Example],
    *,
    fold: int | None,
    rows: int,
    without: tuple[str, ...],
    modern: Path | None,
    **_: object,
) -> list[Example]:
    """The examples of responses that are not held out."""
    if fold is not None:
        examples = _leave_out(examples, 0, ~rows_outside(fold, rows))
    if not without:
        return examples
    if modern is None:
        raise click.UsageError("--without needs --modern, the file that names the makers")
    with np.load(modern) as stored:
        return _leave_out(examples, 1, np.isin(stored["maker"], without))


def _leave_out(examples: list[Example], family: int, rows: npt.NDArray[np.bool_]) -> list[Example]:
    """All but the examples that hold one of these responses of a family, alone or mixed."""
    held_out = set(np.flatnonzero(rows))
    return [e for e in examples if e.family != family or not held_out & {e.row, e.mixed_with}]


if __name__ == "__main__":
    main()
