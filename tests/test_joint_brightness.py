"""Of how bright midtones are, cues of one photo are believed less than they claim."""

from __future__ import annotations

import numpy as np
import pytest
from test_joint_prior import MESSAGE, PRIOR

from facecrf_ocio.joint.brightness import less_sure
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior, Message, Posterior

BELIEVED = {"dorf": 1.0, "camera": 0.35, "phone": 0.35}  # as the page of evidence has it
SURE = Message(np.array([3.0, -0.3]), np.array([40.0, 0.7]))


def alone(component: int) -> FamilyPrior:
    """The prior's mixture with one of its components."""
    one = slice(component, component + 1)
    return FamilyPrior(
        PRIOR.grid,
        PRIOR.mean,
        PRIOR.basis,
        np.ones(1),
        PRIOR.means[one],
        PRIOR.covariances[one],
        PRIOR.family[one],
    )


@pytest.mark.parametrize("message", [MESSAGE, SURE])
@pytest.mark.parametrize("component", range(3))
def test_it_is_the_product_with_a_message_that_claims_less(component, message):
    prior = alone(component)
    found = less_sure(prior.posterior(message, np.ones(1)), message, prior.family)
    share = np.array([BELIEVED[FAMILIES[component]], 1.0])
    wanted = prior.posterior(Message(message.mean, share * message.precision), np.ones(1))
    assert np.allclose(found.means, wanted.means, rtol=1e-9)
    assert np.allclose(found.covariances, wanted.covariances, rtol=1e-9)


def test_film_s_components_and_all_weights_stay():
    before = PRIOR.posterior(SURE, PRIOR.weights)
    found = less_sure(before, SURE, PRIOR.family)
    assert np.array_equal(found.weights, before.weights)
    assert np.array_equal(found.means[0], before.means[0])
    assert np.array_equal(found.covariances[0], before.covariances[0])


def test_the_brightness_of_cameras_goes_back_toward_the_prior_and_is_less_sure():
    before = PRIOR.posterior(SURE, PRIOR.weights)
    found = less_sure(before, SURE, PRIOR.family)
    for camera in (1, 2):
        between = sorted([before.means[camera, 0], PRIOR.means[camera, 0]])
        assert between[0] < found.means[camera, 0] < between[1]
        assert found.covariances[camera, 0, 0] > before.covariances[camera, 0, 0]


def test_covariances_stay_covariances_however_sure_the_message():
    message = Message(np.array([0.3, 0.1]), np.array([400.0, 400.0]))
    found = less_sure(PRIOR.posterior(message, PRIOR.weights), message, PRIOR.family)
    assert isinstance(found, Posterior)
    assert (np.linalg.eigvalsh(found.covariances) > 0.0).all()
