"""The main job on a real portrait that an installed package brings along."""

from __future__ import annotations

from pathlib import Path

import matplotlib.cbook

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.plots.calibration_plot import plot_draft
from facecrf_ocio.record.output_names import EXR, PLOT, output_path
from facecrf_ocio.record.outputs import write_outputs
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Estimate


def run_demo(folder: Path) -> tuple[Path, Estimate, tuple[Path, ...]]:
    """Calibrate and linearize matplotlib's portrait of Grace Hopper (US Navy, public domain).

    Parameters
    ----------
    folder
        Where to write; made if it is missing. Files of an earlier demo are replaced.

    Returns
    -------
    tuple
        The portrait's file, the estimate, and the files written: LUTs, record, plot and EXR.

    Raises
    ------
    OutputError
        If the files cannot be written.
    """
    settings = Settings()
    portrait = Path(str(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)))
    photo = read_photo(portrait)
    estimate = calibrate(photo, settings=settings)
    plot = plot_draft(output_path(folder, portrait, PLOT), photo, estimate, settings)
    files = write_outputs(photo, estimate, settings, folder, overwrite=True, also=[plot])
    exr = write_linear(output_path(folder, portrait, EXR), photo, estimate, overwrite=True)
    return portrait, estimate, (*files, exr.path)
