"""What is allowed and not what it seems: one line each, and silence where nothing is wrong."""

from __future__ import annotations

import pytest

from simmpp.config.config import config_from_mapping
from simmpp.config.misleading import misleading

BASE = {"scene": "tetra:2", "processors": 64}


def told(*overrides: str, is_swept: bool = True, **data: object) -> list[str]:
    return misleading(config_from_mapping(BASE | data, overrides), is_swept=is_swept)


def test_what_is_usual_is_not_warned_of() -> None:
    assert told() == []
    assert told(policy=["object", "ray", "concurrent"], sweep={"processors": [4, 16, 96]}) == []
    assert told("processors=97", "machine.shape=[97, 1, 1]") == []  # as it is said


def test_a_prime_number_is_a_ring() -> None:
    assert told(processors=97) == [
        "97 PEs are a torus of 97 x 1 x 1, so messages cross up to 48 links; "
        "96 (6 x 4 x 4) and 98 (7 x 7 x 2) are rounder"
    ]
    (once,) = told(sweep={"processors": [64, 97], "memory.fraction": [0.5, 1]})
    assert once.startswith("97 PEs are ")


@pytest.mark.parametrize(
    ("policy", "line"),
    [
        ({"name": "object", "min_load": "5%"}, "policy.min_load: object ignores min_load"),
        ({"name": "object", "batch": 8}, "policy.batch: object ignores batch"),
        ({"name": "object", "load_info": "exact"}, "policy.load_info: object ignores load_info"),
        ({"name": "ray", "ask_at_least": 8}, "policy.ask_at_least: ray ignores ask_at_least"),
        ({"name": "ray", "min_load": 8, "label": "keen"}, "policy.min_load: keen ignores min_load"),
        (
            {"name": "ray", "merge_requests": False},
            "policy.merge_requests: ray ignores merge_requests",
        ),
        ({"name": "object", "merge_requests": False}, None),
        ({"name": "ray", "batch": 8}, None),
        ({"name": "concurrent", "min_load": 1, "batch": 2, "load_info": "exact"}, None),
    ],
)
def test_numbers_that_a_policy_ignores(policy: dict[str, object], line: str | None) -> None:
    found = [text.replace("[0]", "") for text in told(policy=policy)]
    assert found == ([line] if line else [])
    of_axis = told(sweep={"policy": ["concurrent", policy]})
    assert [text.partition(": ")[2] for text in of_axis] == (
        [line.partition(": ")[2]] if line else []
    )


def test_one_set_serves_the_policies_that_read_it() -> None:
    both = ["object", "concurrent"]
    assert told("policy.min_load=5%", policy=both) == []
    assert told("policy.min_load=5%", policy=["object", "ray"]) == [
        "--set policy.min_load: object, ray ignore min_load"
    ]
    assert told(sweep={"policy": both, "policy.min_load": ["1%", "5%"]}) == []


def test_fractions_below_what_a_pe_owns_are_the_same() -> None:
    sweep = {"memory.fraction": [0.01, 0.05, 0.5], "processors": [64, 8]}
    assert told(sweep=sweep) == []  # the default reading has room for x fetched objects besides
    none = "memory.transient=0"
    assert told(none, sweep=sweep) == [
        "memory.fraction 0.01, 0.05 come to the same: each of 8 PEs owns 1/8 of the scene and "
        "holds that"
    ]
    assert told(none, sweep=sweep | {"memory.fraction": [0.05, 0.5]}) == []
    linked = {"processors, memory.fraction": [[8, 0.2], [64, 0.01], [64, 0.05]]}
    assert told(none, sweep=linked) == []  # 1 % and 5 % are of 64 PEs alone
    assert told(processors=8, memory={"bytes": "1 B"}) == []


def test_room_in_a_memory_that_does_not_end() -> None:
    nothing = "without a memory.capacity it decides nothing"
    kept = f"{nothing} (room for objects that are kept is memory.transient)"
    assert told(memory={"fetch": "64 kB"}) == [f"memory.fetch: {kept}"]
    assert told("memory.flow=none") == [f"--set memory.flow: {nothing}"]
    assert told("memory.flow=none", "memory.capacity=1 GB") == []
    assert told("memory.flow=none", sweep={"memory.capacity": ["none", "1 GB"]}) == []
