"""Computing on PEs that are not alike, worked out by hand; the costs are those of ``by_hand``.

A request that PE 0 sends at t brings the object at t + 504, unpacked.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import Case, cases
from by_hand import OBJECT, RAY, case_of
from hypothesis import given, settings
from implementations import IMPLEMENTATIONS, SEED, result_of, run

from simmpp.common.randomness import key
from simmpp.machine.noise import ONE, factors
from simmpp.machine.uneven import Straggler
from simmpp.workload.workload import CONE, SPHERE

FETCH: Any = (OBJECT, [(0, [0, 1])])
"""A test of PE 0's own object, then one of PE 1's."""


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize(
    ("machine", "makespan_ps", "compute_ps"),
    [
        # as on the machine of by_hand: 1 + 1000, + 504, + 1 + 1500
        ({}, 3006, 2500),
        # two goes at computing
        ({"compute_startup_ps": 100}, 3206, 2700),
        # 1000 / 3 = 333 and 1500 / 3 = 500
        ({"speed": (("0", "3"),)}, 1 + 333 + 504 + 1 + 500, 833),
        ({"speed": (("50%", "3"), ("50%", "1/3"))}, 1339, 833),
        ({"speed": (("1", "9"),)}, 3006, 2500),
        # 1000 * 2 / 7 = 286 and 1500 * 2 / 7 = 429, up from 428.6
        ({"speed": (("0-1", "7/2"),)}, 1 + 286 + 504 + 1 + 429, 715),
        # each go has one test: it takes as long as 4
        ({"least_tests": 4}, 1 + 4000 + 504 + 1 + 4500, 8500),
        ({"least_tests": 1}, 3006, 2500),
        # startup is not scaled: 100 + 4000 / 2, 100 + (4000 + 500) / 2
        (
            {"compute_startup_ps": 100, "least_tests": 4, "speed": (("0", "2"),)},
            1 + 2100 + 504 + 1 + 2350,
            4450,
        ),
        # the go that begins at 1505 is late, the one at 0 is not
        ({"straggler": Straggler(0, "5/2", 1505, 1506)}, 1505 + 1 + 3750, 4750),
        ({"straggler": Straggler(0, "5/2", 1, 1505)}, 3006, 2500),
        ({"straggler": Straggler(1, "5/2")}, 3006, 2500),
    ],
)
def test_a_fetch(
    implementation: str, machine: dict[str, Any], makespan_ps: int, compute_ps: int
) -> None:
    outcome = run(implementation, case_of(*FETCH, **machine))
    assert outcome.makespan_ps == makespan_ps
    assert outcome.compute_ps == [compute_ps, 0]
    assert outcome.communication_ps[0] == 1 + 12 + 77 + 1


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_too_few_tests_are_as_many_of_their_mean_cost(implementation: str) -> None:
    # 1000 and 154: five of 577, then the ray; with a quantum of one test five of each
    both: dict[str, Any] = {"owners": (0, 0), "object_kinds": (SPHERE, CONE), "least_tests": 5}
    outcome = run(implementation, case_of(*FETCH, **both))
    assert outcome.makespan_ps == 1 + 5 * 577 + 500
    outcome = run(implementation, case_of(*FETCH, **both, quantum=1))
    assert outcome.makespan_ps == 1 + 5 * 1000 + 1 + 5 * 154 + 500


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_the_owner_of_an_object_may_be_late(implementation: str) -> None:
    # PE 1 has the ray at 207, and computes from 208
    rays: Any = (RAY, [(0, [1])])
    late = case_of(*rays, straggler=Straggler(1, "3", 207, 208))
    assert run(implementation, late).makespan_ps == 208 + 4500
    assert run(implementation, case_of(*rays)).makespan_ps == 208 + 1500


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_each_go_draws_its_noise(implementation: str) -> None:
    def factor(go: int) -> int:
        bits = np.random.Philox(key=[key(SEED, "noise"), 0], counter=go)
        return factors("1/2")[int(bits.random_raw()) >> 56]

    first_ps, second_ps = (round(cost * factor(go) / ONE) for go, cost in enumerate((1000, 1500)))
    assert (first_ps, second_ps) != (1000, 1500)
    outcome = run(implementation, case_of(*FETCH, noise="1/2"))
    assert outcome.makespan_ps == 1 + first_ps + 504 + 1 + second_ps


def test_accounts_and_bound() -> None:
    machine = {"compute_startup_ps": 100, "least_tests": 4, "speed": (("0", "2"),)}
    result = result_of("compiled", case_of(*FETCH, **machine))
    assert result.launch_ps.tolist() == [100 + 1500 + 100 + 1500, 0]
    assert (result.work_ps, result.bound_ps) == (2500, 834)  # 2500 / (2 + 1)
    plain = result_of("compiled", case_of(*FETCH))
    assert plain.launch_ps.tolist() == [0, 0]
    assert (plain.work_ps, plain.bound_ps) == (2500, 1250)


@given(case=cases())
@settings(max_examples=30, deadline=None, derandomize=True)
def test_twice_as_fast_is_half_the_cost(case: Case) -> None:
    """Of all PEs, and whatever else is uneven but what rounds before."""
    machine = replace(case.machine, least_tests=0, speed=())
    costs = {name: 2 * cost_ps for name, cost_ps in vars(machine.test).items()}
    slow = replace(machine, test=replace(machine.test, **costs), ray_ps=2 * machine.ray_ps)
    fast = replace(slow, speed=(("100%", "2"),))
    one, other = (run("compiled", replace(case, machine=of)) for of in (machine, fast))
    assert one == other
