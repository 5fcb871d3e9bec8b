"""Where the seed has a part in a placement, and where it has none."""

from itertools import pairwise

import pytest

from simmpp.config.config import config_from_mapping
from simmpp.placement.place import draws, place
from simmpp.placement.placement import Placement
from simmpp.run.inputs import workload_of

MEMORIES = [
    {"fraction": 0.5},
    {"fraction": 0.5, "residents": "nearest"},
    {"fraction": 0.5, "residents": "hot"},
    {"fraction": 1},
]


@pytest.mark.parametrize("owners", ["bisection", "morton", "round_robin", "random"])
@pytest.mark.parametrize(
    "pixels", ["blocks", "rows", {"cells": 2}, "tiles", "interleaved", "random"]
)
@pytest.mark.parametrize("memory", MEMORIES)
def test_only_what_is_drawn_depends_on_the_seed(
    owners: str, pixels: object, memory: dict[str, object]
) -> None:
    config = config_from_mapping(
        {
            "scene": "tetra:2",
            "picture": {"resolution": 12},
            "memory": memory,
            "placement": {"owners": owners, "pixels": pixels},
        }
    )
    workload, rules = workload_of(config), config.settings.placement
    one, other = (contents(place(workload, 4, config.memory, rules, seed)) for seed in (0, 1))
    assert (one != other) == draws(config.memory, rules)


def test_memory_in_bytes_may_be_drawn() -> None:
    for residents, drawn in (("random", True), ("nearest", False)):
        memory = {"bytes": "1 kB", "residents": residents}
        config = config_from_mapping({"scene": "tetra:2", "memory": memory})
        assert draws(config.memory, config.settings.placement) == drawn


def contents(placement: Placement) -> tuple[object, ...]:
    """Owners, pixels and what each PE holds, whatever the order that it was drawn in."""
    held = [
        sorted(placement.replica_objects[a:b].tolist())
        for a, b in pairwise(placement.replica_offsets)
    ]
    return placement.owners.tolist(), placement.pixel_pes.tolist(), held
