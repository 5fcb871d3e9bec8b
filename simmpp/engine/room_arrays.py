"""The memory of PEs at time 0, where it has a capacity, as the engines see it."""

from __future__ import annotations

import numpy as np

from simmpp.engine.arrays.records import NONE, ROOM
from simmpp.engine.capacity import capacity_bytes, most_alive, needs_of, split
from simmpp.engine.residency import Arrays
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

MANY = 1 << 62
"""Rays without size: there is room for all."""


def room_arrays(
    workload: Workload, machine: Machine, placement: Placement, policy: PolicyParameters
) -> Arrays:
    """The arrays ``rooms`` and ``most_alive`` of a run; empty without a capacity."""
    bounds, nb = placement.capacity, placement.processors
    if bounds is None:
        return {"rooms": np.zeros(0, ROOM), "most_alive": np.zeros(0, np.int32)}
    needs, rooms = needs_of(workload, machine, placement, policy), np.zeros(nb, ROOM)
    rooms["resident"], rooms["peak"] = needs.resident, needs.resident
    rooms["first"] = rooms["stuck"] = rooms["since_ps"] = NONE
    if not bounds.has_credits:
        return {"rooms": rooms, "most_alive": np.zeros(0, np.int32)}
    parts = split(needs, bounds, capacity_bytes(bounds, needs))
    ray_bytes, share = machine.ray_bytes, parts.receive // max(1, nb - 1)
    rooms["queue_rays"] = parts.queue // ray_bytes if ray_bytes else MANY
    rooms["share"] = share
    fitting = (share - machine.header_bytes) // ray_bytes if ray_bytes else MANY
    rooms["share_rays"] = np.maximum(1, fitting)
    rooms["fetch_bytes"] = parts.fetch
    return {"rooms": rooms, "most_alive": most_alive(workload)}
