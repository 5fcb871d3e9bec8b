"""The rung ``curve``: exact where nothing is drawn, within its errors of many seeds elsewhere."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from simmpp.common.errors import ConfigError
from simmpp.engine.simulate import simulate
from simmpp.machine.presets import machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.run.profit import ratio
from simmpp.studies.curve.estimate import Estimate, estimate, node_fractions, share_of
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import Workload

MACHINE = machine("t3e", {}, 8)
POLICIES = [PolicyParameters(name) for name in ("concurrent", "object", "ray", "replicated")]
FRACTIONS = [Fraction(1, 8), Fraction(1, 3), Fraction(3, 5), Fraction(9, 10), Fraction(1)]


@pytest.fixture(scope="module")
def workload() -> Workload:
    return trace(load_scene("tetra:3"), Picture(resolution=32))


@pytest.fixture(scope="module")
def found(workload: Workload) -> dict[tuple[str, Fraction], Estimate]:
    rows = estimate(workload, MACHINE, POLICIES, FRACTIONS)
    return {(row.policy, row.fraction): row for row in rows}


def simulated(workload: Workload, policy: str, x: Fraction, seed: int) -> tuple[float, float]:
    placement = place(workload, 8, Memory(fraction=x), PlacementRules(), seed)
    runs = [simulate(workload, MACHINE, placement, PolicyParameters(p)) for p in ("object", policy)]
    return ratio(*(run.makespan_ps for run in runs)), ratio(*(run.messages for run in runs))


@pytest.mark.parametrize("policy", ["concurrent", "object", "ray", "replicated"])
@pytest.mark.parametrize("x", [Fraction(1, 8), Fraction(1)])
def test_it_is_exact_where_nothing_is_drawn(
    workload: Workload, found: dict[tuple[str, Fraction], Estimate], policy: str, x: Fraction
) -> None:
    row = found[policy, x]
    time, messages = simulated(workload, policy, x, seed=5)
    assert row.time_profit == pytest.approx(time, rel=1e-12)
    assert row.message_profit == pytest.approx(messages, rel=1e-12)
    assert row.time_error == row.message_error == 0


@pytest.mark.parametrize("policy", ["concurrent", "ray"])
@pytest.mark.parametrize("x", [Fraction(1, 3), Fraction(3, 5), Fraction(9, 10)])
def test_the_mean_of_many_seeds_is_within_its_errors(
    workload: Workload, found: dict[tuple[str, Fraction], Estimate], policy: str, x: Fraction
) -> None:
    row = found[policy, x]
    logs = np.log([simulated(workload, policy, x, seed) for seed in range(30)])
    means, spread = np.exp(logs.mean(axis=0)), logs.std(axis=0) / np.sqrt(30)
    assert abs(row.time_profit - means[0]) < 3 * np.hypot(row.time_error, means[0] * spread[0])
    assert abs(row.message_profit - means[1]) < 3 * np.hypot(
        row.message_error, means[1] * spread[1]
    )


def test_object_dataflow_gains_nothing_over_itself_for_sure(
    found: dict[tuple[str, Fraction], Estimate],
) -> None:
    for x in FRACTIONS:
        assert found["object", x] == Estimate("object", x, 1.0, 0.0, 1.0, 0.0)


def test_other_fractions_wanted_change_nothing(
    workload: Workload, found: dict[tuple[str, Fraction], Estimate]
) -> None:
    wanted = [Fraction(3, 5), Fraction(1, 8)]
    for row in estimate(workload, MACHINE, POLICIES[:1], wanted):
        other = found["concurrent", row.fraction]
        assert row.time_profit == pytest.approx(other.time_profit, rel=1e-12)


def test_replicates_make_it_surer(
    workload: Workload, found: dict[tuple[str, Fraction], Estimate]
) -> None:
    rows = estimate(workload, MACHINE, POLICIES[:1], FRACTIONS[:4], replicates=4)
    fewer = [found["concurrent", x].time_error for x in FRACTIONS[:4]]
    assert sum(row.time_error for row in rows) < 0.75 * sum(fewer)


def test_nodes_start_at_the_least_fraction_and_keep_apart() -> None:
    assert node_fractions(Fraction(1, 64))[:2] == [Fraction(1, 64), Fraction(1, 10)]
    assert node_fractions(Fraction(7, 100))[:2] == [Fraction(7, 100), Fraction(1, 5)]
    assert node_fractions(Fraction(1)) == [Fraction(1)]


@pytest.mark.parametrize(
    ("fraction", "n_objects", "expected"),
    [
        (Fraction(1, 2), 5, 3 / 5),
        (Fraction(0), 5, 1 / 4),
        (Fraction(1), 5, 1.0),
        (Fraction(0), 0, 1.0),
    ],
)
def test_share(fraction: Fraction, n_objects: int, expected: float) -> None:
    assert share_of(fraction, n_objects, 4) == expected


def test_one_processor_has_nothing_to_gain(workload: Workload) -> None:
    rows = estimate(workload, machine("t3e", {}, 1), POLICIES[:1], [Fraction(1, 10)])
    assert rows == [Estimate("concurrent", Fraction(1, 10), 1.0, 0.0, 1.0, 0.0)]


OUT_OF_RANGE = "curve: expected fractions from 0 to 1, and 1 replicate or more"
DRAWN = "curve: random owners or pixels: expected residents alone to be drawn"


@pytest.mark.parametrize(
    ("wrong", "problem"),
    [
        ({"fractions": []}, OUT_OF_RANGE),
        ({"fractions": [Fraction(-1, 2)]}, OUT_OF_RANGE),
        ({"fractions": [Fraction(3, 2)]}, OUT_OF_RANGE),
        ({"replicates": 0}, OUT_OF_RANGE),
        ({"rules": PlacementRules(pixels="random")}, DRAWN),
        ({"rules": PlacementRules(owners="random")}, DRAWN),
    ],
)
def test_what_it_cannot_do_is_refused(
    workload: Workload, wrong: dict[str, object], problem: str
) -> None:
    arguments = {"fractions": FRACTIONS} | wrong
    with pytest.raises(ConfigError, match=f"^{problem}$"):
        estimate(workload, MACHINE, POLICIES[:1], **arguments)  # type: ignore[arg-type]
