"""Small machines at random, to see that a policy does on all of them what it has to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from simmpp.common.randomness import generator
from simmpp.machine.machine import (
    FAT_TREE,
    SERVICES,
    TOPOLOGY_NAMES,
    TORUS,
    CopyCost,
    FatTree,
    Level,
    Machine,
)
from simmpp.machine.presets import machine
from simmpp.model.synthetic import synthetic
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.written import NEVER_PS
from simmpp.workload.workload import Workload

_TIMES_PS = (0, 1, 1000, 10**6, 10**9)
"""From nothing to a millisecond: what is dear on one machine is cheap on the next."""
_LOADS: tuple[dict[str, Any], ...] = (
    {"load_info": "piggyback", "refresh_ps": None, "sample_ps": None},
    {"load_info": "piggyback", "refresh_ps": 10**6, "sample_ps": None},
    *({"load_info": info, "sample_ps": None} for info in ("exact", "two", "none")),
    *({"load_info": "sampled", "sample_ps": ps} for ps in (10**3, 10**8, NEVER_PS)),
)
"""All ways to know loads, new and old ones."""


@dataclass(frozen=True, eq=False)
class Case:
    """One machine, its rays and a variant of the policy."""

    seed: int
    workload: Workload
    machine: Machine
    placement: Placement
    policy: PolicyParameters
    ready_order: str


def random_case(policy: PolicyParameters, seed: int) -> Case:
    """The case of a seed: 1 to 9 PEs, up to 60 rays and 12 objects, costs of any size."""
    rng = generator(seed, "machines for a policy")
    rays, steps, objects = (int(rng.integers(1, most)) for most in (60, 6, 13))
    workload = synthetic(rays, steps, objects, lives="geometric", seed=seed)
    processors = int(rng.integers(2, 10))
    fraction = Fraction(int(rng.integers(0, 7)), 10)
    memory = Memory(fraction=fraction, transient=int(rng.integers(0, 4)))
    placement = place(workload, processors, memory, PlacementRules(owners="random"), seed)
    packings = policy.rules.packings
    variant = replace(
        policy,
        batch=int(rng.integers(1, 9)),
        ask_at_least=int(rng.integers(1, 6)),
        **_LOADS[int(rng.integers(len(_LOADS)))],
        merge_requests=bool(rng.integers(2)),
        packing=packings[int(rng.integers(len(packings)))],
        steal=("none", "none", "half")[int(generator(seed, "who steals").integers(3))],
    )
    order = ("depth-first", "breadth-first")[int(rng.integers(2))]
    return Case(seed, workload, _random_machine(rng, processors), placement, variant, order)


def _random_machine(rng: np.random.Generator, processors: int) -> Machine:
    def time_ps() -> int:
        return _TIMES_PS[int(rng.integers(len(_TIMES_PS)))]

    a, b, c, d = (CopyCost(time_ps(), 0) for _ in range(4))
    return replace(
        _on_some_network(rng, time_ps, processors),
        send_startup_ps=time_ps(),
        receive_startup_ps=time_ps(),
        probe_ps=time_ps(),
        latency_ps=time_ps(),
        hop_latency_ps=time_ps(),
        pack=(a, b, c, d),
        ray_ps=time_ps(),
        quantum=int(rng.integers(1, 9)),
        contention="links" if rng.random() < 0.5 else "none",
        service=SERVICES[int(rng.integers(len(SERVICES)))],
        handoff_ps=time_ps(),
        get_startup_ps=time_ps(),
        completion_ps=time_ps(),
    )


def _on_some_network(
    rng: np.random.Generator, time_ps: Callable[[], int], processors: int
) -> Machine:
    """A torus, blocks in one another with costs of their own, or a fat-tree."""
    topology = TOPOLOGY_NAMES[int(rng.integers(len(TOPOLOGY_NAMES)))]
    if topology == TORUS:
        return machine(processors=processors)
    joined = replace(machine(processors=processors), topology=topology, shape=(processors, 1, 1))
    if topology == FAT_TREE:
        arity = int(rng.integers(2, 4))
        return replace(joined, fat_tree=FatTree(arity, 0, (1, arity)[int(rng.integers(2))]))
    inner, outer = (
        Level(
            name,
            size,
            latency_ps=time_ps(),
            gap_ps=time_ps(),
            send_startup_ps=time_ps(),
            receive_startup_ps=time_ps(),
        )
        for name, size in (("node", int(rng.integers(1, 4))), ("system", 0))
    )
    return replace(joined, levels=(inner, outer))
