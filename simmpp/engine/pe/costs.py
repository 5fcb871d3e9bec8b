"""What a message costs a PE: a startup at each end, and packing and unpacking."""

from __future__ import annotations

from typing import Any

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import BY_NIC, Run
from simmpp.machine.messages import LOAD, REQUEST
from simmpp.machine.transfer import transfer_ps


@kernel
def sending_ps(s: Run, me: int, other: int, kind: int) -> int:
    """What a PE pays for sending a message whose first part is of that kind, besides packing."""
    if s.service == BY_NIC and kind in (REQUEST, LOAD):
        return s.get_startup_ps
    return s.send_startup_ps


@kernel
def receiving_ps(s: Run, me: int, other: int, kind: int) -> int:
    """What PE ``me``, or its thread, pays for receiving one from ``other``, besides unpacking."""
    return s.completion_ps if s.service == BY_NIC else s.receive_startup_ps


@kernel
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one part: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)
