"""Curves are stored as differences of their bits, exactly."""

from __future__ import annotations

import zlib

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from facecrf_ocio.files.smooth_arrays import SMOOTH, smooth_array, smooth_bytes

FLOATS = st.floats(width=32, allow_nan=True, allow_infinity=True)


def restored(values):
    return smooth_array({f"a{SMOOTH}": smooth_bytes(values)}, "a")


@given(arrays(np.float32, array_shapes(max_dims=3, max_side=6), elements=FLOATS))
def test_every_bit_comes_back(values):
    found = restored(values)
    assert found.dtype == np.float32
    assert found.shape == values.shape
    assert found.tobytes() == values.tobytes()


def test_the_lowest_bytes_come_first_and_the_first_number_is_whole():
    one, next_one = np.float32(1.0), np.nextafter(np.float32(1.0), np.float32(2.0))
    assert smooth_bytes(np.array([one, next_one])).tolist() == [[0, 1], [0, 0], [128, 0], [63, 0]]


def test_double_precision_becomes_single():
    values = np.linspace(-1.0, 1.0, 7) ** 3
    np.testing.assert_array_equal(restored(values), values.astype(np.float32))


def test_arrays_of_older_files_are_taken_as_they_are():
    values = np.arange(3.0)
    assert smooth_array({"a": values}, "a") is values


def test_a_curve_becomes_a_third_smaller_in_a_wheel():
    curve = (np.linspace(0.0, 1.0, 1024) ** 2.2).astype(np.float32)
    packed, plain = (len(zlib.compress(part.tobytes())) for part in (smooth_bytes(curve), curve))
    assert packed < plain * 2 / 3
