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


def beyond_the_clock() -> ConfigError:
    """The error of a run that would last too long."""
    return ConfigError(
        f"the simulated time exceeds the clock's {CLOCK_LIMIT_PS} ps (53 days): "
        "expected smaller costs or a smaller workload"
    )
