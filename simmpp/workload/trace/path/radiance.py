"""What paths bring home: the light of each pixel, from the recorded hits.

Light that a lamp sends is counted where a ray from the eye, a mirror or glass hits it; where a
matt surface is lit, by that surface's light sample. Lamps that can't be sampled (spheres, cones;
all of them without shadow rays) and the background are counted wherever a ray hits them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.workload.trace.exact import ray_of
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import Work, work_for
from simmpp.workload.trace.path.light import sample_of
from simmpp.workload.trace.path.rules import Paths, paths_of
from simmpp.workload.trace.path.scatter import weight_of
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.replay import Traced, recorded_generations
from simmpp.workload.trace.surface import surface_at
from simmpp.workload.workload import DIFFUSE, SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]


def light_of_roots(traced: Traced, hits: Ints) -> Floats:
    """Red, green and blue that each primary ray brings if rays hit ``hits``: (n0, 3) float64.

    A ray whose hit is not the recorded one has lost its children: it brings what shines there.
    """
    workload, geometry = traced.workload, traced.geometry
    paths = paths_of(traced.scene, traced.picture, traced.frame, geometry)
    colours, as_recorded = np.zeros((workload.n_rays, 3)), hits == workload.hits
    work, starts = work_for(geometry.shapes), [0]
    children = workload.child_offsets.copy()  # pages of a file are another type to compiled code
    kinds = workload.kinds.copy()
    for depth, (start, rays) in enumerate(recorded_generations(traced), 1):
        starts.append(start + len(rays.kinds))
        distances = workload.hit_distances[start : starts[-1]] * traced.frame.scale
        _see(
            geometry, paths, rays, start, depth, hits, as_recorded, distances, children, work,
            colours,
        )  # fmt: skip
    for depth in range(len(starts) - 1, 0, -1):
        span = starts[depth - 1], starts[depth]
        _gather(paths, hits, as_recorded, kinds, children, span, depth, colours)
    return colours[: workload.n_primaries]


def picture_of_roots(
    light: Floats, shape: tuple[int, int], samples: int, done: Flags | None = None
) -> Floats:
    """The mean of each pixel's primary rays, of those that are ``done``: (rows, columns, 3).

    ``done`` is (n0,) bool, None for all; a pixel without any is black.
    """
    passes = light.reshape(samples, *shape, 3)
    counts = np.ones(passes.shape[:3]) if done is None else 1.0 * done.reshape(samples, *shape)
    total, n = np.zeros((*shape, 3)), np.zeros(shape)
    for of_pass, count in zip(passes, counts, strict=True):  # every sum in the same order
        total += of_pass * count[:, :, None]
        n += count
    mean: Floats = total / np.maximum(n, 1.0)[:, :, None]
    return mean


@njit
def _see(
    geometry: Geometry,
    paths: Paths,
    rays: RayBatch,
    start: int,
    depth: int,
    hits: Ints,
    as_recorded: Flags,
    distances: Floats,
    children: Ints,
    work: Work,
    colours: Floats,
) -> None:
    """What shines where each ray of a generation ends, and what each of its shadow rays is for."""
    for i in range(len(distances)):
        n = start + i
        hit = hits[n]
        if rays.kinds[i] == SHADOW:
            continue
        if hit < 0:
            for c in range(3):
                colours[n, c] = paths.background[c]
            continue
        material = paths.materials[paths.material_of[hit]]
        if not (rays.kinds[i] == DIFFUSE and paths.sampled[hit]):
            for c in range(3):
                colours[n, c] = material[6 + c]
        if not (as_recorded[n] and paths.shadows and depth < paths.depth):
            continue
        shadow = children[n + 1] - 1  # a shadow ray is the last child
        if shadow < children[n] or hits[shadow] >= 0:
            continue
        ray = ray_of(rays.origins, rays.directions, i)
        opaque = not geometry.transmits[hit]
        surface = surface_at(
            geometry.shapes, geometry.normals, hit, ray, distances[i], opaque, work
        )
        sample = sample_of(paths, geometry.shapes, hit, surface, rays.roots[i], depth)
        if sample.limit > 0.0:  # else the last child is no shadow ray
            for c in range(3):
                colours[n, c] += material[c] * sample.light[c]


@njit
def _gather(
    paths: Paths,
    hits: Ints,
    as_recorded: Flags,
    kinds: NDArray[np.uint8],
    children: Ints,
    span: tuple[int, int],
    depth: int,
    colours: Floats,
) -> None:
    """Add to each ray of a generation what the ray that its path goes on with brings."""
    for n in range(span[0], span[1]):
        child = children[n]
        if not as_recorded[n] or child == children[n + 1] or kinds[child] == SHADOW:
            continue
        material = paths.materials[paths.material_of[hits[n]]]
        weight = weight_of(paths, material, kinds[child], depth)
        for c in range(3):
            colours[n, c] += weight[c] * colours[child, c]
