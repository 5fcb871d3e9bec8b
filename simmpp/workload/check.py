"""Does a workload contradict itself? Asked of every file before anything else reads it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import WorkloadError
from simmpp.workload.workload import (
    ARRAYS,
    BARREN,
    MOST_TEST_SCALE,
    OBJECT_KINDS,
    OPTIONAL,
    PARTICLE,
    RAY_KINDS,
    ROOTS,
    Workload,
)

MOST_DEPOSITED = 2.0**62
"""Units of all deposits together, so that int64 can count them."""


def check(workload: Workload, where: str) -> None:
    """Raise WorkloadError, naming ``where``, unless the arrays fit together."""
    problem = _problem_of_shapes(workload) or _problem_of_rays(workload)
    problem = problem or _problem_of_itineraries(workload) or _problem_of_extras(workload)
    if problem:
        raise WorkloadError(problem, where=where)


def _problem_of_shapes(workload: Workload) -> str:
    n, n_objects = workload.n_rays, workload.n_objects
    lengths = {"child_offsets": n + 1, "itinerary_offsets": n + 1}
    lengths |= {"test_deposits": workload.n_tests, "round_residuals": workload.n_rounds}
    for name, dtype in ARRAYS.items():
        array = getattr(workload, name)
        if array.dtype != dtype:
            return f"{name} is {array.dtype}, expected {np.dtype(dtype)}"
        if array.ndim != (2 if name == "object_centroids" else 1):
            return f"{name} has {array.ndim} dimensions"
        per_row = {"object": n_objects, "root": workload.n_primaries}
        expected = lengths.get(name, per_row.get(name.partition("_")[0], n))
        if name in OPTIONAL and len(array) == 0:
            continue
        if name != "itinerary_objects" and len(array) != expected:
            return f"{name} has {len(array)} entries, expected {expected}"
    if workload.object_centroids.shape[1] != 3:
        return f"object_centroids has {workload.object_centroids.shape[1]} columns, expected 3"
    if min(*workload.picture, workload.samples) < 1 or workload.n_primaries > n:
        return f"picture {workload.picture} does not fit {n} rays"
    return ""


def _problem_of_rays(workload: Workload) -> str:
    n, first = workload.n_rays, workload.n_primaries
    numbers = np.arange(n)
    kinds, parents, pixels = workload.kinds, workload.parents, workload.pixels
    begins = np.isin(kinds, ROOTS)
    if (kinds >= len(RAY_KINDS)).any() or (begins != (numbers < first))[kinds != PARTICLE].any():
        return "kinds of rays do not fit the picture"
    if (parents[:first] != -1).any() or (pixels[:first] != numbers[:first]).any():
        return "a primary ray has a parent or another's pixel"
    offsets = workload.child_offsets
    if not is_cut(offsets, n, first, n):
        return "child_offsets do not cut the rays"
    if (parents[first:] != np.repeat(numbers, np.diff(offsets))).any():
        return "parents and child_offsets disagree"
    if (parents[first:] >= numbers[first:]).any():
        return "a ray comes before its parent"
    if (pixels[first:] != pixels[parents[first:]]).any():
        return "a ray has another pixel than its parent"
    if (np.diff(offsets)[np.isin(kinds, BARREN) | (workload.hits < 0)] > 0).any():
        return "a shadow ray, or one that hits nothing, has children"
    return ""


def _problem_of_itineraries(workload: Workload) -> str:
    offsets, objects, hits = workload.itinerary_offsets, workload.itinerary_objects, workload.hits
    if not is_cut(offsets, workload.n_rays, 0, len(objects)):
        return "itinerary_offsets do not cut the itineraries"
    for name, ids, least in (("itinerary_objects", objects, 0), ("hits", hits, -1)):
        if len(ids) and (ids.min() < least or ids.max() >= workload.n_objects):
            return f"{name} names an object outside 0 ... {workload.n_objects - 1}"
    distances = workload.hit_distances
    if not (np.isfinite(distances) == (hits >= 0)).all() or not (distances >= 0).all():
        return "hits and hit_distances disagree"
    if not np.isin(np.flatnonzero(hits >= 0), _rays_that_test_their_hit(workload)).all():
        return "a ray hits an object that is not in its itinerary"
    if (workload.object_kinds >= len(OBJECT_KINDS)).any():
        return "object_kinds has an unknown kind"
    if (workload.object_bytes < 0).any() or (workload.object_triangles < 0).any():
        return "an object has a negative size"
    if (workload.object_test_ps < 0).any():
        return "an object has a negative cost"
    if not np.isfinite(workload.object_centroids).all():
        return "object_centroids are not finite"
    return ""


def _problem_of_extras(workload: Workload) -> str:
    rounds, homes, weights = workload.root_rounds, workload.root_homes, workload.root_weights
    if len(rounds) and (rounds.min() < 0 or first_gap(rounds) >= 0):
        return "root_rounds leave out a round"
    if len(homes) and (homes.min() < -1 or homes.max() >= workload.n_objects):
        return f"root_homes names an object outside 0 ... {workload.n_objects - 1}"
    if not (np.isfinite(weights) & (weights >= 0)).all():
        return "a root has a weight that is negative, or not finite"
    if (workload.ray_test_scales > MOST_TEST_SCALE).any():
        return f"a ray's tests cost more than 2^{MOST_TEST_SCALE} of the object's"
    if (workload.object_results < 0).any():
        return "an object has results of a negative size"
    deposits, residuals = workload.test_deposits, workload.round_residuals
    if len(deposits) and (deposits.min() < 0 or deposits.sum(dtype=np.float64) >= MOST_DEPOSITED):
        return "a test deposits less than nothing, or all together too much"
    if not ((residuals >= 0) & (residuals <= 1)).all():
        return "a share that is left after a round is not from 0 to 1"
    return ""


def first_gap(rounds: NDArray[np.signedinteger]) -> int:
    """The least round below the greatest that no root is of; -1 if there is none."""
    found = np.unique(rounds)  # not a count of each: the greatest may be 2^31
    gaps = np.flatnonzero(found != np.arange(len(found)))
    return int(gaps[0]) if len(gaps) else -1


def is_cut(offsets: NDArray[np.signedinteger], n: int, first: int, last: int) -> bool:
    """Do n + 1 offsets cut the numbers first ... last - 1 into n parts?"""
    if len(offsets) != n + 1 or offsets[0] != first or offsets[-1] != last:
        return False
    return bool((offsets[1:] >= offsets[:-1]).all())


def _rays_that_test_their_hit(workload: Workload) -> NDArray[np.int64]:
    rays = np.repeat(np.arange(workload.n_rays), np.diff(workload.itinerary_offsets))
    return rays[workload.itinerary_objects == workload.hits[rays]]
