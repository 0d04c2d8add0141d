"""Camera raw: linear light, whatever the file is called."""

from __future__ import annotations

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from photo_files import write_dng

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.read import read_photo


class TestCameraRaw:
    def test_a_ramp_of_light_comes_out_proportional(self, tmp_path: Path) -> None:
        light = np.tile(np.linspace(2000, 60000, 256), (64, 1))
        photo = read_photo(write_dng(tmp_path / "a.dng", light))
        ratio = photo.encoded[32, 8:-8] / light[0, 8:-8, None]
        assert np.ptp(ratio) / ratio.mean() < 1e-3
        assert photo.scene_linear
        assert photo.bit_depth is None

    def test_primaries_and_camera(self, tmp_path: Path) -> None:
        photo = read_photo(write_dng(tmp_path / "a.dng", np.full((64, 64), 30000.0)))
        assert photo.primaries is not None
        assert (photo.primaries.name, photo.primaries.source) == ("Rec.709", "camera raw decoding")
        assert (photo.camera.make, photo.camera.model) == ("Acme", "Raw One")

    @pytest.mark.parametrize("name", ["b.tif", "b.unheard", "b"])
    def test_raw_under_another_name(self, tmp_path: Path, name: str) -> None:
        write_dng(tmp_path / "a.dng", np.full((64, 64), 30000.0))
        shutil.copy(tmp_path / "a.dng", tmp_path / name)
        raw, renamed = read_photo(tmp_path / "a.dng"), read_photo(tmp_path / name)
        assert np.array_equal(raw.encoded, renamed.encoded)
        assert renamed.scene_linear

    def test_cut_short(self, tmp_path: Path) -> None:
        path = write_dng(tmp_path / "a.dng", np.full((64, 64), 30000.0))
        path.write_bytes(path.read_bytes()[:4000])
        with pytest.raises(PhotoError, match="cut short camera raw"):
            read_photo(path)

    def test_not_raw_at_all(self, tmp_path: Path) -> None:
        (tmp_path / "a.nef").write_text("not a photo" * 100)
        with pytest.raises(PhotoError, match="not camera raw"):
            read_photo(tmp_path / "a.nef")


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="no way to see where stderr leads")
def test_threads_that_read_camera_raw_leave_stderr_as_it_was(tmp_path: Path) -> None:
    """LibRaw is kept quiet meanwhile, and of two threads the second found it quiet already."""
    flat = np.full((300, 400), 9000.0)
    paths = [write_dng(tmp_path / f"{number}.dng", flat) for number in range(6)]
    before = Path("/proc/self/fd/2").readlink()
    with ThreadPoolExecutor(3) as pool:
        assert all(photo.scene_linear for photo in pool.map(read_photo, paths))
    assert Path("/proc/self/fd/2").readlink() == before
