"""What no run of a candidate can take less than, without running it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from simmpp.machine.limits import bound_ps
from simmpp.machine.machine import Machine
from simmpp.placement.pixels import pixel_pes
from simmpp.studies.advise.candidates import Candidate
from simmpp.workload.workload import Workload


def bound_of(candidate: Candidate, workload: Workload) -> int:
    """A makespan in ps: all tests and rays, dealt evenly or, where rays stay, as pixels are."""
    machine, rules = candidate.machine, candidate.policy.rules
    even_ps = bound_ps(workload, machine)
    leaves = rules.sends or candidate.policy.rests  # work can go elsewhere
    pixels = candidate.config.settings.placement.pixels
    if leaves or machine.is_uneven or pixels == "random":
        return even_ps
    of_pixels = np.asarray(pixel_pes(pixels, workload.picture, machine.processors, seed=0))
    busy_ps = np.bincount(of_pixels, _of_pixels_ps(workload, machine), machine.processors)
    return max(even_ps, int(busy_ps.max()))


@lru_cache(maxsize=4)
def _pixel_costs(workload: Workload, costs: bytes, ray_ps: int) -> NDArray[np.float64]:
    cost_ps = np.frombuffer(costs, np.float64)
    of_tests = np.concatenate([[0.0], np.cumsum(cost_ps[workload.itinerary_objects])])
    of_rays = np.diff(of_tests[workload.itinerary_offsets]) + ray_ps
    pixels = workload.pixels % workload.n_pixels
    return np.bincount(pixels, of_rays, workload.n_pixels).astype(np.float64)


def _of_pixels_ps(workload: Workload, machine: Machine) -> NDArray[np.float64]:
    """What each pixel's rays and all that they bring forth take: (n_pixels,) float64."""
    costs = machine.test.of_objects(workload, np.float64)
    return _pixel_costs(workload, np.ascontiguousarray(costs).tobytes(), machine.ray_ps)
