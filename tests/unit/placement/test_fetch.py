"""Room on a PE: for fetched objects in bytes, and all of it."""

from __future__ import annotations

from fractions import Fraction

import pytest

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping
from simmpp.placement.rooms import Capacity, Room

SCENE = {"scene": "tetra:2", "picture": {"resolution": 8}, "reading": "mixed"}


def test_bytes_stand_in_place_of_a_number() -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:2"), simmpp.Picture(resolution=8))
    rules = simmpp.PlacementRules()
    placement = simmpp.place(workload, 4, simmpp.Memory(transient="2 kB"), rules, 0)
    assert (placement.transient, placement.transient_bytes) == (0, 2000)
    placement = simmpp.place(workload, 4, simmpp.Memory(transient=3), rules, 0)
    assert (placement.transient, placement.transient_bytes) == (3, 0)


def test_what_is_said_takes_the_place_of_what_a_reading_says() -> None:
    memory = config_from_mapping({**SCENE, "memory": {"transient": "2 kB"}}).memory
    assert (memory.kept_bytes, memory.kept) == (2000, 0)
    assert config_from_mapping(SCENE).memory.kept == memory.fraction
    again = config_from_mapping({**SCENE, "memory": {"transient": "2 kB"}}, ["memory.transient=4"])
    assert (again.memory.kept_bytes, again.memory.kept) == (0, 4)


def test_a_capacity_and_its_parts() -> None:
    said = {"capacity": "64 kB", "buffers": "50%", "fetch": "2 kB", "escape": "none"}
    memory = config_from_mapping({**SCENE, "memory": said}).memory
    assert memory.bounds == Capacity(64_000, "credits", "none", Fraction(1, 2), Room(2000))
    assert config_from_mapping(SCENE).memory.bounds is None
    least = config_from_mapping({**SCENE, "memory": {"capacity": "least"}}).memory.bounds
    assert least == Capacity("least")


@pytest.mark.parametrize(
    ("memory", "said"),
    [
        ({"transient": "2 ks"}, "memory.transient: value '2 ks'"),
        ({"capacity": "64"}, "memory.capacity: value '64': expected a size"),
        ({"capacity": 0}, "memory.capacity: value 0: expected a size"),
        ({"buffers": "60%", "fetch": "40%"}, "buffers 60% and fetch 40% leave no room for rays"),
        ({"flow": "credit"}, "memory.flow: value 'credit': expected credits or none"),
        ({"escape": "ask"}, "memory.escape: value 'ask': expected fetch or none"),
        ({"fetch": "2 ks"}, "memory.fetch: value '2 ks'"),
    ],
)
def test_mistakes_are_told(memory: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        config_from_mapping({**SCENE, "memory": memory})
