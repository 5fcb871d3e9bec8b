"""What messages cost their PEs: startups, packing and unpacking."""

from __future__ import annotations

from typing import Any

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import BY_NIC, BY_THREAD, NONE, PACK, UNPACK, Run
from simmpp.engine.arrays.views import copy_costs, messages, topology
from simmpp.machine.messages import LOAD, REQUEST
from simmpp.machine.topology import receive_startup_ps, send_startup_ps
from simmpp.machine.transfer import transfer_ps


@kernel
def sending_ps(s: Run, me: int, other: int, kind: int) -> int:
    """Startup of a message from ``me`` to another PE, by the kind of its first part."""
    if s.service == BY_NIC and kind in (REQUEST, LOAD):
        return s.get_startup_ps
    return send_startup_ps(topology(s), me, other, s.send_startup_ps)


@kernel
def receiving_ps(s: Run, me: int, other: int, kind: int) -> int:
    """Startup of the receipt by ``me``, or its thread, of a message from another PE."""
    if s.service == BY_NIC:
        return s.completion_ps
    return receive_startup_ps(topology(s), other, me, s.receive_startup_ps)


@kernel
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one part: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)


@kernel
def sent_alone_ps(s: Run, me: int, other: int, kind: int, payload_bytes: int) -> int:
    """What a PE pays for sending a message of one part."""
    return sending_ps(s, me, other, kind) + copy_ps(copy_costs(s)[PACK + kind], payload_bytes)


@kernel
def received_alone_ps(s: Run, me: int, other: int, kind: int, payload_bytes: int) -> int:
    """What a PE, or its thread, pays for receiving one."""
    return receiving_ps(s, me, other, kind) + copy_ps(copy_costs(s)[UNPACK + kind], payload_bytes)


@kernel
def taken_in_ps(s: Run, me: int, other: int, kind: int, payload_bytes: int) -> tuple[int, int]:
    """What the receipt of one costs a PE itself, and what its thread does for it before."""
    receipt_ps = received_alone_ps(s, me, other, kind, payload_bytes)
    if s.service == BY_THREAD:
        return s.handoff_ps, receipt_ps
    return receipt_ps, 0


@kernel
def parts_ps(s: Run, message: int, which: int) -> int:
    """Packing (``which`` is PACK) or unpacking (UNPACK) of all parts of a message."""
    m = messages(s)[message]
    cost_ps = copy_ps(copy_costs(s)[which + m.kind], m.part_bytes)
    while m.part != NONE:
        m = messages(s)[m.part]
        cost_ps += copy_ps(copy_costs(s)[which + m.kind], m.part_bytes)
    return cost_ps
