"""Matrices to working spaces, against OpenColorIO's built-in ACES config."""

from __future__ import annotations

from itertools import product

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813
import pytest

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.color.working_space import WORKING_SPACES, working_space_matrix
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.values import Primaries

# OCIO's names for our primaries and working spaces.
SOURCES = {
    "Rec.709": "Linear Rec.709 (sRGB)",
    "Display P3": "Linear P3-D65",
    "Rec.2020": "Linear Rec.2020",
}
SPACES = {
    "acescg": "ACEScg",
    "lin_rec709": "Linear Rec.709 (sRGB)",
    "lin_p3d65": "Linear P3-D65",
    "aces2065-1": "ACES2065-1",
}


def ocio_matrix(source: str, target: str) -> np.ndarray:
    config = ocio.Config.CreateFromBuiltinConfig("studio-config-v1.0.0_aces-v1.3_ocio-v2.1")
    pixels = np.eye(3, dtype=np.float32)
    config.getProcessor(source, target).getDefaultCPUProcessor().applyRGB(pixels)
    return pixels.T


@pytest.mark.parametrize(("source", "name"), list(product(SOURCES, WORKING_SPACES)))
def test_the_matrix_is_that_of_ocios_own_config(source: str, name: str) -> None:
    matrix = working_space_matrix(known_primaries(source, "test"), name)
    expected = ocio_matrix(SOURCES[source], SPACES[name])
    np.testing.assert_allclose(matrix, expected, rtol=0, atol=2e-6)


@pytest.mark.parametrize("name", WORKING_SPACES)
@pytest.mark.parametrize("source", [*SOURCES, "Adobe RGB", "ProPhoto"])
def test_white_stays_white(source: str, name: str) -> None:
    matrix = working_space_matrix(known_primaries(source, "test"), name)
    np.testing.assert_allclose(matrix.sum(axis=1), 1.0, atol=1e-12)


@pytest.mark.parametrize("name", WORKING_SPACES)
def test_unknown_primaries_stand_for_rec709(name: str) -> None:
    np.testing.assert_array_equal(
        working_space_matrix(None, name),
        working_space_matrix(known_primaries("Rec.709", "test"), name),
    )


def test_a_space_to_itself_is_the_identity() -> None:
    np.testing.assert_array_equal(working_space_matrix(None, "lin_rec709"), np.eye(3))


def test_bad_requests_are_refused() -> None:
    with pytest.raises(SettingsError, match="no working space 'acescc'; known: acescg"):
        working_space_matrix(None, "acescc")
    flat = Primaries("custom", (0.3, 0.3), (0.3, 0.3), (0.3, 0.3), (0.3127, 0.329), "ICC profile")
    with pytest.raises(SettingsError, match="span no color space"):
        working_space_matrix(flat, "acescg")
