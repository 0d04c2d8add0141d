"""`facecrf bench ablations`: the literal method with steps of it given their true answer."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH, told
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import ending_well, require_writable
from facecrf_ocio.errors import SettingsError


@click.command()
@click.option("--faces", type=PATH, metavar="DIR", help="Folder of rendered heads, linear EXR.")
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_noisy.exr'.")
@click.option(
    "--maps",
    type=PATH,
    metavar="DIR",
    help="Their truth: NAME_aux.exr with channels N.*, skin, mel, haem, albedo.*",
)
@click.option("--synthetic", "seeds", type=click.IntRange(0), default=0, help="So many more faces.")
@click.option("--curves", required=True, type=PATH, metavar="FILE", help="Responses.")
@click.option("--limit-curves", type=click.IntRange(1), help="Test so many, spread evenly.")
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@ending_well
def ablations(
    faces: Path | None,
    pattern: str,
    maps: Path | None,
    seeds: int,
    curves: Path,
    limit_curves: int | None,
    output: Path,
) -> int:
    """Give steps of the literal method their true answer, one at a time; vary lambda_p.

    Interrupted and started again with the same options and output, it goes on where it was.
    """
    from facecrf_ocio.benchmark.ablations import AblationPlan, run_ablations
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses, spread_rows
    from facecrf_ocio.benchmark.truth import rendered_head, synthetic_face

    if (faces is None) != (maps is None) or (faces is None and not seeds):
        raise SettingsError("no faces; give --faces with --maps, or --synthetic COUNT")
    responses = read_responses(curves)
    require_writable(output)
    known = []
    if faces is not None and maps is not None:
        for image in find_linear_images(faces, pattern).images:
            stem = image.path.stem.removesuffix("_noisy").removesuffix("_clean")
            known.append(rendered_head(image.path, maps / f"{stem}_aux.exr"))
    known += [synthetic_face(seed) for seed in range(seeds)]
    rows = spread_rows(len(responses.inverse), limit=limit_curves)
    with counting("cases", plainly=True) as tell:
        text, files = run_ablations(AblationPlan(tuple(known), responses, rows), output, tell)
    return told(text, files)
