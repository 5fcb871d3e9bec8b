"""What packing and unpacking cost a PE."""

from __future__ import annotations

from typing import Any

from simmpp.common.compiled import kernel
from simmpp.machine.transfer import transfer_ps


@kernel
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one part: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)
