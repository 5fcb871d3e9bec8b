"""Room for fetched objects, said in bytes."""

from __future__ import annotations

import pytest

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping

SCENE = {"scene": "tetra:2", "picture": {"resolution": 8}, "reading": "mixed"}


def test_bytes_stand_in_place_of_a_number() -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:2"), simmpp.Picture(resolution=8))
    rules = simmpp.PlacementRules()
    placement = simmpp.place(workload, 4, simmpp.Memory(fetch="2 kB", transient=3), rules, 0)
    assert (placement.transient, placement.transient_bytes) == (0, 2000)
    placement = simmpp.place(workload, 4, simmpp.Memory(transient=3), rules, 0)
    assert (placement.transient, placement.transient_bytes) == (3, 0)


def test_what_is_said_takes_the_place_of_what_a_reading_says() -> None:
    memory = config_from_mapping({**SCENE, "memory": {"fetch": "2 kB"}}).memory
    assert (memory.fetch, memory.kept) == (2000, 0)
    assert config_from_mapping(SCENE).memory.kept == memory.fraction
    again = config_from_mapping({**SCENE, "memory": {"fetch": "2 kB"}}, ["memory.transient=4"])
    assert (again.memory.fetch, again.memory.kept) == (None, 4)


@pytest.mark.parametrize(
    ("memory", "said"),
    [
        ({"fetch": "2 kB", "transient": 1}, "expected transient or fetch, got both"),
        ({"fetch": "2 ks"}, "memory.fetch: value '2 ks'"),
    ],
)
def test_mistakes_are_told(memory: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        config_from_mapping({**SCENE, "memory": memory})
