"""Replicas that take what a capacity leaves: ``memory.fraction: fill``.

Policies are compared at equal memory, and what one needs for rays that arrive or objects that are
fetched another one has for replicas. So these are dealt when the policy is known, each PE's in the
order of the placement: those of one policy are a prefix of another's.
"""

from __future__ import annotations

from dataclasses import replace

from simmpp.engine.capacity import Needs, capacity_bytes, fits, needs_of, split
from simmpp.engine.residency import resident_bytes
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.placement.residents import fill
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


def filled(
    workload: Workload, placement: Placement, needs: Needs | None
) -> tuple[Placement, Needs | None]:
    """The placement with the replicas that there is room for, and the needs with these.

    They stay as they are where nothing is to be filled.
    """
    bounds, filling = placement.capacity, placement.filling
    if needs is None or bounds is None or filling is None or not needs.fills:
        return placement, needs
    rooms = split(needs, bounds, capacity_bytes(bounds, needs)).replicas
    full = fill(placement, filling, workload.object_bytes, rooms)
    before, after = (resident_bytes(workload, one, False) for one in (placement, full))
    return full, replace(needs, replicas=after - before)


def effective_fraction(
    workload: Workload, machine: Machine, placement: Placement, policy: PolicyParameters
) -> float:
    """The share of the objects that is resident on a PE under a policy, in the mean."""
    if policy.rules.all_resident:
        return 1.0
    if placement.filling is not None:
        needs = needs_of(workload, machine, placement, policy)
        if fits(needs, placement, int(workload.object_bytes.sum())):
            placement, _ = filled(workload, placement, needs)
    return placement.effective_fraction
