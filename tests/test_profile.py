"""What a file says of its primaries and its camera."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from hypothesis import given
from hypothesis import strategies as st
from photo_files import matrix_profile, random_codes, write
from PIL import Image, ImageCms

from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.photo.tags.named_curve import curve_of_profile
from facecrf_ocio.photo.tags.profile import primaries_from_icc


class TestPrimaries:
    @pytest.mark.parametrize("name", KNOWN_PRIMARIES)
    @pytest.mark.parametrize("version", [2, 4])
    def test_adaptation_to_d50_is_undone(self, name: str, version: int) -> None:
        red, green, blue, white = KNOWN_PRIMARIES[name]
        found = primaries_from_icc(matrix_profile(red, green, blue, white, version=version))
        assert found is not None
        assert (found.name, found.source) == (name, "ICC profile")
        assert (found.red, found.green, found.blue, found.white) == (red, green, blue, white)

    @pytest.mark.parametrize("version", [2, 4])
    def test_unknown_primaries_are_custom(self, version: int) -> None:
        red, green, blue, white = (0.62, 0.34), (0.28, 0.63), (0.16, 0.08), (0.3324, 0.3474)
        found = primaries_from_icc(matrix_profile(red, green, blue, white, version=version))
        assert found is not None
        assert found.name == "custom"
        measured = np.array([found.red, found.green, found.blue, found.white])
        assert np.allclose(measured, [red, green, blue, white], atol=5e-4)

    def test_the_profile_that_littlecms_makes(self) -> None:
        icc = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
        found = primaries_from_icc(icc)
        assert found is not None
        assert (found.name, found.red) == ("Rec.709", (0.64, 0.33))
        assert curve_of_profile(icc) == ""

    @pytest.mark.parametrize(("gamma", "linear"), [(1.0, True), (2.2, False)])
    def test_linear_profiles_are_known(self, gamma: float, linear: bool) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES["Rec.709"], gamma=gamma)
        assert (curve_of_profile(icc) == "linear") is linear

    @given(st.binary(max_size=400))
    def test_a_damaged_profile_tells_nothing(self, noise: bytes) -> None:
        assert primaries_from_icc(noise) is None
        assert curve_of_profile(noise) == ""

    @pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif"])
    def test_profile_of_a_file(self, tmp_path: Path, name: str) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES["Display P3"])
        Image.fromarray(random_codes()).save(tmp_path / name, icc_profile=icc)
        primaries = read_photo(tmp_path / name).primaries
        assert primaries is not None
        assert (primaries.name, primaries.source) == ("Display P3", "ICC profile")

    def test_exif_where_there_is_no_profile(self, tmp_path: Path) -> None:
        path = write(tmp_path / "a.jpg", random_codes(), oiio.UINT8, Exif__ColorSpace=1)
        primaries = read_photo(path).primaries
        assert primaries is not None
        assert (primaries.name, primaries.source) == ("Rec.709", "EXIF")

    def test_a_silent_file_has_none(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes()).save(tmp_path / "a.jpg")
        assert read_photo(tmp_path / "a.jpg").primaries is None

    def test_camera(self, tmp_path: Path) -> None:
        said = {"Make": "ACME", "Model": "X 1", "Software": "1.02", "Exif__BodySerialNumber": "77"}
        camera = read_photo(write(tmp_path / "a.jpg", random_codes(), oiio.UINT8, **said)).camera
        assert (camera.make, camera.model, camera.serial, camera.software) == (
            *("ACME", "X 1", "77", "1.02"),
        )
