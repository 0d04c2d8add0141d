"""The main job on a real portrait that an installed package brings along."""

from __future__ import annotations

from pathlib import Path

import matplotlib.cbook

from facecrf_ocio import __version__
from facecrf_ocio.apply import linearize_photo, write_exr
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.export import write_outputs
from facecrf_ocio.read import read_photo
from facecrf_ocio.report.plot import write_plot
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Estimate


def run_demo(folder: Path) -> tuple[Path, Estimate, tuple[Path, ...]]:
    """Calibrate and linearize matplotlib's portrait of Grace Hopper (US Navy, public domain).

    Returns
    -------
    tuple
        The portrait's file, the estimate, and the files written: LUTs, sidecar, EXR and plot.
    """
    settings = Settings()
    portrait = Path(str(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)))
    photo = read_photo(portrait)
    estimate = calibrate(photo, settings=settings)
    files = write_outputs(photo, estimate, settings, folder, overwrite=True)
    exr = write_exr(
        folder / "grace_hopper.exr",
        linearize_photo(photo, estimate.curve),
        photo,
        provenance={
            "estimator": estimate.estimator,
            "outcome": str(estimate.outcome),
            "version": __version__,
        },
        overwrite=True,
    )
    plot = write_plot(folder / "grace_hopper.png", photo, estimate, settings, overwrite=True)
    return portrait, estimate, (*files, exr, plot)
