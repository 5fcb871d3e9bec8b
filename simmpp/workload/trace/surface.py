"""Where a ray meets an object: point, normal, and the directions in which it goes on."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from simmpp.common.compiled import kernel
from simmpp.scene.scene import Vector
from simmpp.workload.trace.exact import Floats, Ray, Row, hit_object, row_of
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.trace.itineraries import Work
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.vectors import cross, dot, minus, moved, normalised, times, vector
from simmpp.workload.workload import CONE, MESH, POLYGON, SPHERE


class Surface(NamedTuple):
    """Where a ray meets an object."""

    point: Vector
    outside: Vector
    """The normal that points outside."""
    normal: Vector
    """The normal on the side of the ray."""
    lit: Vector
    """The normal on the side that light falls on: the ray's, but glass is lit from outside."""
    entering: bool
    """The ray comes from outside."""
    flat: bool
    """Planar and opaque: nothing that leaves it comes back."""
    convex: bool
    """Sphere or open cone, and opaque: nothing that leaves it on the outside comes back. A cone's
    side is part of the surface of a convex solid, which lies behind each of its tangent planes."""


@kernel
def surface_at(
    shapes: Shapes, normals: Floats, i: int, ray: Ray, t: float, opaque: bool, work: Work
) -> Surface:
    """The :class:`Surface` of object ``i`` that ``ray`` hits at ``t``."""
    point = moved(ray.origin, t, ray.direction)
    kind = shapes.objects[i, 0]
    # All triangles of a polygon have one normal, so that light does not change between them.
    outside = vector(normals, i)
    if kind != POLYGON:
        row = shapes.objects[i, 1]
        if kind == MESH:
            # Asked again, since a workload records the object and not which triangle was hit.
            _, row = hit_object(shapes, i, ray, 0.0, np.inf, work.inner)
        shape = row_of(shapes.surfaces, row)
        if kind == SPHERE:
            outside = minus(point, shape[:3])
        elif kind == CONE:
            outside = _cone_normal(shape, point)
        else:
            outside = cross(shape[3:6], shape[6:])
        outside = normalised(outside)
    entering = dot(outside, ray.direction) <= 0.0
    side = 1.0 if entering else -1.0
    lit = side if opaque else 1.0
    flat, convex = opaque and kind == POLYGON, opaque and kind in (SPHERE, CONE)
    normal = times(side, outside)
    return Surface(point, outside, normal, times(lit, outside), entering, flat, convex)


@kernel
def added(
    new: RayBatch,
    used: int,
    kind: int,
    parent: int,
    root: int,
    source: int,
    surface: Surface,
    direction: Vector,
    limit: float,
) -> int:
    """Append one ray that leaves ``surface``; the new number of rays."""
    origin, ahead = new.origins[used], new.directions[used]
    outwards = dot(surface.outside, direction) > 0.0
    origin[0], origin[1], origin[2] = surface.point
    ahead[0], ahead[1], ahead[2] = direction
    new.kinds[used], new.limits[used] = kind, limit
    new.parents[used], new.roots[used] = parent, root
    # Without this a ray could hit the surface it leaves: its origin is rounded to before or behind.
    # Glass and meshes may be hit again; there T_MIN has to keep the two apart.
    new.sources[used] = source if surface.flat or (surface.convex and outwards) else -1
    return used + 1


@kernel
def _cone_normal(shape: Row, point: Vector) -> Vector:
    """Away from the axis, tilted against the growth of the radius."""
    from_base, axis, growth = minus(point, shape[:3]), shape[3:6], shape[8]
    along = dot(from_base, axis)
    radius = shape[7] + growth * along
    # The gradient of |from_base - along axis|^2 - radius^2, halved.
    return moved(from_base, -(along + growth * radius), axis)


@kernel
def faces(surface: Surface, to_light: Vector) -> bool:
    """Whether the surface faces a light in that direction, which need not be of length 1.

    Inside glass that is its outside: from the inside, the glass itself would block every light.
    """
    # The second test is of squares: one that underflows has no length to be divided by either.
    return dot(surface.lit, to_light) > 0.0 and dot(to_light, to_light) > 0.0


@kernel
def reflected(ray: Ray, surface: Surface) -> Vector:
    """Mirror direction."""
    cosine = dot(ray.direction, surface.normal)
    # Of length 1 but for roundings, which would add up from one reflection to the next.
    return normalised(moved(ray.direction, -2.0 * cosine, surface.normal))


@kernel
def refracted(ray: Ray, surface: Surface, ior: float) -> tuple[bool, Vector]:
    """Whether the ray passes, and Snell's direction; from inside it leaves for vacuum."""
    eta = 1.0 / ior if surface.entering else ior
    cosine = -dot(ray.direction, surface.normal)
    below = 1.0 - eta * eta * (1.0 - cosine * cosine)
    if not below >= 0.0:  # nor if it is NaN, from an index near the end of float64
        return False, (0.0, 0.0, 0.0)
    bend = eta * cosine - math.sqrt(below)
    return True, normalised(moved(times(eta, ray.direction), bend, surface.normal))
