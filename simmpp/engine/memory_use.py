"""What became of the memory of PEs in a run with a capacity: columns of ``results.csv``."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from simmpp.common.documented import documented
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.records import FOR_CREDIT, NONE
from simmpp.engine.capacity import Needs, capacity_bytes, needs_of
from simmpp.engine.state import State
from simmpp.machine.machine import Machine
from simmpp.machine.messages import LOAD
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


@documented
@dataclass(frozen=True)
class MemoryUse:
    """Bytes are of one PE, times are summed over PEs; ``reason`` is no column."""

    peak_resident: int
    """Of the PE that ever held most, at that instant: bytes of resident objects,"""
    peak_fetched: int
    """of objects asked for, in use or kept,"""
    peak_ray_queue: int
    """of the rays that those started and taken in may become (with ``flow: none``: of these),"""
    peak_receive: int
    """and of rays that lie unread or in shares, with the headers of their messages."""
    peak_control: int
    """Most bytes of unread requests and of headers without rays, in any PE."""
    stalled_send_ps: int
    """Time in which credit kept rays that a rule would have sent,"""
    stalled_receive_ps: int
    """in which rays lay in shares for want of room,"""
    stalled_ask_ps: int
    """in which objects were not asked for, for want of room."""
    credit_messages: int
    """Messages of nothing but credit; they count as loads as well."""
    escapes: int
    """Objects asked for because nothing else could be done."""
    fits: int
    """1 if the capacity is enough: for what is needed at least and, with ``flow: none``, for all
    that was held."""
    exceeds_bytes: int
    """With ``flow: none``, by how much more was held."""
    infeasible: int
    """1 if the run could not be brought to its end."""
    reason: str = ""
    """Why not, or why it was not begun."""


COLUMNS = tuple(field.name for field in fields(MemoryUse) if field.name != "reason")
"""Further columns of sweeps in which a PE's memory has a capacity."""


def memory_use(
    state: State,
    workload: Workload,
    machine: Machine,
    placement: Placement,
    policy: PolicyParameters,
) -> MemoryUse | None:
    """What became of the memory in a run that is over; None without a capacity."""
    bounds, rooms = placement.capacity, state.arrays["rooms"]
    if bounds is None:
        return None
    needs, fullest = needs_of(workload, machine, placement, policy), rooms[rooms["peak"].argmax()]
    capacity = capacity_bytes(bounds, needs)
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
        fits=int(capacity >= max(needs.least_bytes, held)),
        exceeds_bytes=max(0, held - capacity),
        infeasible=int(bool(state.infeasible)),
        reason=state.infeasible,
    )


def unfit(needs: Needs, capacity: int) -> MemoryUse:
    """Of a run that is not begun: the capacity is less than what it needs."""
    peak = int(needs.resident.max())
    reason = f"needs at least {needs.least_bytes} B per PE, the capacity is {capacity} B"
    return MemoryUse(peak, *[0] * (len(COLUMNS) - 1), reason=reason)


def _stalled_ps(state: State) -> tuple[int, int, int]:
    """Times over all PEs; what is still refused ends with the run."""
    rooms, end_ps = state.arrays["rooms"], state["last_ray_ps"]
    since = rooms["since_ps"]
    lasting = np.where(since == NONE, 0, np.maximum(end_ps - since, 0))
    sends_ps, receives_ps, asks_ps = (rooms["stalled_ps"] + lasting).sum(axis=0).tolist()
    return sends_ps, receives_ps, asks_ps


def _late(state: State) -> int:
    """Messages of credit that would have departed after the end."""
    used = state.messages[: state.arrays["message_marks"][USED]]
    of_credit = (used["kind"] == LOAD) & (used["purpose"] == FOR_CREDIT)
    return int((of_credit & (used["depart_ps"] > state["last_ray_ps"])).sum())
