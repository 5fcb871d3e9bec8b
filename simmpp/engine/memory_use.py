"""What became of the memory of PEs in a run with a capacity: columns of ``results.csv``."""

from __future__ import annotations

from dataclasses import dataclass, fields

from simmpp.common.documented import documented


@documented
@dataclass(frozen=True)
class MemoryUse:
    """Bytes are of one PE, times are summed over PEs."""

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
    least_bytes: int
    """The least capacity with which the policy runs (with ``flow: credits``)."""
    fits: int
    """1 if the capacity is enough: for what is needed at least and, with ``flow: none``, for all
    that was held."""
    exceeds_bytes: int
    """With ``flow: none``, by how much more was held; of what was not begun, by how much more is
    needed."""
    infeasible: int
    """1 if the run could not be brought to its end."""
    reason: str = ""
    """Why not."""


REASON = "reason"
COLUMNS = tuple(field.name for field in fields(MemoryUse) if field.name != REASON)
"""Further columns of integers, of sweeps in which a PE's memory has a capacity."""
