"""Small machines at random, to see that a policy does on all of them what it has to do."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from simmpp.common.randomness import generator
from simmpp.machine.machine import CopyCost, Machine
from simmpp.machine.presets import machine
from simmpp.model.synthetic import synthetic
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

_TIMES_PS = (0, 1, 1000, 10**6, 10**9)
"""From nothing to a millisecond: what is dear on one machine is cheap on the next."""


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
        load_info=("piggyback", "exact", "none")[int(rng.integers(3))],
        merge_requests=bool(rng.integers(2)),
        packing=packings[int(rng.integers(len(packings)))],
    )
    order = ("depth-first", "breadth-first")[int(rng.integers(2))]
    return Case(seed, workload, _random_machine(rng, processors), placement, variant, order)


def _random_machine(rng: np.random.Generator, processors: int) -> Machine:
    def time_ps() -> int:
        return _TIMES_PS[int(rng.integers(len(_TIMES_PS)))]

    a, b, c, d = (CopyCost(time_ps(), 0) for _ in range(4))
    return replace(
        machine(processors=processors),
        send_startup_ps=time_ps(),
        receive_startup_ps=time_ps(),
        probe_ps=time_ps(),
        latency_ps=time_ps(),
        hop_latency_ps=time_ps(),
        pack=(a, b, c, d),
        ray_ps=time_ps(),
        quantum=int(rng.integers(1, 9)),
        contention="links" if rng.random() < 0.5 else "none",
    )
