"""Statistics of a photo: their quantiles are NumPy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from facecrf_ocio.joint.statistics import quantiles_of

SHARES = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=5)
VALUES = arrays(np.float64, array_shapes(max_dims=2, max_side=40), elements=st.floats(-1e9, 1e9))


@given(VALUES, SHARES)
def test_quantiles_are_those_of_numpy_to_the_last_bit(values, shares):
    found = np.moveaxis(quantiles_of(values, shares), -1, 0)
    assert np.array_equal(found, np.quantile(values, shares, axis=-1))
