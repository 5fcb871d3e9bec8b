"""How long a machine computes on a workload, whoever does it: what no policy can change."""

from __future__ import annotations

import numpy as np

from simmpp.errors import ConfigError
from simmpp.machine.machine import Machine
from simmpp.workload.workload import Workload

CLOCK_LIMIT_PS = 1 << 62
"""The clock is int64 picoseconds; it is stopped at half of them (53 days), before it can wrap."""


def total_compute_ps(workload: Workload, machine: Machine) -> int:
    """What one PE alone, with everything in memory, would take: T(1).

    Raises ConfigError if that is beyond the clock.
    """
    tests = np.bincount(workload.itinerary_objects, minlength=workload.n_objects)
    cost_ps = machine.test.of_objects(workload, np.float64)
    # In float64 nothing wraps; once the sum is known to fit, it is made exactly.
    if float(tests @ cost_ps) + float(workload.n_rays) * machine.ray_ps > CLOCK_LIMIT_PS:
        raise beyond_the_clock()
    return int(tests @ machine.test.of_objects(workload)) + workload.n_rays * machine.ray_ps


def check_transfers(workload: Workload, machine: Machine) -> None:
    """Raise ConfigError if the largest message that there can be would take half of the clock."""
    largest_object = int(workload.object_bytes.max(initial=0))
    payload_bytes = max(largest_object, workload.n_rays * machine.ray_bytes, machine.request_bytes)
    copies = [cost.bytes_per_s for cost in (*machine.pack, *machine.unpack)]
    rates = [*copies, machine.link_bytes_per_s, machine.injection_bytes_per_s]
    slowest = min((rate for rate in rates if rate), default=0)
    transfer_ps = (payload_bytes + machine.header_bytes) * 10**12 // slowest if slowest else 0
    if transfer_ps > CLOCK_LIMIT_PS // 2:
        raise beyond_the_clock()


def beyond_the_clock() -> ConfigError:
    """The error of a run that would last too long."""
    return ConfigError(
        f"the simulated time exceeds the clock's {CLOCK_LIMIT_PS} ps (53 days): "
        "expected smaller costs or a smaller workload"
    )
