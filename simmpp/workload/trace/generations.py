"""One generation of rays, and the next one: what a hit spawns (Whitted 1980).

The rules are the SPD's (Haines 1987): a hit on a surface that reflects or transmits spawns a
reflected ray, one on a transmitter also a refracted ray (Snell; none on total internal
reflection), any hit a shadow ray to each light that its surface faces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.common.errors import SceneError
from simmpp.scene.scene import Scene, Vector
from simmpp.workload.picture import Picture
from simmpp.workload.trace.camera import FAR, primary_rays
from simmpp.workload.trace.exact import ray_of
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import Work, work_for
from simmpp.workload.trace.surface import (
    Surface,
    faces,
    reflected,
    refracted,
    surface_at,
    towards,
)
from simmpp.workload.workload import PRIMARY, REFLECTED, REFRACTED, SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class Rays(NamedTuple):
    """n rays of one generation, lengths normalised."""

    origins: Floats
    """(n, 3) float64."""
    directions: Floats
    """(n, 3) float64 of length 1."""
    kinds: NDArray[np.uint8]
    """(n,) uint8."""
    limits: Floats
    """(n,) float64: distance to the light of a shadow ray, else infinity."""
    sources: NDArray[np.int32]
    """(n,) int32: the object that the ray leaves for good, convex and opaque; else -1."""
    parents: NDArray[np.int32]
    """(n,) int32: number of the parent; -1 for primary rays."""

    def part(self, start: int, stop: int) -> Rays:
        """Rays start ... stop - 1."""
        return Rays._make(array[start:stop] for array in self)


@dataclass(frozen=True)
class Spawning:
    """Which rays hits may spawn; kinds that a scene does not need are left out."""

    lights: Floats
    """(L, 3) float64, normalised; none without shadows."""
    reflection: bool
    refraction: bool
    max_depth: int


def spawning(scene: Scene, picture: Picture, frame: Frame, geometry: Geometry) -> Spawning:
    """The rays that ``picture`` asks for and ``scene`` has a use for."""
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


def first_generation(scene: Scene, picture: Picture, frame: Frame) -> Rays:
    """The primary rays."""
    eye, directions = primary_rays(scene.camera, picture, frame)
    n = len(directions)
    return Rays(
        origins=np.broadcast_to(eye, (n, 3)).copy(),
        directions=directions,
        kinds=np.full(n, PRIMARY, dtype=np.uint8),
        limits=np.full(n, np.inf),
        sources=np.full(n, -1, dtype=np.int32),
        parents=np.full(n, -1, dtype=np.int32),
    )


def children(
    geometry: Geometry,
    rays: Rays,
    hits: NDArray[np.int32],
    distances: Floats,
    rules: Spawning,
    depth: int,
    first: int,
) -> tuple[Rays, NDArray[np.int32]]:
    """Rays spawned by the hits of ``rays``, and how many each has, (n,) int32.

    ``distances`` are normalised. The rays are of ``depth``, the first has number ``first``. Rays
    at the greatest depth spawn shadow rays only.
    """
    deeper = depth < rules.max_depth
    reflection, refraction = rules.reflection and deeper, rules.refraction and deeper
    surfaces = hits[(rays.kinds != SHADOW) & (hits >= 0)]
    most = len(rules.lights) * len(surfaces)
    most += reflection * int(geometry.reflects[surfaces].sum())
    most += refraction * int(geometry.transmits[surfaces].sum())
    new, counts = _room(most), np.zeros(len(hits), np.int32)
    spawning = rules.lights, reflection, refraction
    work = work_for(geometry.shapes)
    used = _spawn(geometry, rays, hits, distances, spawning, first, new, counts, work)
    return new.part(0, used), counts


def _room(n: int) -> Rays:
    return Rays(
        origins=np.empty((n, 3)),
        directions=np.empty((n, 3)),
        kinds=np.empty(n, np.uint8),
        limits=np.empty(n),
        sources=np.empty(n, np.int32),
        parents=np.empty(n, np.int32),
    )


def joined(parts: list[Rays]) -> Rays:
    """Runs of rays, one after the other."""
    return Rays._make(np.concatenate(column) for column in zip(*parts, strict=True))


@njit
def _spawn(
    geometry: Geometry,
    rays: Rays,
    hits: Ints,
    distances: Floats,
    spawning: tuple[Floats, bool, bool],
    first: int,
    new: Rays,
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
        hit, before = hits[i], used
        ray = ray_of(rays.origins, rays.directions, i)
        opaque = not transmits[hit]
        surface = surface_at(
            geometry.shapes, geometry.normals, hit, ray, distances[i], opaque, work
        )
        if reflection and reflects[hit]:
            used = _add(
                new, used, REFLECTED, first + i, hit, surface, reflected(ray, surface), np.inf
            )
        if refraction and transmits[hit]:
            passes, direction = refracted(ray, surface, ior[hit])
            if passes:
                used = _add(new, used, REFRACTED, first + i, hit, surface, direction, np.inf)
        for k in range(len(lights)):
            light = (lights[k, 0], lights[k, 1], lights[k, 2])
            used = _add_shadow(new, used, first + i, hit, surface, light)
        counts[i] = used - before
    return used


@kernel
def _add(
    new: Rays,
    used: int,
    kind: int,
    parent: int,
    source: int,
    surface: Surface,
    direction: Vector,
    limit: float,
) -> int:
    """Append one ray that leaves ``surface``; the new number of rays."""
    origin, ahead = new.origins[used], new.directions[used]
    x, y, z = direction
    outwards = surface.ox * x + surface.oy * y + surface.oz * z > 0.0
    origin[0], origin[1], origin[2] = surface.x, surface.y, surface.z
    ahead[0], ahead[1], ahead[2] = x, y, z
    new.kinds[used], new.limits[used], new.parents[used] = kind, limit, parent
    new.sources[used] = source if surface.flat or (surface.convex and outwards) else -1
    return used + 1


@kernel
def _add_shadow(
    new: Rays, used: int, parent: int, source: int, surface: Surface, light: Vector
) -> int:
    """Append a shadow ray, unless the surface faces away from the light."""
    x, y, z = towards(surface, light[0], light[1], light[2])
    if not faces(surface, x, y, z):
        return used
    distance = math.sqrt(x * x + y * y + z * z)
    direction = (x / distance, y / distance, z / distance)
    return _add(new, used, SHADOW, parent, source, surface, direction, distance)
