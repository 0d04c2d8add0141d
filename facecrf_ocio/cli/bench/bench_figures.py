"""`facecrf bench figures`: the paper's figures, drawn anew."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from facecrf_ocio.cli.bench.bench_options import estimators_option
from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.terminal import DONE, ending_well, hush_matplotlib, one_line, require_writable
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.settings import Settings

if TYPE_CHECKING:
    from facecrf_ocio.benchmark.energy_profiles import Comparison


@click.command()
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@click.option("--faces", type=PATH, metavar="DIR", help="Linear images for the curves (Fig. 7).")
@click.option("--pattern", default="*", help="Names to take from it.")
@click.option("--curves", type=PATH, metavar="FILE", help="Responses to send them through.")
@click.option(
    "--limit-curves",
    type=click.IntRange(1),
    default=2,
    show_default=True,
    help="Test so many, spread evenly.",
)
@estimators_option
@ending_well
def figures(
    output: Path,
    faces: Path | None,
    pattern: str,
    curves: Path | None,
    limit_curves: int,
    estimators: str,
) -> int:
    """Draw the paper's figures 2, 3 and 4 on a synthetic face, and 7 on linear images.

    Figure 7 needs --faces and --curves; its photos are encoded with so many of the curves in turn.
    An earlier run's figures are replaced.
    """
    hush_matplotlib()
    from facecrf_ocio.benchmark.cases import choose_estimators
    from facecrf_ocio.benchmark.energy_profiles import (
        analyzed_example,
        gamma_profile,
        highlight_profile,
    )
    from facecrf_ocio.benchmark.paper_figures import curves_figure, face_figure, png, profile_figure
    from facecrf_ocio.files.atomic import Draft, write_files
    from facecrf_ocio.response.model import dorf_model

    if (faces is None) != (curves is None):
        raise SettingsError("figure 7 needs both --faces and --curves")
    chosen = choose_estimators(estimators)
    require_writable(output)
    model, settings = dorf_model(), Settings()
    drawn = {
        "fig2_gamma.png": profile_figure(
            gamma_profile(model, settings), "camera gamma", "candidate gamma"
        ),
        "fig3_highlights.png": profile_figure(
            highlight_profile(model, settings), "strength of highlights", "candidate gamma"
        ),
        "fig4_skin.png": face_figure(analyzed_example(settings)[1], settings.hue_half_width),
    }
    if faces is not None and curves is not None:
        compared = _comparisons(faces, pattern, curves, limit_curves, chosen)
        drawn["fig7_curves.png"] = curves_figure(compared)
    output.mkdir(parents=True, exist_ok=True)
    drafts = [Draft(output / name, png(figure), lambda _: None) for name, figure in drawn.items()]
    for file in write_files(drafts, overwrite=True):
        click.echo(one_line(str(file)))
    return DONE


def _comparisons(
    faces: Path, pattern: str, curves: Path, limit_curves: int, estimators: tuple[str, ...]
) -> tuple[Comparison, ...]:
    import numpy as np

    from facecrf_ocio.benchmark.energy_profiles import compare
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses, spread_rows
    from facecrf_ocio.benchmark.virtual_camera import CameraEncoding, take_photo

    responses = read_responses(curves)
    rows = spread_rows(len(responses.inverse), limit=limit_curves)
    compared = []
    for number, image in enumerate(find_linear_images(faces, pattern).images):
        row = rows[number % len(rows)]
        truth = responses.inverse[row]
        photo = take_photo(image.read().encoded, truth, CameraEncoding(), np.random.default_rng(0))
        name = f"{image.path.stem}, {responses.names[row]}"
        compared.append(compare(name, photo, truth, estimators, Settings()))
    return tuple(compared)
