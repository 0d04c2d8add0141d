"""Where the estimator looks: a fixed number of pixels, from edge to edge, in step with JPEG."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.joint.windows import SIDE, face_windows, photo_windows

sizes = st.integers(1, 9000)


@given(sizes, sizes)
def test_windows_lie_in_the_photo_and_begin_where_blocks_do(height, width):
    for rows, columns in photo_windows(height, width):
        assert 0 <= rows.start < rows.stop <= height
        assert 0 <= columns.start < columns.stop <= width
        assert rows.start % 16 == columns.start % 16 == 0


@given(sizes, sizes)
def test_their_pixels_are_few_however_large_the_photo(height, width):
    pixels = sum((r.stop - r.start) * (c.stop - c.start) for r, c in photo_windows(height, width))
    assert pixels <= 9 * SIDE**2
    if max(height, width) <= 3 * SIDE:
        assert pixels == height * width


def test_the_first_and_the_last_window_reach_the_edges():
    windows = photo_windows(4000, 6000)
    assert len(windows) == 9
    assert (windows[0][0].start, windows[0][1].start) == (0, 0)
    assert 4000 - windows[-1][0].stop < 16
    assert 6000 - windows[-1][1].stop < 16


def test_a_large_face_is_seen_inside_and_a_small_one_whole():
    points = np.array([[1000.0, 1000.0, 0.0], [3000.0, 3400.0, 0.0]])
    windows = face_windows(points, 4000, 5000)
    assert len(windows) == 4
    assert all(1000 < r.start < r.stop < 3400 for r, _ in windows)
    small = face_windows(points / 10.0, 400, 500)
    assert [(r.stop, c.stop) for r, c in small] == [(340, 300)]


def test_a_face_cut_by_the_edge_has_windows_in_the_photo():
    points = np.array([[-50.0, -20.0, 0.0], [150.0, 180.0, 0.0]])
    assert face_windows(points, 100, 120) == [(slice(0, 100), slice(0, 120))]
