"""Small random workloads, machines, placements and policies, and tiny ones put together by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from hypothesis import strategies as st

from simmpp.common.units import LATEST_PS
from simmpp.engine.capacity import needs_of
from simmpp.machine.machine import (
    LEVELS,
    TOPOLOGY_NAMES,
    TORUS,
    UNLIMITED,
    CopyCost,
    FatTree,
    Level,
    Machine,
    TestCost,
)
from simmpp.machine.torus import CONTENTIONS
from simmpp.machine.uneven import Speeds, Straggler
from simmpp.placement.placement import Filling, Placement
from simmpp.placement.rooms import LEAST, Capacity, Room
from simmpp.policy.parameters import CEILING, DEFAULT_POLICY, POLICIES, PolicyParameters
from simmpp.workload.workload import PRIMARY, REFLECTED, REFRACTED, SHADOW, Workload

SHAPES = (
    *((n, 1, 1) for n in range(2, 10)),
    *((2, 2, 1), (2, 2, 2), (3, 2, 1), (4, 2, 1), (3, 3, 1), (1, 7, 1), (1, 1, 5), (1, 2, 4)),
)
TIMES_PS = {
    "free": (0,),
    "ties": (0, 1, 1, 2, 3),
    "even": (10_000, 12_345, 20_000, 50_001),
    "uneven": (0, 0, 1, 2, 10, 100, 1000, 12_345, 10**6, 10**9),
}
"""Costs to draw from: time stands still; many instants coincide; alike; far apart."""
BANDWIDTHS = {
    "free": (UNLIMITED,),
    "ties": (UNLIMITED, 10**12, 10**15),
    "even": (34 * 10**7, 6 * 10**8, 10**10),
    "uneven": (UNLIMITED, 1, 7 * 10**6, 34 * 10**7, 10**10, 10**12, 3 * 10**12),
}


@dataclass(frozen=True, eq=False)
class Case:
    """Everything that a run needs."""

    workload: Workload
    machine: Machine
    placement: Placement
    policy: PolicyParameters
    ready_order: str = "depth-first"


# --- by hand ---


def workload_of(
    primaries: int,
    itineraries: Sequence[Sequence[int]],
    parents: Sequence[int] = (),
    kinds: Sequence[int] = (),
    object_bytes: Sequence[int] = (),
    object_kinds: Sequence[int] | None = None,
    object_triangles: Sequence[int] | None = None,
) -> Workload:
    """A workload of one row of primary rays, then their descendants; parents are of the latter."""
    n, n_objects = len(itineraries), len(object_bytes)
    all_parents = [-1] * primaries + list(parents)
    first_child = np.searchsorted(np.array(all_parents), np.arange(n), side="left")
    pixels = list(range(primaries))
    for parent in parents:
        pixels.append(pixels[parent])
    lengths = [len(itinerary) for itinerary in itineraries]
    hits = [itinerary[-1] if len(itinerary) else -1 for itinerary in itineraries]
    return Workload(
        name="by hand",
        digest="0",
        picture=(1, primaries),
        kinds=np.array([PRIMARY] * primaries + (list(kinds) or [SHADOW] * len(parents)), np.uint8),
        parents=np.array(all_parents, np.int32),
        child_offsets=np.array([*first_child, n], np.int32),
        pixels=np.array(pixels, np.int32),
        hits=np.array(hits, np.int32),
        hit_distances=np.where(np.array(hits, np.int32) < 0, np.inf, 1.0),
        itinerary_offsets=np.cumsum([0, *lengths]).astype(np.int64),
        itinerary_objects=np.array([o for i in itineraries for o in i], np.int32),
        object_kinds=np.array(object_kinds or [0] * n_objects, np.uint8),
        object_triangles=np.array(object_triangles or [0] * n_objects, np.int32),
        object_bytes=np.array(object_bytes, np.int64),
        object_centroids=np.zeros((n_objects, 3)),
    )


def placement_of(
    owners: Sequence[int],
    pixel_pes: Sequence[int],
    processors: int,
    replicas: Sequence[Sequence[int]] = (),
    transient: int = 0,
) -> Placement:
    """A placement from lists; replicas by PE."""
    by_pe = [*replicas, *([()] * (processors - len(replicas)))]
    return Placement(
        processors=processors,
        owners=np.array(owners, np.int32),
        replica_offsets=np.cumsum([0, *(len(r) for r in by_pe)]).astype(np.int64),
        replica_objects=np.array([o for r in by_pe for o in r], np.int32),
        transient=transient,
        pixel_pes=np.array(pixel_pes, np.int32),
    )


def on_islands(placement: Placement, islands: int) -> Placement:
    """The same with that many islands: of PEs at one place in each, one owns what they all did."""
    island = placement.processors // islands
    owners = placement.owners % island
    offsets, objects = placement.replica_offsets, placement.replica_objects
    rows = [objects[i:j] for i, j in pairwise(offsets.tolist())]
    replicas = [row[owners[row] != k % island].tolist() for k, row in enumerate(rows)]
    pixel_pes, transient = placement.pixel_pes.tolist(), placement.transient
    again = placement_of(owners.tolist(), pixel_pes, placement.processors, replicas, transient)
    return replace(again, islands=islands)


def everywhere(placement: Placement) -> Placement:
    """The same owners and pixels with a replica of every object on every PE (x = 1)."""
    owners = [int(o) for o in placement.owners]
    replicas = [[o for o, k in enumerate(owners) if k != pe] for pe in range(placement.processors)]
    pixel_pes = [int(k) for k in placement.pixel_pes]
    return placement_of(owners, pixel_pes, placement.processors, replicas, placement.transient)


# --- at random ---


def _pick(rng: np.random.Generator, values: Sequence[Any]) -> Any:
    return values[int(rng.integers(len(values)))]


def with_other_rays(rng: np.random.Generator, workload: Workload) -> Workload:
    """The same rays with rounds, homes, weights, scaled tests, results and deposits, each of them
    or not."""
    n, n0, n_objects = workload.n_rays, workload.n_primaries, workload.n_objects
    _, rounds = np.unique(rng.integers(0, int(_pick(rng, (1, 2, 5))), n0), return_inverse=True)
    drawn: dict[str, Any] = {
        "root_rounds": rounds.astype(np.int32),
        "root_homes": rng.integers(-1, n_objects, n0).astype(np.int32),
        "root_weights": rng.integers(0, 8, n0) / 4,
        "ray_test_scales": rng.integers(0, 4, n).astype(np.uint8),
        "object_results": rng.integers(0, 4000, n_objects),
        "test_deposits": rng.integers(0, 3, workload.n_tests) << 31,
    }
    nothing = {"root_homes": -1, "root_weights": 1}
    used = {
        name: array
        for name, array in drawn.items()
        if rng.random() < 0.6 and (array != nothing.get(name, 0)).any()
    }
    return replace(workload, **used)


def with_repeats(rng: np.random.Generator, workload: Workload) -> Workload:
    """The same rays, some of whose tests are made again at once, or after others."""
    offsets, objects = workload.itinerary_offsets.tolist(), workload.itinerary_objects
    itineraries = [objects[i:j] for i, j in pairwise(offsets)]
    longer = [
        np.concatenate([np.repeat(one, rng.integers(1, 4, len(one))), one[: rng.integers(0, 3)]])
        for one in itineraries
    ]
    return replace(
        workload,
        itinerary_offsets=np.cumsum([0, *map(len, longer)]).astype(np.int64),
        itinerary_objects=np.concatenate([*longer, np.zeros(0)]).astype(np.int32),
    )


def _children(rng: np.random.Generator, depth: int) -> list[int]:
    """Kinds of the rays that one ray spawns."""
    if depth == 4:
        return []
    few = [REFLECTED] * int(rng.random() < 0.3) + [REFRACTED] * int(rng.random() < 0.15)
    return few + [SHADOW] * int(rng.integers(0, 3))


def random_workload(rng: np.random.Generator) -> Workload:
    """0 to 60 primary rays and their trees, 0 to 12 objects of 0 to 4000 bytes."""
    primaries = int(_pick(rng, (1, 2, 5, 9, 12, 20, 33, 60)) if rng.random() < 0.97 else 0)
    n_objects = int(rng.integers(2, 13) if rng.random() < 0.9 else rng.integers(0, 2))
    parents: list[int] = []
    kinds: list[int] = []
    generation, depth, spawns = list(range(primaries)), 1, rng.random()
    while generation:
        first = primaries + len(parents)
        for ray in generation:
            shadow = ray >= primaries and kinds[ray - primaries] == SHADOW
            for kind in _children(rng, depth) if not shadow and rng.random() < spawns else []:
                parents.append(ray)
                kinds.append(kind)
        generation, depth = list(range(first, primaries + len(parents))), depth + 1
    shortest, longest = sorted(rng.integers(0, 7, 2).tolist())
    itineraries = [
        rng.permutation(n_objects)[: int(rng.integers(shortest, longest + 1))].tolist()
        for _ in range(primaries + len(parents))
    ]
    return workload_of(
        primaries,
        itineraries,
        parents,
        kinds,
        [int(_pick(rng, (0, 1, 144, int(rng.integers(4001)), 4000))) for _ in range(n_objects)],
        rng.integers(0, 4, n_objects).tolist(),
        rng.integers(0, 6, n_objects).tolist(),
    )


def random_machine(rng: np.random.Generator) -> Machine:
    """1 to 9 PEs; costs of nothing, of picoseconds and of milliseconds side by side."""
    costs = _pick(rng, ("ties", "even", "uneven") * 5 + ("free",))

    def time() -> int:
        return int(_pick(rng, TIMES_PS[costs]))

    def bandwidth() -> int:
        return int(_pick(rng, BANDWIDTHS[costs]))

    def copies() -> tuple[CopyCost, CopyCost, CopyCost, CopyCost]:
        a, b, c, d = (CopyCost(time(), bandwidth()) for _ in range(4))
        return a, b, c, d

    return Machine(
        name="random",
        shape=_pick(rng, SHAPES) if rng.random() < 0.96 else (1, 1, 1),
        send_startup_ps=time(),
        receive_startup_ps=time(),
        probe_ps=time(),
        pack=copies(),
        unpack=copies(),
        header_bytes=int(_pick(rng, (0, 1, 64))),
        request_bytes=int(_pick(rng, (0, 8, 100))),
        ray_bytes=int(_pick(rng, (0, 1, 80, 333))),
        latency_ps=time(),
        hop_latency_ps=time(),
        link_bytes_per_s=bandwidth(),
        injection_bytes_per_s=bandwidth(),
        test=TestCost(time(), time(), time(), time(), time()),
        ray_ps=time(),
        quantum=int(rng.integers(1, 10)),
    )


def on_some_network(machine: Machine, seed: int) -> Machine:
    """A torus as it is, or its PEs joined otherwise at costs of the same kind.

    Draws from a stream of its own: what else is drawn of the seed stays what it is.
    """
    rng = np.random.default_rng((seed, 18))
    topology = _pick(rng, TOPOLOGY_NAMES)
    machine = replace(machine, port_gap_ps=int(_pick(rng, (0, machine.latency_ps))))
    if topology == TORUS:
        return machine
    machine = replace(machine, topology=topology, shape=(machine.processors, 1, 1))
    if topology == LEVELS:
        return replace(machine, levels=_levels(rng, machine))
    arity = int(rng.integers(2, 5))
    ratios = [ratio for ratio in range(1, arity + 1) if arity % ratio == 0]
    return replace(machine, fat_tree=FatTree(arity, int(rng.choice((0, 6))), _pick(rng, ratios)))


def _levels(rng: np.random.Generator, machine: Machine) -> tuple[Level, ...]:
    """1 to 3, of the machine's own times and bandwidths so that there are ties."""
    times = (0, machine.latency_ps, machine.hop_latency_ps, machine.send_startup_ps)
    rates = (machine.link_bytes_per_s, machine.injection_bytes_per_s)
    inside = range(int(rng.integers(0, 3)))
    return tuple(
        Level(
            name=f"level {n}",
            size=int(rng.integers(1, 4)) if n in inside else 0,
            latency_ps=int(_pick(rng, times)),
            bytes_per_s=int(_pick(rng, rates)),
            gap_ps=int(_pick(rng, times)),
            ports=int(rng.integers(1, 4)) if n > 0 else 1,
            send_startup_ps=int(_pick(rng, times)),
            receive_startup_ps=int(_pick(rng, times)),
        )
        for n in (*inside, len(inside))
    )


def served(case: Case, service: str, seed: int) -> Case:
    """The case where another serves, at costs of the same kind, from a stream of its own."""
    rng, machine = np.random.default_rng((seed, 4)), case.machine
    costs = (0, machine.latency_ps, machine.send_startup_ps, machine.probe_ps)
    handoff_ps, get_startup_ps, completion_ps = (int(_pick(rng, costs)) for _ in range(3))
    machine = replace(
        machine,
        service=service,
        handoff_ps=handoff_ps,
        get_startup_ps=get_startup_ps,
        completion_ps=completion_ps,
    )
    return replace(case, machine=machine)


def with_costs_of_today(machine: Machine, seed: int) -> Machine:
    """The machine, in some cases with one or all of what makes computing uneven.

    Draws from a stream of its own, too.
    """
    rng = np.random.default_rng((seed, 19))
    if rng.random() < 0.3:
        machine = replace(machine, test=replace(machine.test, log2_ps=machine.latency_ps))
    everything, nb = rng.random() < 0.1, machine.processors
    changes: dict[str, Any] = {
        "compute_startup_ps": machine.receive_startup_ps,
        "least_tests": int(_pick(rng, (2, 7, 40))),
        "speed": _speeds(rng, nb),
        "noise": _pick(rng, ("1/20", "1/3", "1")),
        "straggler": Straggler(int(rng.integers(nb)), "10/3", *_pick(rng, WHILES)),
    }
    is_drawn = {name: everything or rng.random() < 0.15 for name in changes}
    return replace(machine, **{name: of for name, of in changes.items() if is_drawn[name]})


WHILES = ((0, LATEST_PS), (100, 10**4), (10**6, 10**9))
"""Times for which a PE is late."""


def _speeds(rng: np.random.Generator, processors: int) -> Speeds:
    """Of shares of the PEs, or of some of them."""
    one, other = (str(_pick(rng, ("2", "1/2", "3", "5/7", "10000/9999"))) for _ in range(2))
    if rng.random() < 0.5:
        return ("30%", one), ("50%", other)
    last = int(rng.integers(processors))
    return ((f"0-{last}", one), *([(f"{last + 1}", other)] if last + 1 < processors else []))


def random_placement(rng: np.random.Generator, workload: Workload, processors: int) -> Placement:
    """Any owners and pixels; a third of the cases have no replicas."""
    owners = rng.integers(0, processors, workload.n_objects).tolist()
    pixel_pes = rng.integers(0, processors, workload.n_primaries).tolist()
    if rng.random() < 0.3:  # all rays start on one PE
        pixel_pes = [int(rng.integers(processors))] * workload.n_primaries
    share = _pick(rng, (0.0, 0.2, 0.6))
    replicas = [
        [
            o
            for o in rng.permutation(len(owners)).tolist()
            if owners[o] != k and rng.random() < share
        ]
        for k in range(processors)
    ]
    return placement_of(owners, pixel_pes, processors, replicas, int(_pick(rng, (0, 0, 1, 2, 3))))


_POLICY_DRAWS = (*[n for n in POLICIES if n != CEILING] * 5, *[DEFAULT_POLICY] * 5, CEILING)


_SAMPLED = tuple({"sampled": t} for t in ("0 ps", "1 ps", "1 ns", "1 us", "1 ms", "never"))


def random_policy(rng: np.random.Generator) -> PolicyParameters:
    """Any combination of parameters; replicated seldom, as it sends no messages."""
    shares = (Fraction(12, 100), Fraction(0), Fraction(1, 3), Fraction(1), Fraction(5, 2))
    name = _pick(rng, _POLICY_DRAWS)
    return PolicyParameters(
        name=name,
        min_load=_pick(rng, (*shares, 0, 1, 2, 7)),
        batch=int(rng.integers(1, 21)),
        ask_at_least=int(rng.integers(1, 9)),
        load_info=_pick(rng, ("piggyback", "piggyback", "exact", "none", "two", *_SAMPLED)),
        refresh_ps=_pick(rng, (None, None, 0, 1, 1000, 10**6)),
        merge_requests=bool(rng.integers(2)),
        packing=_pick(rng, POLICIES[name].packings),
    )


SHARING = PolicyParameters(
    "concurrent", min_load=0, batch=3, ask_at_least=1, merge_requests=False, packing="all"
)
"""What often lets rays and requests ride together."""


def random_case(seed: int) -> Case:
    """The case of a seed: the same on every machine."""
    rng = np.random.default_rng(seed)
    workload, machine = random_workload(rng), random_machine(rng)
    placement = random_placement(rng, workload, machine.processors)
    order = _pick(rng, ("depth-first", "breadth-first"))
    machine = replace(machine, contention=_pick(rng, CONTENTIONS))
    machine = with_costs_of_today(on_some_network(machine, seed), seed)
    placement = on_islands(placement, _some_islands(machine.processors, seed))
    return Case(workload, machine, placement, random_policy(rng), order)


def some_stealing(case: Case, seed: int) -> Case:
    """The case where, in every third of them, PEs steal; draws from a stream of its own."""
    steal = _pick(np.random.default_rng((seed, 20)), ("none", "none", "half"))
    return replace(case, policy=replace(case.policy, steal=steal))


def stealing_case(seed: int) -> Case:
    """The random case of a seed, where PEs steal."""
    case = random_case(seed)
    return replace(case, policy=replace(case.policy, steal="half"))


def _some_islands(processors: int, seed: int) -> int:
    """Two thirds of the machines are whole; draws from a stream of its own."""
    rng = np.random.default_rng((seed, 16))
    numbers = [n for n in range(1, processors + 1) if processors % n == 0]
    return int(_pick(rng, (1, 1, _pick(rng, numbers))))


def with_capacity(case: Case, seed: int, **changes: Any) -> Case:
    """The case on PEs whose memory ends: at the least, near it, or far beyond."""
    rng = np.random.default_rng((seed, 17))
    wishes = (Fraction(0), Fraction(1, 4), Fraction(2, 5), Fraction(1, 3), Room(0), Room(3000))
    drawn = {
        "bytes": LEAST,
        "escape": "fetch",
        "buffers": _pick(rng, wishes),
        "fetch": _pick(rng, wishes),
        "flow": "credits" if rng.random() < 0.9 else "none",
    }
    bounds = Capacity(**(drawn | changes))
    case = with_policy(case, merge_requests=True)
    case = replace(case, machine=replace(case.machine, service="pe"))
    case = _some_filling(replace(case, placement=replace(case.placement, capacity=bounds)), seed)
    beyond = int(_pick(rng, (0, 0, 1, 100, 1000, 10_000, 50_000)))
    if beyond and "bytes" not in changes:
        least = needs_of(case.workload, case.machine, case.placement, case.policy).least_bytes
        bounds = replace(bounds, bytes=least + beyond)
    return replace(case, placement=replace(case.placement, capacity=bounds))


def _some_filling(case: Case, seed: int) -> Case:
    """In a third of the cases replicas fill what the capacity leaves; draws from a stream of its
    own."""
    rng, placement = np.random.default_rng((seed, 21)), case.placement
    if rng.random() < 2 / 3:
        return case
    owners, nothing = placement.owners, [()] * placement.processors
    ranked = [
        rng.permutation(np.flatnonzero(owners != pe % placement.island)).astype(np.int32)
        for pe in range(placement.processors)
    ]
    bare = placement_of(owners.tolist(), placement.pixel_pes.tolist(), len(nothing), nothing)
    filling = Filling(ranked.__getitem__, bool(rng.integers(2)))
    given: dict[str, Any] = {
        "transient": placement.transient,
        "transient_bytes": placement.transient_bytes,
    }
    placement = replace(
        bare, islands=placement.islands, capacity=placement.capacity, filling=filling, **given
    )
    return replace(case, placement=placement)


def on_torus(case: Case) -> Case:
    """The case on a torus, if need be a ring."""
    return replace(case, machine=replace(case.machine, topology=TORUS, levels=()))


def cases() -> st.SearchStrategy[Case]:
    """Random cases for hypothesis; an example is told by its seed."""
    return st.integers(0, 2**32 - 1).map(random_case)


def policies_of(case: Case) -> list[Case]:
    """The same case under every policy, with everything that it may pack."""
    return [
        with_policy(case, name=name, packing=packing)
        for name, policy in POLICIES.items()
        for packing in policy.packings
    ]


def with_policy(case: Case, **changes: Any) -> Case:
    """The same case under another policy; it packs nothing where it can't pack as the case does."""
    if case.policy.packing not in POLICIES[changes.get("name", case.policy.name)].packings:
        changes = {"packing": "none"} | changes
    return replace(case, policy=replace(case.policy, **changes))
