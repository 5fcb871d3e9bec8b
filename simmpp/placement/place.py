"""One draw of a placement: owners, residents, pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from simmpp.common.errors import ConfigError
from simmpp.common.randomness import generator
from simmpp.common.validate import MOST_COUNT, MOST_SEED, require_kind, require_whole
from simmpp.placement.homes import home_starts, spread
from simmpp.placement.owners import most_using, owners
from simmpp.placement.pixels import pixel_pes
from simmpp.placement.placement import OF_HOMES, Memory, Placement, PlacementRules, island_of
from simmpp.placement.residents import Deal, as_csr, filling, kept_count, replicas, resident_count
from simmpp.placement.rooms import TO_FILL
from simmpp.placement.rounds import window_of
from simmpp.placement.uses import Ids, UsesByPE
from simmpp.workload.workload import Workload


def place(
    workload: Workload, processors: int, memory: Memory, rules: PlacementRules, seed: int
) -> Placement:
    """Place a workload on ``processors`` PEs; the same arguments give the same placement.

    Raises ConfigError for a number of PEs or a seed that can't be, for islands that are not equal,
    and for a memory without an end that is to be filled.
    """
    require_kind("workload", workload, Workload)
    require_whole("processors", processors, 1, MOST_COUNT)
    require_kind("memory", memory, Memory)
    if memory.fills and memory.capacity is None:
        raise ConfigError(f"memory: fraction: {TO_FILL}")
    require_kind("rules", rules, PlacementRules)
    require_whole("seed", seed, 0, MOST_SEED)
    island = island_of(rules, processors)
    starts_on, owner_of = _dealt(rules, workload, processors, island, seed)
    deal = Deal(workload, owner_of, starts_on, processors, island)
    offsets, objects = replicas(deal, memory, seed)
    placement = Placement(
        processors=processors,
        owners=owner_of,
        replica_offsets=offsets,
        replica_objects=objects,
        transient=kept_count(memory, deal, len(objects)),
        pixel_pes=starts_on,
        transient_bytes=memory.kept_bytes,
        islands=rules.islands,
        capacity=memory.bounds,
        filling=filling(deal, memory, seed),
        window=window_of(rules.rounds),
        tallies=rules.tallies,
    )
    return _spread(rules, workload, placement)


def _spread(rules: PlacementRules, workload: Workload, placement: Placement) -> Placement:
    if rules.pixels != "home_spread":
        return placement
    return replace(placement, pixel_pes=spread(workload, placement))


def _dealt(
    rules: PlacementRules, workload: Workload, processors: int, island: int, seed: int
) -> tuple[Ids, Ids]:
    """Where each primary ray starts, and who owns each object: one may follow from the other."""
    if rules.pixels in OF_HOMES:
        owner_of = owners(rules.owners, workload.object_centroids, island, seed)
        return home_starts(workload, owner_of, processors, island), owner_of
    starts_on = _starts(rules, workload, processors, seed)
    return starts_on, _owners(rules, workload, starts_on, island, seed)


def _starts(rules: PlacementRules, workload: Workload, processors: int, seed: int) -> Ids:
    """The PE of each primary ray: all samples of a pixel start where it is dealt to."""
    of_pixels = pixel_pes(rules.pixels, workload.picture, processors, seed)
    return np.tile(of_pixels, workload.samples) if workload.samples > 1 else of_pixels


def _owners(
    rules: PlacementRules, workload: Workload, starts_on: Ids, island: int, seed: int
) -> Ids:
    """Owners within an island, in all the same; uses are those of all PEs at one place."""
    if rules.owners == "used":
        return most_using(UsesByPE(workload, starts_on % island), workload.n_objects, island)
    return owners(rules.owners, workload.object_centroids, island, seed)


def draws(memory: Memory, rules: PlacementRules) -> bool:
    """Whether the seed has a part in a placement; otherwise it is the same for every seed."""
    residents = memory.residents == "random" and (memory.bytes is not None or memory.share < 1)
    return residents or "random" in (rules.owners, rules.pixels)


# --- residents for several fractions at once ---


def rotated(
    workload: Workload,
    processors: int,
    fractions: Sequence[Fraction],
    rules: PlacementRules,
    seed: int,
) -> list[Placement]:
    """A placement for each fraction, in their order, with random residents and no transient memory.

    Owners and pixels are the same in all of them, and together the residents treat all objects
    alike. Each PE has one random order of the objects it does not own, a circle. The first fraction
    takes its replicas from the beginning of it, the next one goes on where that ended, and so on
    round the circle. Each placement alone is as random as one of :func:`place`; but an object that
    one fraction has left out is held at the next, so what luck does to one run is undone by its
    neighbour's, where nested residents would repeat it.
    Source: systematic sampling (Cochran 1977, Sampling Techniques, chapter 8), along a sweep.
    """
    n_objects = workload.n_objects
    island = island_of(rules, processors)
    starts_on, owner_of = _dealt(rules, workload, processors, island, seed)
    counts = [resident_count(fraction, n_objects) for fraction in fractions]
    circles = (_circle(owner_of, island, pe, seed) for pe in range(processors))
    held = [_turns(circle, owner_of, counts) for circle in circles]
    placements = [
        Placement(
            *(processors, owner_of, *as_csr(of_fraction), 0, starts_on),
            islands=rules.islands,
            window=window_of(rules.rounds),
            tallies=rules.tallies,
        )
        for of_fraction in zip(*held, strict=True)
    ]
    return [_spread(rules, workload, placement) for placement in placements]


def _circle(owner_of: Ids, island: int, pe: int, seed: int) -> Ids:
    """The objects that a PE does not own, in random order."""
    others = np.flatnonzero(owner_of != pe % island).astype(np.int32)
    return generator(seed, "rotated", pe).permutation(others)


def _turns(circle: Ids, owner_of: Ids, counts: Sequence[int]) -> list[Ids]:
    """The replicas of one PE for each number of residents, one after the other round the circle."""
    n_own, twice = len(owner_of) - len(circle), np.concatenate([circle, circle])
    start, turns = 0, []
    for count in counts:
        wanted = max(0, count - n_own)
        turns.append(twice[start : start + wanted])
        start = (start + wanted) % max(1, len(circle))
    return turns
