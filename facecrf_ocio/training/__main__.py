"""Train `joint`: `python -m facecrf_ocio.training --help`.

First `simulate`, once for each part of the heads, then `fit` from what the parts stored.
"""

from __future__ import annotations

import pickle
from pathlib import Path

import click
import cv2
import numpy as np

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
@click.option("--rows", default=201, show_default=True, help="Responses in DoRF.")
@click.option("--epochs", default=20, show_default=True)
@click.option("--members", default=3, show_default=True)
@click.option("--band-scale", default=1.0, show_default=True, help="As `JointModel` explains.")
@click.option("-o", "--output", required=True, type=click.Path(path_type=Path))
def fit_command(
    parts: tuple[Path, ...],
    fold: int | None,
    rows: int,
    epochs: int,
    members: int,
    band_scale: float,
    output: Path,
) -> None:
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
    if fold is not None:
        seen = rows_outside(fold, rows)
        examples = [e for e in examples if e.family or seen[e.row]]
    prior, analysis = fit_prior(
        np.array([e.inverse for e in examples], dtype=np.float64),
        np.array([e.family for e in examples]),
    )
    training = Training(epochs=epochs, members=members)
    networks = [fit_networks(examples, prior, analysis, training, seed) for seed in range(members)]
    save_joint(output, prior, networks, band_scale)


if __name__ == "__main__":
    main()
