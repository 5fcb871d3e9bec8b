"""What of a capacity is for what, and capacities that can't be."""

from __future__ import annotations

from dataclasses import replace

import pytest
from builders import random_case, with_capacity

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.common.units import format_bytes
from simmpp.config.config import config_from_mapping
from simmpp.engine.capacity import fits, needs_of, split
from simmpp.placement.rooms import Capacity
from simmpp.run.fitting import fittings, require_fitting, told
from simmpp.run.inputs import workload_of
from simmpp.run.point import make_point, run_point
from simmpp.run.summary import measures
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.worker import run_task

SETTINGS = {"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 4, "reading": "plain"}


def test_parts_fill_the_capacity() -> None:
    for seed in range(40):
        case = with_capacity(random_case(seed), seed, flow="credits")
        needs = needs_of(case.workload, case.machine, case.placement, case.policy)
        bounds = case.placement.capacity
        assert bounds is not None
        for more in (0, 1, 7, 500, 501, 10**6, 1 << 50):
            total = needs.least_bytes + more
            parts = split(needs, bounds, total)
            used = needs.permanent + parts.receive + parts.fetch + parts.queue + parts.replicas
            assert (used == total).all(), seed
            assert (parts.queue >= needs.tree).all(), seed
            assert (parts.receive >= needs.receive).all(), seed
            assert (parts.fetch >= 0).all(), seed


def test_what_fits_fits_into_more() -> None:
    case = with_capacity(random_case(3), 3, flow="credits")
    needs = needs_of(case.workload, case.machine, case.placement, case.policy)
    for capacity, does in ((needs.least_bytes - 1, False), (needs.least_bytes, True)):
        placement = replace(case.placement, capacity=Capacity(capacity))
        assert fits(needs, placement, 0) is does


@pytest.mark.parametrize(
    ("capacity", "said"),
    [
        ("1 kB", "value '1 kB', which is less on 4 PEs than the scene's 32.768 kB: expected at"),
        ("8500 B", "value '8.5 kB': expected at least 8.664 kB for object"),
    ],
)
def test_a_capacity_that_can_not_be_is_refused_with_the_least(capacity: str, said: str) -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:4"), simmpp.Picture(resolution=8))
    machine = simmpp.make_machine(processors=4)
    memory = simmpp.Memory(capacity=capacity)
    placement = simmpp.place(workload, 4, memory, simmpp.PlacementRules(), 0)
    with pytest.raises(ConfigError, match=f"memory.capacity: {said}"):
        simmpp.simulate(workload, machine, placement, "object")


@pytest.mark.parametrize(
    ("machine", "policy", "said"),
    [
        (
            {"service": "thread"},
            {},
            "memory.capacity: expected machine.service pe beside it, got thread",
        ),
        ({}, {"merge_requests": False}, "memory.capacity: expected merge_requests: true"),
    ],
)
def test_what_can_not_be_combined_is_refused(
    machine: dict[str, str], policy: dict[str, bool], said: str
) -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:2"), simmpp.Picture(resolution=8))
    memory = simmpp.Memory(capacity="1 MB")
    placement = simmpp.place(workload, 4, memory, simmpp.PlacementRules(), 0)
    here = simmpp.make_machine("t3e", machine, processors=4)
    with pytest.raises(ConfigError, match=said):
        simmpp.simulate(workload, here, placement, simmpp.PolicyParameters("object", **policy))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("machine.service=nic", "value '1 MB': expected machine.service pe beside it, got nic"),
        ("policy.merge_requests=false", "expected merge_requests: true beside it, for object"),
    ],
)
def test_commands_refuse_it_with_its_place_before_anything_runs(more: str, said: str) -> None:
    given = ("memory.capacity=1 MB", more)
    config = config_from_mapping(SETTINGS | {"policy": ["object"]}, given)
    with pytest.raises(ConfigError, match=f"^--set memory.capacity: .*{said}"):
        make_point(config, workload_of(config))
    with pytest.raises(ConfigError, match=f"^--set memory.capacity: .*{said}"):
        plan_of(config)


def test_run_says_what_fits_and_what_it_needs() -> None:
    given = {**SETTINGS, "policy": ["object", "ray", "replicated"]}
    config = config_from_mapping({**given, "memory": {"fraction": 0.3, "capacity": "1600 B"}})
    point = make_point(config, workload_of(config))
    least = {each.parameters.name: each.needs.least_bytes for each in fittings(point)}
    assert least["object"] < least["ray"]
    enough = f"{least['object']} B"
    config = config_from_mapping({**given, "memory": {"fraction": 0.3, "capacity": enough}})
    point = make_point(config, workload_of(config))
    require_fitting(point)
    assert {each.parameters.name: each.fits for each in fittings(point)}["ray"] is False
    assert any("does not fit" in line and "ray" in line for line in told(point))
    runs = list(run_point(point))
    table = dict(measures(runs))
    assert [run.parameters.title for run in runs] == ["object"]
    use = runs[0].result.memory
    assert use is not None
    held = use.peak_resident + use.peak_fetched + use.peak_ray_queue + use.peak_receive
    assert table["the fullest PE"] == [format_bytes(held)]
    assert held <= least["object"]
    assert table["escapes"] == [f"{use.escapes}"] != ["0"]
    assert "most bytes on a PE" not in table  # counts what is not started
    small = config_from_mapping({**given, "memory": {"fraction": 0.3, "capacity": "100 B"}})
    with pytest.raises(ConfigError, match=r"memory.capacity: value '100 B': expected at least"):
        require_fitting(make_point(small, workload_of(small)))


def test_a_sweep_goes_on_where_something_does_not_fit() -> None:
    swept = {"memory.capacity": ["100 B", "least", "none"], "policy": ["object", "ray"]}
    plan = plan_of(config_from_mapping({**SETTINGS, "sweep": swept}))
    rows = plan.rows({task.key: run_task(task) for task in plan.tasks})
    assert [row["error"] for row in rows] == [""] * len(rows)
    by_capacity = {row["memory.capacity"]: row for row in rows if row["policy"] == "ray"}
    assert (by_capacity["100 B"]["fits"], by_capacity["100 B"]["makespan_ps"]) == (0, "")
    assert by_capacity["least"]["fits"] == 1
    assert by_capacity["none"]["fits"] == ""
