"""How long a machine works on a workload, whoever does it, and whether its clock can hold that."""

from __future__ import annotations

from fractions import Fraction
from math import floor

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.machine.machine import Machine
from simmpp.machine.noise import ONE, factors
from simmpp.machine.topology import topology_of
from simmpp.machine.transfer import PS_PER_S, slower
from simmpp.machine.uneven import bound_of, speeds_of, total_speed
from simmpp.workload.workload import Workload

CLOCK_LIMIT_PS = 1 << 62
"""The clock is int64 picoseconds; it is stopped at half of them (53 days), before it can wrap."""
MOST_BYTES = 1 << 62
"""Counters of bytes are int64 too."""


def total_compute_ps(workload: Workload, machine: Machine) -> int:
    """What one PE alone, with everything in memory, would take: T(1).

    Raises ConfigError if that is beyond the clock.
    """
    tests = _tests_of_objects(workload)
    cost_ps = machine.test.of_objects(workload, np.float64)
    # In float64 nothing wraps; once the sum is known to fit, it is made exactly.
    if float(tests @ cost_ps) + float(workload.n_rays) * machine.ray_ps >= CLOCK_LIMIT_PS:
        raise beyond_the_clock()
    return int(tests @ machine.test.of_objects(workload)) + workload.n_rays * machine.ray_ps


def _tests_of_objects(workload: Workload) -> NDArray[np.int64]:
    """Tests of each object, those that cost 2^k of its own counted as so many: (N,) int64."""
    objects, n_objects, times = workload.itinerary_objects, workload.n_objects, None
    if len(workload.ray_test_scales):
        of_rays = 1 << workload.ray_test_scales.astype(np.int64)
        times = np.repeat(of_rays, np.diff(workload.itinerary_offsets))
    return np.bincount(objects, times, n_objects).astype(np.int64)  # float64 is exact to 2^53


def _longest_test_ps(workload: Workload, machine: Machine) -> float:
    scale = int(workload.ray_test_scales.max(initial=0))
    return float(machine.test.of_objects(workload, np.float64).max(initial=0)) * 2.0**scale


def bound_ps(workload: Workload, machine: Machine) -> int:
    """T(1) / the sum of all PEs' speeds, rounded up: none can be faster, but by luck with noise."""
    return bound_of(total_compute_ps(workload, machine), machine.speed, machine.processors)


def least_ps(workload: Workload, machine: Machine) -> int:
    """No run takes less: all rays, and all tests as if of the cheapest object, on all PEs."""
    test_ps = int(machine.test.of_objects(workload).min(initial=CLOCK_LIMIT_PS))
    total_ps = workload.n_rays * machine.ray_ps + workload.n_tests * test_ps
    least = Fraction(factors(machine.noise)[0], ONE)
    return floor(total_ps * least / total_speed(machine.speed, machine.processors))


def check_counters(workload: Workload, machine: Machine) -> None:
    """Raise ConfigError if a run could wrap its clock or its counters of bytes.

    The engines look at the clock at every instant of a PE; here is seen to it that no single
    activity and no single flight takes half of the clock. Bounds, in Python's integers.
    """
    most_ps = (
        workload.n_tests * _longest_test_ps(workload, machine) + workload.n_rays * machine.ray_ps
    )
    if most_ps >= CLOCK_LIMIT_PS:
        total_compute_ps(workload, machine)  # looks closer
    if machine.is_uneven and _longest_go_ps(workload, machine) >= CLOCK_LIMIT_PS:
        raise beyond_the_clock()
    if max(_longest_dispatch_ps(workload, machine), _longest_flight_ps(workload, machine)) > (
        CLOCK_LIMIT_PS // 2
    ):
        raise beyond_the_clock()
    each_bytes = 2 * machine.header_bytes + machine.request_bytes + machine.ray_bytes
    sent_bytes = workload.n_tests * (each_bytes + _largest_object_bytes(workload))
    held_bytes = float(workload.object_bytes.sum(dtype=np.float64))
    if max(sent_bytes, held_bytes + workload.n_rays * machine.ray_bytes) >= MOST_BYTES:
        raise ConfigError(
            f"the bytes sent or held could exceed {MOST_BYTES}: expected smaller rays and objects"
        )


def _longest_go_ps(workload: Workload, machine: Machine) -> float:
    """No go at computing takes longer: all of it, on the slowest PE, with lanes left empty."""
    test_ps = _longest_test_ps(workload, machine)
    cost_ps = total_compute_ps(workload, machine) + machine.least_tests * test_ps
    slowest = max(1 / min(speeds_of(machine.speed, machine.processors)), Fraction(1))
    factor = slowest * Fraction(machine.straggler.factor) * max(factors(machine.noise)) / ONE
    return machine.compute_startup_ps + cost_ps * float(factor)


def _largest_object_bytes(workload: Workload) -> int:
    return int(workload.object_bytes.max(initial=0))


def _largest_payload_bytes(workload: Workload, machine: Machine) -> int:
    all_rays_bytes = workload.n_rays * machine.ray_bytes
    return max(_largest_object_bytes(workload), all_rays_bytes, machine.request_bytes)


def _longest_dispatch_ps(workload: Workload, machine: Machine) -> int:
    """No dispatch sends more than a request per ray and object, and a batch and a load per PE."""
    messages = workload.n_rays + workload.n_objects + 2 * machine.processors
    costs = (*machine.pack, *machine.unpack)
    fixed_ps = machine.per_message_ps + max(cost.fixed_ps for cost in costs)
    copied_bytes = _largest_payload_bytes(workload, machine) + messages * machine.request_bytes
    rates = [cost.bytes_per_s for cost in costs if cost.bytes_per_s]
    copy_ps = copied_bytes * PS_PER_S // min(rates) if rates else 0
    return messages * fixed_ps + copy_ps


def _longest_flight_ps(workload: Workload, machine: Machine) -> int:
    """The largest message from one end of the network to the other."""
    topology, n_bytes = topology_of(machine), _largest_payload_bytes(workload, machine)
    rate = slower(*topology.rates)
    transfer_ps = (n_bytes + machine.header_bytes) * PS_PER_S // rate if rate else 0
    return topology.longest_ps + transfer_ps


def beyond_the_clock() -> ConfigError:
    """The error of a run that would last too long."""
    return ConfigError(
        f"the simulated time exceeds the clock's {CLOCK_LIMIT_PS} ps (53 days): "
        "expected smaller costs or a smaller workload"
    )
