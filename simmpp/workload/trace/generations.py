"""One generation of rays, and the next one: what a hit spawns (Whitted 1980).

The rules are the SPD's (Haines 1987): a hit on a surface that reflects or transmits spawns a
reflected ray, one on a transmitter also a refracted ray (Snell; none on total internal
reflection), any hit a shadow ray to each light that its surface faces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.common.errors import SceneError
from simmpp.scene.scene import Scene, Vector
from simmpp.workload.picture import PATH, Picture
from simmpp.workload.trace.camera import FAR, primary_rays
from simmpp.workload.trace.exact import ray_of
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import Work, work_for
from simmpp.workload.trace.path.generations import drawn_rays, next_paths
from simmpp.workload.trace.path.rules import Paths, paths_of
from simmpp.workload.trace.ray_batch import RayBatch, unwritten
from simmpp.workload.trace.surface import Surface, added, faces, reflected, refracted, surface_at
from simmpp.workload.trace.vectors import dot, minus, normalised, vector
from simmpp.workload.workload import PRIMARY, REFLECTED, REFRACTED, SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Spawning:
    """Which rays hits may spawn; kinds that a scene does not need are left out."""

    lights: Floats
    """(L, 3) float64, normalised; none without shadows."""
    reflection: bool
    refraction: bool
    max_depth: int


Rules = Spawning | Paths


def spawning(scene: Scene, picture: Picture, frame: Frame, geometry: Geometry) -> Rules:
    """The rays that ``picture`` asks for and ``scene`` has a use for."""
    if picture.render == PATH:
        return paths_of(scene, picture, frame, geometry)
    lights = np.array(
        [light.position for light in scene.lights if picture.shadows], dtype=np.float64
    )
    placed = frame.points(lights.reshape(-1, 3))
    if not (np.abs(placed) < FAR).all():
        raise SceneError("a light is not finite, or too far away", where=scene.name)
    return Spawning(
        lights=placed,
        reflection=picture.reflection and bool(geometry.reflects.any()),
        refraction=picture.refraction and bool(geometry.transmits.any()),
        max_depth=picture.max_depth,
    )


def first_generation(scene: Scene, picture: Picture, frame: Frame) -> RayBatch:
    """The primary rays."""
    if picture.is_drawn:
        return drawn_rays(scene, picture, frame, np.arange(picture.n_roots, dtype=np.int32))
    eye, directions = primary_rays(scene.camera, picture, frame)
    n = len(directions)
    return RayBatch(
        origins=np.broadcast_to(eye, (n, 3)).copy(),  # a view would be compiled as another type
        directions=directions,
        kinds=np.full(n, PRIMARY, dtype=np.uint8),
        limits=np.full(n, np.inf),
        sources=np.full(n, -1, dtype=np.int32),
        parents=np.full(n, -1, dtype=np.int32),
        roots=np.arange(n, dtype=np.int32),
    )


def children(
    geometry: Geometry,
    rays: RayBatch,
    hits: NDArray[np.int32],
    distances: Floats,
    rules: Rules,
    depth: int,
    first: int,
) -> tuple[RayBatch, NDArray[np.int32]]:
    """Rays spawned by the hits of ``rays``, and how many each has, (n,) int32.

    ``distances`` are normalised. The rays are of ``depth``, the first has number ``first``. Rays
    at the greatest depth spawn shadow rays only.
    """
    if isinstance(rules, Paths):
        return next_paths(geometry, rays, hits, distances, rules, depth, first)
    deeper = depth < rules.max_depth
    reflection, refraction = rules.reflection and deeper, rules.refraction and deeper
    surfaces = hits[(rays.kinds != SHADOW) & (hits >= 0)]
    # As many as there can be, since room has to be made before it is known which lights are faced.
    most = len(rules.lights) * len(surfaces)
    most += reflection * int(geometry.reflects[surfaces].sum())
    most += refraction * int(geometry.transmits[surfaces].sum())
    new, counts = unwritten(most), np.zeros(len(hits), np.int32)
    spawning = rules.lights, reflection, refraction
    work = work_for(geometry.shapes)
    used = _spawn(geometry, rays, hits, distances, spawning, first, new, counts, work)
    return new.part(0, used), counts


@njit
def _spawn(
    geometry: Geometry,
    rays: RayBatch,
    hits: Ints,
    distances: Floats,
    spawning: tuple[Floats, bool, bool],
    first: int,
    new: RayBatch,
    counts: Ints,
    work: Work,
) -> int:
    """Fill ``new``, and ``counts`` (n,) of each ray's children; how many there are in all."""
    lights, reflection, refraction = spawning
    reflects, transmits, ior = geometry.reflects, geometry.transmits, geometry.ior
    used = 0
    for i in range(len(hits)):
        if rays.kinds[i] == SHADOW or hits[i] < 0:
            continue
        hit, root, before = hits[i], rays.roots[i], used
        ray = ray_of(rays.origins, rays.directions, i)
        opaque = not transmits[hit]
        surface = surface_at(
            geometry.shapes, geometry.normals, hit, ray, distances[i], opaque, work
        )
        # In this order siblings are numbered; shading counts on shadow rays to be the last.
        if reflection and reflects[hit]:
            direction = reflected(ray, surface)
            used = added(new, used, REFLECTED, first + i, root, hit, surface, direction, np.inf)
        if refraction and transmits[hit]:
            passes, direction = refracted(ray, surface, ior[hit])
            if passes:
                used = added(new, used, REFRACTED, first + i, root, hit, surface, direction, np.inf)
        for k in range(len(lights)):
            used = _add_shadow(new, used, first + i, root, hit, surface, vector(lights, k))
        counts[i] = used - before
    return used


@kernel
def _add_shadow(
    new: RayBatch,
    used: int,
    parent: int,
    root: int,
    source: int,
    surface: Surface,
    light: Vector,
) -> int:
    """Append a shadow ray, unless the surface faces away from the light."""
    to_light = minus(light, surface.point)
    if not faces(surface, to_light):
        return used
    distance = math.sqrt(dot(to_light, to_light))
    direction = normalised(to_light)
    return added(new, used, SHADOW, parent, root, source, surface, direction, distance)
