"""Write the reference LUTs of `luts/`: python examples/make_reference_luts.py [FOLDER]."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

from facecrf_ocio.joint.prior import shipped_prior
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model, strictly_increasing
from facecrf_ocio.values import InverseCRF

CODES = np.linspace(0.0, 1.0, 4096)


def rec709(codes: np.ndarray) -> np.ndarray:
    """Inverse of the camera curve of ITU-R BT.709-6, item 1.2."""
    return np.where(codes < 0.081, codes / 4.5, ((codes + 0.099) / 1.099) ** (1 / 0.45))


def modern() -> np.ndarray:
    """Mean of the digital responses in the prior that ships."""
    prior = shipped_prior()
    mean = prior.samples(prior.weights_for("modern") @ prior.means)
    return np.interp(CODES, prior.grid, strictly_increasing([mean])[0])


# Name, where it comes from, linear light at CODES.
REFERENCES = {
    "g0": ("mean of the 201 DoRF responses, as shipped", fixed_curve("mean", CODES, dorf_model())),
    "srgb": ("IEC 61966-2-1", fixed_curve("srgb", CODES, dorf_model())),
    "rec709": ("ITU-R BT.709-6, item 1.2 (camera curve)", rec709(CODES)),
    "modern": ("mean of the published digital camera, phone and webcam responses", modern()),
    "gamma22": ("a power of 2.2", fixed_curve("gamma22", CODES, dorf_model())),
}


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, (source, linear) in REFERENCES.items():
        curve = InverseCRF(CODES, strictly_increasing([linear] * 3))
        provenance = {"Curve": name, "Source": source, "Made by": "examples/make_reference_luts.py"}
        write_lut(curve, folder / f"{name}.spi1d", overwrite=True, provenance=provenance)


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())
    main(folder)
    print(*sorted(folder.glob("*.spi1d")), sep="\n")
