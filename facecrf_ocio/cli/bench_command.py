"""`facecrf bench`: every estimator on the same photos."""

from __future__ import annotations

import click

from facecrf_ocio.cli.bench.bench_ablations import ablations
from facecrf_ocio.cli.bench.bench_archive import archive
from facecrf_ocio.cli.bench.bench_cameras import bench_cameras
from facecrf_ocio.cli.bench.bench_consistency import consistency
from facecrf_ocio.cli.bench.bench_cues import cues
from facecrf_ocio.cli.bench.bench_figures import figures
from facecrf_ocio.cli.bench.bench_pairs import pairs
from facecrf_ocio.cli.bench.bench_peers import peers
from facecrf_ocio.cli.bench.bench_report import report
from facecrf_ocio.cli.bench.bench_speed import speed
from facecrf_ocio.cli.bench.bench_stress import stress
from facecrf_ocio.cli.bench.bench_synthetic import synthetic
from facecrf_ocio.cli.sections import Listing


@click.group(cls=Listing)
def bench() -> None:
    """Measure every estimator on the same photos, as the paper's tables do."""


_COMMANDS = (
    *(
        ablations,
        archive,
        consistency,
        cues,
        figures,
        pairs,
        peers,
        report,
        speed,
        stress,
        synthetic,
    ),
    bench_cameras,
)
for _command in _COMMANDS:
    bench.add_command(_command)
