"""Placements of islands: each owns the whole scene, and holds as a machine of its size would."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from typing import get_args

import numpy as np
import pytest

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping
from simmpp.config.misleading import misleading
from simmpp.placement.place import rotated
from simmpp.placement.placement import Memory, Owners, Placement, PlacementRules, Residents
from simmpp.workload.workload import Workload

PROCESSORS, ISLANDS, ISLAND = 6, 2, 3


@pytest.fixture(scope="module")
def workload() -> Workload:
    return simmpp.trace(simmpp.load_scene("mountain:3"), simmpp.Picture(resolution=12))


def held(placement: Placement, pe: int) -> list[int]:
    first, end = placement.replica_offsets[pe : pe + 2]
    return [int(obj) for obj in placement.replica_objects[first:end]]


@pytest.mark.parametrize("owners", get_args(Owners))
@pytest.mark.parametrize("residents", get_args(Residents))
def test_every_island_owns_all_and_holds_its_share(
    owners: Owners, residents: Residents, workload: Workload
) -> None:
    memory = Memory(Fraction(1, 2), residents=residents, transient="x", hot=Fraction(1, 20))
    rules = PlacementRules(owners=owners, islands=ISLANDS)
    placement = simmpp.place(workload, PROCESSORS, memory, rules, 3)
    n, share = workload.n_objects, workload.n_objects // ISLAND
    assert (placement.island, placement.islands) == (ISLAND, ISLANDS)
    assert set(np.bincount(placement.owners, minlength=ISLAND)) <= {share, share + 1}
    for pe in range(PROCESSORS):
        own = set(np.flatnonzero(placement.owners == pe % ISLAND).tolist())
        assert own.isdisjoint(held(placement, pe))
        assert len(own) + len(held(placement, pe)) == n // 2
    assert placement.effective_fraction == pytest.approx((n // 2) / n)
    assert placement.transient == n // 2
    if owners not in ("used", "random"):
        alone = simmpp.place(workload, ISLAND, memory, PlacementRules(owners=owners), 3)
        assert placement.owners.tolist() == alone.owners.tolist()


def test_the_mean_resident_share_counts_what_every_island_owns(workload: Workload) -> None:
    memory = Memory(bytes=0, transient="x")
    placement = simmpp.place(workload, PROCESSORS, memory, PlacementRules(islands=ISLANDS), 0)
    assert placement.effective_fraction == 1 / ISLAND
    assert placement.transient == workload.n_objects // ISLAND == 44
    everything = simmpp.place(workload, PROCESSORS, memory, PlacementRules(islands=PROCESSORS), 0)
    assert everything.effective_fraction == 1


def test_owners_by_use_serve_the_same_place_of_every_island(workload: Workload) -> None:
    rules = PlacementRules(owners="used", pixels="blocks", islands=ISLANDS)
    placement = simmpp.place(workload, PROCESSORS, Memory(), rules, 0)
    uses: Counter[tuple[int, int]] = Counter()
    for ray, pixel in enumerate(workload.pixels.tolist()):
        if pixel // 12 % 4 == 0 and pixel % 12 % 4 == 0:
            first, end = workload.itinerary_offsets[ray : ray + 2]
            place = int(placement.pixel_pes[pixel]) % ISLAND
            uses.update((place, int(o)) for o in workload.itinerary_objects[first:end])
    place, obj = min(uses, key=lambda pair: (-uses[pair], pair[1], pair[0]))
    assert placement.owners[obj] == place


def test_turns_of_residents_leave_out_what_the_island_owns(workload: Workload) -> None:
    rules = PlacementRules(islands=ISLANDS)
    (placement,) = rotated(workload, PROCESSORS, [Fraction(1, 2)], rules, 1)
    assert placement.island == ISLAND
    for pe in range(PROCESSORS):
        assert all(placement.owners[obj] != pe % ISLAND for obj in held(placement, pe))
        assert len(held(placement, pe)) == workload.n_objects // 2 - 44


def test_islands_that_are_not_equal_are_refused(workload: Workload) -> None:
    with pytest.raises(ConfigError, match=r"placement.islands: value 4: expected a divisor of 6"):
        simmpp.place(workload, PROCESSORS, Memory(), PlacementRules(islands=4), 0)


def config(**keys: object) -> dict[str, object]:
    return {"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 8} | keys


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"placement": {"islands": 3}}, "placement.islands: value 3: expected a divisor of 8, the"),
        ({"placement": {"islands": 0}}, "placement.islands: value 0: expected an integer from 1"),
        ({"sweep": {"placement.islands": [1, 3]}}, "value 3: expected a divisor of 8"),
        ({"sweep": {"placement.islands": [2], "processors": [4, 7]}}, "expected a divisor of 7"),
        (
            {"placement": {"islands": 2}, "method": "analytical", "policy": "ray"},
            "method: value 'analytical': expected simulate where there are islands",
        ),
    ],
)
def test_islands_that_cannot_be_are_one_line(keys: dict[str, object], expected: str) -> None:
    with pytest.raises(ConfigError, match=expected) as caught:
        config_from_mapping(config(**keys))
    assert "\n" not in str(caught.value)


def test_one_island_is_not_written_down_and_others_are() -> None:
    assert "islands" not in config_from_mapping(config()).settings.model_dump()["placement"]
    two = config_from_mapping(config(placement={"islands": 2})).settings.model_dump()
    assert two["placement"]["islands"] == 2


def test_shares_below_what_an_island_owns_are_told() -> None:
    swept = {"sweep": {"memory.fraction": [0.15, 0.2, 0.25, 1]}, "placement": {"islands": 2}}
    lines = misleading(config_from_mapping(config(**swept, memory={"transient": 0})), is_swept=True)
    owned = "each of 4 PEs of each of 2 islands owns 1/4 of the scene and holds that"
    assert f"memory.fraction 0.15, 0.2, 0.25 come to the same: {owned}" in lines


def test_islands_are_an_axis_up_to_the_replicated_scene() -> None:
    keys = {"policy": ["object", "concurrent", "replicated"], "reading": "plain"}
    rows = simmpp.sweep(config(**keys, sweep={"placement.islands": [1, 2, 8]})).rows
    assert rows["error"].isna().all()
    by_islands = rows.set_index(["placement.islands", "policy"])
    assert by_islands.loc[(1, "object"), "messages"] > by_islands.loc[(2, "object"), "messages"] > 0
    assert by_islands.loc[(1, "object"), "effective_fraction"] == pytest.approx(1 / 8, abs=0.01)
    assert by_islands.loc[(2, "object"), "effective_fraction"] == pytest.approx(1 / 4, abs=0.01)
    assert by_islands.loc[8].makespan_ps.nunique() == 1
    assert by_islands.loc[(8, "object"), "effective_fraction"] == 1
