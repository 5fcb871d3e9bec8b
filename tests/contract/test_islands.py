"""Islands are machines beside one another: a run of r islands is r runs, to the picosecond."""

from __future__ import annotations

from dataclasses import asdict, replace
from itertools import pairwise

import numpy as np
import pytest
from builders import Case, on_islands, on_torus, placement_of, random_case, workload_of
from implementations import run

from simmpp.engine.simulate import ENGINES
from simmpp.machine.uneven import NOBODY
from simmpp.policy.parameters import CEILING, PolicyParameters
from simmpp.workload.workload import Workload

SUMS = ("messages_received", "bytes_sent", "rays", "tests", "rays_sent")


def islands_of(seed: int) -> Case | None:
    """The case of a seed on two islands or more, as many pixels on each; distance costs nothing."""
    case = on_torus(random_case(seed))
    nb, n0 = case.machine.processors, case.workload.n_primaries
    numbers = [n for n in range(2, nb) if nb % n == 0 and n0 % n == 0]
    if not numbers:
        return None
    n_islands = numbers[seed % len(numbers)]
    island = nb // n_islands
    # No loads once all is done, and no draws, which are those of a PE's number.
    policy = replace(case.policy, refresh_ps=None)
    if policy.load_info == "two":
        policy = replace(policy, load_info="piggyback")
    placement = on_islands(replace(case.placement, islands=1), n_islands)
    starts = np.arange(n0) % n_islands * island + placement.pixel_pes % island
    even = {"speed": (), "noise": "0", "straggler": NOBODY}  # a PE has other numbers there
    return replace(
        case,
        machine=replace(case.machine, hop_latency_ps=0, contention="none", **even),
        placement=replace(placement, pixel_pes=starts.astype(np.int32)),
        policy=policy,
    )


def alone(case: Case, n: int) -> Case:
    """Island n as a machine of its own, with the rays that start there and its placement."""
    island, placement = case.placement.island, case.placement
    first, workload = n * island, case.workload
    is_here = placement.pixel_pes // island == n
    rays = np.flatnonzero(is_here[workload.pixels])
    pes = range(first, first + island)
    offsets = placement.replica_offsets.tolist()
    return replace(
        case,
        workload=only(workload, rays.tolist()),
        machine=replace(case.machine, shape=(island, 1, 1)),
        placement=placement_of(
            placement.owners.tolist(),
            (placement.pixel_pes[is_here] - first).tolist(),
            island,
            [placement.replica_objects[offsets[k] : offsets[k + 1]].tolist() for k in pes],
            placement.transient,
        ),
    )


def only(workload: Workload, rays: list[int]) -> Workload:
    """Whole trees of rays alone, in their order."""
    bounds = list(pairwise(workload.itinerary_offsets.tolist()))
    n_primaries = sum(ray < workload.n_primaries for ray in rays)
    return workload_of(
        n_primaries,
        [workload.itinerary_objects[slice(*bounds[ray])].tolist() for ray in rays],
        [rays.index(int(workload.parents[ray])) for ray in rays[n_primaries:]],
        workload.kinds[rays[n_primaries:]].tolist(),
        workload.object_bytes.tolist(),
        workload.object_kinds.tolist(),
        workload.object_triangles.tolist(),
    )


@pytest.mark.parametrize("implementation", ["oracle", *ENGINES])
def test_islands_are_machines_beside_one_another(implementation: str) -> None:
    ran = sent = 0
    for seed in range(60):
        if (case := islands_of(seed)) is None:
            continue
        island, n_islands = case.placement.island, case.placement.islands
        together = run(implementation, case)
        apart = [run(implementation, alone(case, n)) for n in range(n_islands)]
        where = f"seed {seed}: {n_islands} islands of {island} PEs under {case.policy}"
        assert together.makespan_ps == max(each.makespan_ps for each in apart), where
        for name in SUMS:
            total = sum(getattr(each, name) for each in apart)
            assert getattr(together, name) == total, f"{name}, {where}"
        assert together.slices == [
            row._replace(
                pe=row.pe + n * island, other=row.other + n * island if row.other >= 0 else -1
            )
            for n, each in enumerate(apart)
            for row in each.slices
        ], where
        ran, sent = ran + 1, sent + together.messages_received
    assert ran > 10 and sent > 100


@pytest.mark.parametrize("engine", ENGINES)
def test_islands_of_one_pe_are_the_replicated_scene(engine: str) -> None:
    for seed in range(20):
        case = random_case(seed)
        nb = case.machine.processors
        placement = on_islands(replace(case.placement, islands=1), nb)
        each = replace(case, placement=placement)
        everywhere = replace(each, policy=PolicyParameters(CEILING))
        one, other = asdict(run(engine, each)), asdict(run(engine, everywhere))
        one.pop("rules_never_fired")
        other.pop("rules_never_fired")
        assert one == other
        assert placement.effective_fraction == 1
