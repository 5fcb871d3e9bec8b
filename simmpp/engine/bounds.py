"""The memory of PEs where it has a capacity: as engines get it, and what became of it."""

from __future__ import annotations

import numpy as np

from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.records import FOR_CREDIT, NONE, ROOM
from simmpp.engine.capacity import Needs, capacity_bytes, split
from simmpp.engine.memory_use import MemoryUse
from simmpp.engine.residency import Arrays
from simmpp.engine.state import State
from simmpp.machine.machine import Machine
from simmpp.machine.messages import LOAD
from simmpp.placement.placement import Placement
from simmpp.placement.rooms import Capacity

MANY = 1 << 62
"""Rays without size: there is room for all."""


def room_arrays(placement: Placement, machine: Machine, needs: Needs | None) -> Arrays:
    """The arrays ``rooms`` and ``most_alive`` of a run; empty without a capacity."""
    bounds, nb, ray_bytes = placement.capacity, placement.processors, machine.ray_bytes
    if bounds is None or needs is None:
        return {"rooms": np.zeros(0, ROOM), "most_alive": np.zeros(0, np.int32)}
    rooms = np.zeros(nb, ROOM)
    rooms["resident"] = rooms["peak"] = needs.resident + needs.replicas
    rooms["first"] = rooms["stuck"] = NONE
    if not bounds.has_credits:
        return {"rooms": rooms, "most_alive": np.zeros(0, np.int32)}
    parts = split(needs, bounds, capacity_bytes(bounds, needs))
    rooms["queue_rays"] = parts.queue // ray_bytes if ray_bytes else MANY
    rooms["share"] = share = parts.receive // max(1, placement.island - 1)
    fitting = (share - machine.header_bytes) // ray_bytes if ray_bytes else MANY
    rooms["share_rays"] = np.maximum(1, fitting)
    rooms["fetch_bytes"] = parts.fetch
    return {"rooms": rooms, "most_alive": needs.most_alive}


def memory_use(state: State, bounds: Capacity | None, needs: Needs | None) -> MemoryUse | None:
    """What became of the memory in a run that is over; None without a capacity."""
    if bounds is None or needs is None:
        return None
    rooms = state.arrays["rooms"]
    fullest, capacity = rooms[rooms["peak"].argmax()], capacity_bytes(bounds, needs)
    held = 0 if bounds.has_credits else int((rooms["peak"] + needs.control).max())
    sends_ps, receives_ps, asks_ps = _stalled_ps(state)
    return MemoryUse(
        peak_resident=int(fullest["resident"]),
        peak_fetched=int(fullest["peak_fetched"]),
        peak_ray_queue=int(fullest["peak_queue"]),
        peak_receive=int(fullest["peak_receive"]),
        peak_control=int(rooms["peak_control"].max()),
        stalled_send_ps=sends_ps,
        stalled_receive_ps=receives_ps,
        stalled_ask_ps=asks_ps,
        credit_messages=int(rooms["credit_messages"].sum()) - _late(state),
        escapes=int(rooms["escapes"].sum()),
        least_bytes=needs.least_bytes,
        fits=int(capacity >= max(needs.least_bytes, held)),
        exceeds_bytes=max(0, held - capacity),
        infeasible=int(bool(state.infeasible)),
        reason=state.infeasible,
    )


def _stalled_ps(state: State) -> tuple[int, int, int]:
    """Times over all PEs; what is still refused ends with the run."""
    rooms, end_ps = state.arrays["rooms"], state["last_ray_ps"]
    is_stalled = rooms["stalled"][:, None] >> np.arange(3) & 1
    lasting = is_stalled * np.maximum(end_ps - rooms["since_ps"], 0)
    sends_ps, receives_ps, asks_ps = (rooms["stalled_ps"] + lasting).sum(axis=0).tolist()
    return sends_ps, receives_ps, asks_ps


def _late(state: State) -> int:
    """Messages of credit that would have departed after the end."""
    used = state.messages[: state.arrays["message_marks"][USED]]
    of_credit = (used["kind"] == LOAD) & (used["purpose"] == FOR_CREDIT)
    return int((of_credit & (used["depart_ps"] > state["last_ray_ps"])).sum())
