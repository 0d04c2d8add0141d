"""Arrays of .npz files are read as NumPy reads them."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

import facecrf_ocio
from facecrf_ocio.files.stored_arrays import load_arrays

ROOT = Path(facecrf_ocio.__file__).parent
ARRAYS = {
    "scalar": np.float64(2.5),
    "rows": np.arange(12, dtype=np.int8).reshape(3, 4),
    "columns": np.asfortranarray(np.arange(6.0).reshape(2, 3)),
    "empty": np.zeros((0, 4), np.float32),
    "names": np.array(["gray", "skin"]),
}


def assert_same_as_numpy(path: Path) -> None:
    with np.load(path) as stored:
        expected = {name: stored[name] for name in stored}
    found = load_arrays(path)
    assert list(found) == list(expected)
    for name, array in expected.items():
        assert found[name].dtype == array.dtype
        assert found[name].shape == array.shape
        np.testing.assert_array_equal(found[name], array)


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_are_those_that_numpy_reads(save, tmp_path: Path) -> None:
    save(tmp_path / "a.npz", **ARRAYS)
    assert_same_as_numpy(tmp_path / "a.npz")


def test_the_shipped_weights_are_those_that_numpy_reads() -> None:
    assert_same_as_numpy(ROOT / "joint" / "joint_model.npz")


def test_cannot_be_written_to(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", **ARRAYS)
    with pytest.raises(ValueError, match="read-only"):
        load_arrays(tmp_path / "a.npz")["rows"][:] = 0


def test_a_changed_byte_is_damage(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, **ARRAYS)
    whole = bytearray(path.read_bytes())
    whole[whole.index(ARRAYS["rows"].tobytes()) + 3] ^= 1
    path.write_bytes(whole)
    with pytest.raises(zipfile.BadZipFile, match="rows"):
        load_arrays(path)
