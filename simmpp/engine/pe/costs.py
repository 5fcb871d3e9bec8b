"""What messages cost their PEs: startups, packing and unpacking."""

from __future__ import annotations

from typing import Any

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import Run
from simmpp.engine.arrays.views import topology
from simmpp.machine.topology import receive_startup_ps, send_startup_ps
from simmpp.machine.transfer import transfer_ps


@kernel
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one part: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)


@kernel
def sending_ps(s: Run, me: int, other: int, kind: int) -> int:
    """Startup of a message from ``me`` to another PE, by the kind of its first part."""
    return send_startup_ps(topology(s), me, other, s.send_startup_ps)


@kernel
def receiving_ps(s: Run, me: int, other: int, kind: int) -> int:
    """Startup of the receipt by ``me`` of a message from another PE."""
    return receive_startup_ps(topology(s), other, me, s.receive_startup_ps)
