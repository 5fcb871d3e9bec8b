"""What is placed where it is used: against counts written down apart."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np
import pytest

import simmpp
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.workload.workload import Workload

PROCESSORS = 6


@pytest.fixture(scope="module")
def workload() -> Workload:
    return simmpp.trace(simmpp.load_scene("mountain:3"), simmpp.Picture(resolution=20))


def counts(workload: Workload, placement: Placement) -> Counter[tuple[int, int]]:
    """(PE, object): tests of the rays of every 4th row's every 4th pixel."""
    found: Counter[tuple[int, int]] = Counter()
    width = workload.picture[1]
    for ray in range(workload.n_rays):
        pixel = int(workload.pixels[ray])
        first, end = workload.itinerary_offsets[ray : ray + 2]
        if pixel // width % 4 == 0 and pixel % width % 4 == 0:
            pe = int(placement.pixel_pes[pixel])
            found.update((pe, int(obj)) for obj in workload.itinerary_objects[first:end])
    return found


def held(placement: Placement, pe: int) -> list[int]:
    first, end = placement.replica_offsets[pe : pe + 2]
    return [int(obj) for obj in placement.replica_objects[first:end]]


def placed(workload: Workload, memory: Memory, **rules: str) -> Placement:
    chosen = PlacementRules(pixels="tiles", **rules)  # type: ignore[arg-type]
    return simmpp.place(workload, PROCESSORS, memory, chosen, 0)


def test_residents_are_those_that_the_pe_uses_most(workload: Workload) -> None:
    placement = placed(workload, Memory(Fraction(3, 10), residents="used"))
    found, n_bytes = counts(workload, placement), workload.object_bytes
    for pe in range(PROCESSORS):
        others = [o for o in range(workload.n_objects) if placement.owners[o] != pe]
        on_all = {o: sum(found[p, o] for p in range(PROCESSORS)) for o in others}
        ranked = sorted(
            others, key=lambda o: (-found[pe, o] / n_bytes[o], -on_all[o] / n_bytes[o], o)
        )
        assert held(placement, pe) == ranked[: len(held(placement, pe))]
        assert held(placement, pe)


def test_owners_use_what_they_own_more_than_those_with_room(workload: Workload) -> None:
    placement = placed(workload, Memory(Fraction(0)), owners="used")
    found, share = counts(workload, placement), workload.n_objects // PROCESSORS
    sizes = np.bincount(placement.owners, minlength=PROCESSORS)
    assert set(sizes.tolist()) <= {share, share + 1}
    served = sorted(found, key=lambda pair: (-found[pair], pair[1], pair[0]))
    pe, obj = served[0]
    assert placement.owners[obj] == pe
    own = sum(found[int(owner), obj] for obj, owner in enumerate(placement.owners))
    by_chance = sum(found.values()) / PROCESSORS
    assert own > 1.3 * by_chance


def test_the_hottest_are_everywhere(workload: Workload) -> None:
    memory = Memory(Fraction(1, 2), hot=Fraction(1, 10))
    placement = placed(workload, memory)
    found = counts(workload, placement)
    on_all = Counter({obj: 0 for obj in range(workload.n_objects)})
    for (_, obj), n in found.items():
        on_all[obj] += n
    per_byte = {obj: -on_all[obj] / workload.object_bytes[obj] for obj in on_all}
    hot = sorted(on_all, key=lambda obj: (per_byte[obj], obj))[: round(workload.n_objects / 10)]
    for pe in range(PROCESSORS):
        mine = [o for o in hot if placement.owners[o] != pe]
        assert held(placement, pe)[: len(mine)] == mine
    without = placed(workload, Memory(Fraction(1, 2)))
    assert placement.effective_fraction == without.effective_fraction


def test_what_is_hot_or_used_is_nested_in_the_fraction(workload: Workload) -> None:
    for memory in ({"residents": "used"}, {"hot": Fraction(1, 20)}):
        small, large = (
            placed(workload, Memory(Fraction(x, 10), **memory))  # type: ignore[arg-type]
            for x in (3, 6)
        )
        for pe in range(PROCESSORS):
            assert held(small, pe) == held(large, pe)[: len(held(small, pe))]
