"""Memory that ends, as queueing theory has it: windows of rays are customers of closed queues.

One owner has all objects and serves whoever asks, first come, first served: packing an object takes
an exponential time. A test takes one as well, all else nothing. Each test is of an object of its
own, so no two rays share a request.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import factorial
from typing import Any

import numpy as np
import pytest
from builders import placement_of, workload_of
from by_hand import MACHINE, OBJECT

import simmpp
from simmpp.engine.capacity import needs_of
from simmpp.engine.result import Result
from simmpp.engine.simulate import simulate
from simmpp.machine.machine import UNLIMITED, CopyCost, Machine, TestCost
from simmpp.model.synthetic import synthetic
from simmpp.placement.rooms import LEAST, Capacity
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

MEAN_PS, BYTES_PER_S = 10**6, 10**11
"""Of packing an object: 10^5 bytes in the mean."""
VISITS = 20_000
WITHIN = 0.02
FREE = CopyCost(0, UNLIMITED)
NOTHING = (
    *(
        "send_startup_ps",
        "receive_startup_ps",
        "probe_ps",
        "latency_ps",
        "hop_latency_ps",
        "ray_ps",
    ),
)


def machine(processors: int) -> Machine:
    """Nothing takes time but tests and packing objects."""
    free: Any = dict.fromkeys(NOTHING, 0)
    pack = (FREE, CopyCost(0, BYTES_PER_S), FREE, FREE)
    return replace(
        MACHINE,
        shape=(processors, 1, 1),
        pack=pack,
        unpack=(FREE,) * 4,
        link_bytes_per_s=UNLIMITED,
        test=TestCost(0, 0, 0, 0),
        quantum=1,
        **free,
    )


def run(workers: int, rays: int, steps: int, test_ps: float, capacity: int | str) -> Result:
    """Workers have so many rays each, of so many tests; PE 0 owns their objects and has no ray.

    Each worker owns one more, as large as all of these and of no use: so all are equally full.
    """
    rng, n = np.random.default_rng(1998), workers * rays * steps
    itineraries = np.arange(n).reshape(-1, steps).tolist()
    drawn = np.maximum(1, rng.exponential(MEAN_PS * BYTES_PER_S / 10**12, n).round()).astype(int)
    sizes = [*drawn.tolist(), *[int(drawn.sum())] * workers]
    tests_ps = [*rng.exponential(test_ps, n).round().tolist(), *[0] * workers]
    workload = replace(
        workload_of(workers * rays, itineraries, object_bytes=sizes),
        object_test_ps=np.array(tests_ps, np.int64),
    )
    pixel_pes = np.repeat(np.arange(1, workers + 1), rays).tolist()
    placement = replace(
        placement_of([0] * n + list(range(1, workers + 1)), pixel_pes, workers + 1),
        capacity=Capacity(capacity),  # type: ignore[arg-type]
    )
    return simulate(workload, machine(workers + 1), placement, OBJECT)


def busy(result: Result, pe: int, account: str) -> float:
    return float(getattr(result, account)[pe] / result.makespan_ps)


@pytest.mark.parametrize(("workers", "think"), [(2, 2.0), (4, 3.0), (8, 4.0)])
def test_windows_of_one_ray_are_m_m_1_of_a_finite_population(workers: int, think: float) -> None:
    """At the least capacity there is room for one ray: W machines and one repairman."""
    result = run(workers, VISITS // workers, 1, think * MEAN_PS, LEAST)
    assert result.memory is not None and result.memory.escapes == result.tests
    weights = [factorial(workers) / factorial(workers - k) / think**k for k in range(workers + 1)]
    expected = 1 - weights[0] / sum(weights)
    assert busy(result, 0, "communication_ps") == pytest.approx(expected, rel=WITHIN)


@pytest.mark.parametrize(("rays", "r"), [(1, 1.5), (2, 0.5), (3, 2.0), (6, 0.8)])
def test_the_rays_of_one_pe_go_round_between_two_servers(rays: int, r: float) -> None:
    """U = r (1 - r^W) / (1 - r^(W+1)), r: a test over a service."""
    result = run(1, rays, VISITS // rays, r * MEAN_PS, 1 << 40)
    expected = r * (1 - r**rays) / (1 - r ** (rays + 1))
    assert busy(result, 1, "compute_ps") == pytest.approx(expected, rel=WITHIN)


@pytest.mark.parametrize("policy", ["object", "concurrent"])
def test_twice_the_memory_takes_no_longer_in_the_mean(policy: str) -> None:
    """Of 32 placements; so it is where all objects are asked for alike."""
    workload = synthetic(rays=160, steps=4, objects=120, seed=3, object_bytes=200)
    here = simmpp.make_machine("t3e", processors=4)
    times = [
        [makespan(workload, here, policy, seed, more) for seed in range(32)]
        for more in (0, 800, 1600, 3200, 6400)
    ]
    for less, twice in pairwise(times):
        ratios = np.log(np.array(twice) / np.array(less))
        half = 2.04 * ratios.std(ddof=1) / np.sqrt(len(ratios))
        assert ratios.mean() <= half, (policy, times)
    assert np.mean(times[-1]) < 0.7 * np.mean(times[0])


def makespan(workload: Workload, here: Machine, policy: str, seed: int, more: int) -> float:
    """With so many bytes more than the least."""
    memory = simmpp.Memory(fraction=Fraction(1, 4), capacity="least")
    placement = simmpp.place(workload, 4, memory, simmpp.PlacementRules(), seed)
    least = needs_of(workload, here, placement, PolicyParameters(policy)).least_bytes
    placement = replace(placement, capacity=Capacity(least + more))
    return simulate(workload, here, placement, PolicyParameters(policy)).makespan_ps
