"""The model's own workload: n0 rays, K steps, every object as likely as any other."""

import numpy as np
import pytest

from simmpp.common.errors import ConfigError
from simmpp.model.lockstep import first_steps, steps_of
from simmpp.model.synthetic import synthetic
from simmpp.workload.check import check
from simmpp.workload.workload import SHADOW


def test_is_a_workload_with_every_object_as_likely() -> None:
    workload = synthetic(4000, 10, 25)
    check(workload, "synthetic")
    assert (workload.n_rays, workload.n_tests, workload.n_objects) == (4000, 40_000, 25)
    uses = np.bincount(workload.itinerary_objects, minlength=25)
    # chi-squared with 24 degrees of freedom: mean 24, standard deviation 7
    assert ((uses - 1600) ** 2 / 1600).sum() < 24 + 5 * 7


def test_lives_are_fixed_or_geometric() -> None:
    assert steps_of(synthetic(100, 7, 5)).tests.tolist() == [100] * 7
    tests = steps_of(synthetic(50_000, 4, 5, lives="geometric")).tests
    assert tests[:4] == pytest.approx(50_000 * 0.75 ** np.arange(4), rel=0.03)


def test_a_seed_names_the_draw() -> None:
    one, same, other = (synthetic(50, 3, 9, seed=seed) for seed in (1, 1, 2))
    assert one.digest == same.digest != other.digest
    assert (one.itinerary_objects == same.itinerary_objects).all()
    assert (one.itinerary_objects != other.itinerary_objects).any()
    # Golden draws: they change only if streams or distributions do.
    assert one.itinerary_objects[:8].tolist() == GOLDEN


GOLDEN = [2, 5, 8, 3, 7, 4, 4, 0]


@pytest.mark.parametrize("numbers", [(0, 1, 1), (1, 0, 1), (1, 1, 0)])
def test_nothing_of_it_may_be_nothing(numbers: tuple[int, int, int]) -> None:
    with pytest.raises(ConfigError, match="expected 1 or more"):
        synthetic(*numbers)


def test_children_begin_after_their_parent() -> None:
    from builders import workload_of

    workload = workload_of(2, [[0, 1], [], [2], []], [0, 1], [SHADOW, SHADOW], [8, 8, 8])
    assert first_steps(workload).tolist() == [0, 0, 2, 1]
    steps = steps_of(workload)
    assert steps.tests.tolist() == [1, 1, 1]  # rays with an empty itinerary make no test
    assert steps.ended.tolist() == [1, 2, 1]
