"""`facecrf bench speed`: how long it takes to linearize."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.terminal import DONE, ending_well


@click.command()
@click.option("--lut", type=PATH, metavar="FILE", help="By default the sRGB curve.")
@click.option("--megapixels", type=click.FloatRange(0.01, 150), default=24, show_default=True)
@click.option("--repeat", type=click.IntRange(1), default=5, show_default=True)
@ending_well
def speed(lut: Path | None, megapixels: float, repeat: int) -> int:
    """Time linearization beside OpenColorIO's and OpenImageIO's own calls, and decode + write."""
    import tempfile

    import numpy as np

    from facecrf_ocio.benchmark.speed import measure_speed
    from facecrf_ocio.lut.write import write_lut
    from facecrf_ocio.response.fixed import fixed_curve
    from facecrf_ocio.response.model import CURVE_SIZE, dorf_model, strictly_increasing
    from facecrf_ocio.values import InverseCRF

    with tempfile.TemporaryDirectory(prefix="facecrf-") as folder:
        if lut is None:
            encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
            curve = strictly_increasing([fixed_curve("srgb", encoded, dorf_model())] * 3)
            lut = write_lut(InverseCRF(encoded, curve), Path(folder) / "srgb.spi1d")
        click.echo(measure_speed(lut, megapixels, repeat).text)
    return DONE
