"""Rays of which a PE uses each object so many times: each meets some objects, drawn at random."""

from __future__ import annotations

import numpy as np

from simmpp.workload.workload import PRIMARY, Workload, frozen


def random_rays(
    n_rays: int, n_objects: int, each: int, object_bytes: int, seed: int = 0
) -> Workload:
    """Primary rays in a row, each tested against ``each`` different objects of one size.

    Of 1,000 rays of a PE that meet 4 of 100 objects each object is used 40 times there.
    """
    rng = np.random.default_rng(seed)
    met = rng.integers(0, n_objects - np.arange(each), (n_rays, each))  # of those that are left
    for column in range(1, each):
        for before in np.sort(met[:, :column], axis=1).T:
            met[:, column] += met[:, column] >= before
    none = np.zeros(0, np.int64)
    return frozen(
        Workload(
            name=f"random rays, {n_objects} objects of {object_bytes} B",
            digest="",
            picture=(1, n_rays),
            kinds=np.full(n_rays, PRIMARY, np.uint8),
            parents=np.full(n_rays, -1, np.int32),
            child_offsets=np.full(n_rays + 1, n_rays, np.int32),
            pixels=np.arange(n_rays, dtype=np.int32),
            hits=met[:, -1].astype(np.int32),
            hit_distances=np.ones(n_rays),
            itinerary_offsets=np.arange(0, n_rays * each + 1, each, dtype=np.int64),
            itinerary_objects=met.ravel().astype(np.int32),
            object_kinds=np.zeros(n_objects, np.uint8),
            object_triangles=np.zeros(n_objects, np.int32),
            object_bytes=np.full(n_objects, object_bytes, np.int64),
            object_centroids=rng.random((n_objects, 3)),
            object_test_ps=none,
        )
    )
