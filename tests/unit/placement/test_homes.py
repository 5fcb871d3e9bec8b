"""Roots with a home start where it is owned, or where it is held as well."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from builders import random_case, with_other_rays, workload_of

from simmpp.common.errors import ConfigError
from simmpp.placement.place import place, rotated
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.workload.workload import Workload

HOME = PlacementRules(pixels="home", owners="round_robin")
SPREAD = PlacementRules(pixels="home_spread", owners="round_robin")
NOTHING, EVERYTHING = Memory(fraction=Fraction(0)), Memory(fraction=Fraction(1))


def with_homes(*homes: int, objects: int = 4) -> Workload:
    workload = workload_of(len(homes), [[0]] * len(homes), object_bytes=[1] * objects)
    return replace(workload, root_homes=np.array(homes, np.int32))


def starts(workload: Workload, nb: int, memory: Memory, rules: PlacementRules) -> list[int]:
    return place(workload, nb, memory, rules, 0).pixel_pes.tolist()


def test_a_root_starts_with_the_owner_of_its_home_and_others_in_blocks() -> None:
    workload = with_homes(3, -1, 0, 1, -1, 3, -1, -1)
    assert starts(workload, 4, NOTHING, HOME) == [3, 0, 0, 1, 1, 3, 2, 3]
    assert starts(workload, 2, NOTHING, HOME) == [1, 0, 0, 1, 0, 1, 1, 1]


def test_islands_share_the_roots_of_a_home() -> None:
    workload = with_homes(3, 3, 0, 3, 3, 1)
    rules = replace(HOME, islands=2)
    assert starts(workload, 4, NOTHING, rules) == [1, 1, 0, 3, 3, 1]
    assert starts(workload, 8, NOTHING, rules) == [3, 3, 0, 7, 7, 1]


def test_what_is_beyond_an_equal_part_goes_to_those_who_hold_the_home_too() -> None:
    workload = with_homes(0, 0, 0, 0, 0, 0, 0, 1)  # 2 for each of 4 PEs
    assert starts(workload, 4, EVERYTHING, SPREAD) == [0, 0, 1, 2, 3, 1, 2, 1]
    assert starts(workload, 4, NOTHING, SPREAD) == [0] * 7 + [1]
    assert starts(workload, 4, EVERYTHING, HOME) == [0] * 7 + [1]
    of_islands = replace(SPREAD, islands=2)  # objects 0 and 2 are of the first PE of each
    assert starts(workload, 4, EVERYTHING, of_islands) == [0, 0, 1, 1, 2, 2, 3, 1]


def test_every_root_starts_where_its_home_is_resident() -> None:
    rng, seen = np.random.default_rng(5), 0
    for seed in range(60):
        case = random_case(seed)
        workload, nb = with_other_rays(rng, case.workload), case.machine.processors
        if len(workload.root_homes) == 0:
            continue
        for rules in (HOME, SPREAD):
            memory = Memory(fraction=Fraction(1, 2))
            (again,) = rotated(workload, nb, [Fraction(1, 2)], rules, seed)
            for placed in (place(workload, nb, memory, rules, seed), again):
                for home, pe in zip(workload.root_homes, placed.pixel_pes, strict=True):
                    span = slice(*placed.replica_offsets[pe : pe + 2])
                    held = placed.owners[home] == pe or home in placed.replica_objects[span]
                    assert home < 0 or held
                    seen += home >= 0 and placed.owners[home] != pe
    assert seen > 20


def test_rays_without_homes_are_refused() -> None:
    workload = workload_of(1, [[0]], object_bytes=[1])
    with pytest.raises(ConfigError, match="value home: no ray of by hand has one"):
        place(workload, 2, NOTHING, HOME, 0)
    with pytest.raises(ConfigError, match="owners of those who start them"):
        PlacementRules(pixels="home", owners="used")
