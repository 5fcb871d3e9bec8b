"""One generation of paths, and the next: of each hit at most one ray and one shadow ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.trace.camera import basis, tangent
from simmpp.workload.trace.exact import ray_of
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import Work, work_for
from simmpp.workload.trace.path.light import sample_of
from simmpp.workload.trace.path.philox import numbers
from simmpp.workload.trace.path.rules import Paths
from simmpp.workload.trace.path.scatter import NONE, scatter_of
from simmpp.workload.trace.ray_batch import RayBatch, unwritten
from simmpp.workload.trace.surface import added, surface_at
from simmpp.workload.trace.vectors import normalised, vector
from simmpp.workload.workload import PRIMARY, SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
EYE = 0
"""Event of the numbers that place a path in its pixel; the event of a hit is its depth."""


def drawn_rays(scene: Scene, picture: Picture, frame: Frame, roots: Ints) -> RayBatch:
    """The primary rays of these roots, each through a point of its pixel drawn by chance."""
    rays, (rows, columns) = unwritten(len(roots)), picture.pixels
    rays.kinds[:], rays.limits[:], rays.sources[:], rays.parents[:] = PRIMARY, np.inf, -1, -1
    rays.roots[:] = roots
    forward, right, up = basis(scene.camera, frame)
    reach, eye = tangent(scene.camera.angle_degrees), frame.points(np.array(scene.camera.eye))
    lens = np.stack([eye, forward, reach * right, reach * up])
    _aim(lens, rows, columns, picture.seed, rays)
    return rays


@njit
def _aim(lens: Floats, rows: int, columns: int, seed: int, rays: RayBatch) -> None:
    """``lens`` (4, 3): eye, forward, and right and up by half the picture's height."""
    for i in range(len(rays.roots)):
        root = rays.roots[i]
        place = root % (rows * columns)
        x, y, _, _ = numbers(seed, root, EYE, 0)
        across = (2.0 * (place % columns + x) - columns) / rows
        down = (2.0 * (place // columns + y) - rows) / rows
        for axis in range(3):
            ahead = lens[1, axis] + across * lens[2, axis] - down * lens[3, axis]
            rays.origins[i, axis], rays.directions[i, axis] = lens[0, axis], ahead
        unit = normalised(vector(rays.directions, i))
        rays.directions[i, 0], rays.directions[i, 1], rays.directions[i, 2] = unit


def next_paths(
    geometry: Geometry,
    rays: RayBatch,
    hits: Ints,
    distances: Floats,
    paths: Paths,
    depth: int,
    first: int,
) -> tuple[RayBatch, Ints]:
    """Rays spawned by the hits of ``rays``, as :func:`~...generations.children` has it."""
    ends = depth >= paths.depth
    most = 0 if ends else 2 * int(((rays.kinds != SHADOW) & (hits >= 0)).sum())
    new, counts = unwritten(most), np.zeros(len(hits), np.int32)
    work = work_for(geometry.shapes)
    used = _spawn(geometry, rays, hits, distances, paths, depth, first, new, counts, work)
    return new.part(0, used), counts


@njit
def _spawn(
    geometry: Geometry,
    rays: RayBatch,
    hits: Ints,
    distances: Floats,
    paths: Paths,
    depth: int,
    first: int,
    new: RayBatch,
    counts: Ints,
    work: Work,
) -> int:
    """Fill ``new``, and ``counts`` (n,) of each ray's children; how many there are in all."""
    used = 0
    if depth >= paths.depth:  # a light sample here would be a path that is one ray deeper
        return used
    for i in range(len(hits)):
        if rays.kinds[i] == SHADOW or hits[i] < 0:
            continue
        hit, root, before = hits[i], rays.roots[i], used
        ray = ray_of(rays.origins, rays.directions, i)
        opaque = not geometry.transmits[hit]
        surface = surface_at(
            geometry.shapes, geometry.normals, hit, ray, distances[i], opaque, work
        )
        kind, ahead = scatter_of(paths, hit, geometry.ior[hit], ray, surface, root, depth)
        if kind != NONE:
            used = added(new, used, kind, first + i, root, hit, surface, ahead, np.inf)
        if paths.shadows:
            sample = sample_of(paths, geometry.shapes, hit, surface, root, depth)
            if sample.limit > 0.0:
                used = added(
                    new, used, SHADOW, first + i, root, hit, surface, sample.direction, sample.limit
                )
        counts[i] = used - before
    return used
