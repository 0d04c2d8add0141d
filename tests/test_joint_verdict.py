"""What the verdict rests on: errors at codes, of the curves that remain possible."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.joint.joint_model import shipped_joint
from facecrf_ocio.joint.prior import Message
from facecrf_ocio.joint.verdict import judge
from facecrf_ocio.response.expected_stops import (
    expected_of_draws,
    rising,
    share_nearer,
    stops_of_draws,
)
from facecrf_ocio.response.model import inverse_crf

PRIOR = shipped_joint().prior


@pytest.mark.parametrize("precision", [0.0, 3.0, 300.0])
def test_the_verdict_is_that_of_whole_curves_drawn_one_by_one(precision: float) -> None:
    size = PRIOR.means.shape[1]
    message = Message(np.linspace(-0.5, 0.8, size), np.full(size, precision))
    posterior = PRIOR.posterior(message, PRIOR.weights_for("auto"))
    found = inverse_crf(PRIOR.grid, np.tile(PRIOR.samples(posterior.mean), (3, 1)))
    told, nearer = judge(posterior, found, PRIOR, 1.1)

    root = np.linalg.cholesky(posterior.covariance)
    steps = np.random.default_rng(0).standard_normal((512, size)) @ root.T
    drawn = posterior.mean + 1.1 * steps
    truths = stops_of_draws(rising(np.array([PRIOR.samples(one) for one in drawn])))
    expected = expected_of_draws(found.linear[0], truths)
    assert (told.mid, told.shadows) == pytest.approx((expected.mid, expected.shadows))
    np.testing.assert_allclose(told.sigma, expected.sigma, rtol=1e-9, atol=1e-12)
    srgb = np.where(
        found.encoded <= 0.04045, found.encoded / 12.92, ((found.encoded + 0.055) / 1.055) ** 2.4
    )
    assert nearer == pytest.approx(share_nearer(found.linear[0], srgb, truths))
