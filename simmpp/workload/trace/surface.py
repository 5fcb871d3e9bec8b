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
from simmpp.workload.workload import CONE, MESH, POLYGON, SPHERE


class Surface(NamedTuple):
    """Where a ray meets an object."""

    x: float
    y: float
    z: float
    ox: float
    oy: float
    oz: float
    """The normal that points outside."""
    nx: float
    ny: float
    nz: float
    """The normal on the side of the ray."""
    lx: float
    ly: float
    lz: float
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
    x, y, z = ray.ox + t * ray.dx, ray.oy + t * ray.dy, ray.oz + t * ray.dz
    kind = shapes.objects[i, 0]
    nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
    if kind != POLYGON:
        row = shapes.objects[i, 1]
        if kind == MESH:
            _, row = hit_object(shapes, i, ray, 0.0, np.inf, work.inner_stack, work.inner_found)
        shape = row_of(shapes.surfaces, row)
        if kind == SPHERE:
            nx, ny, nz = x - shape[0], y - shape[1], z - shape[2]
        elif kind == CONE:
            nx, ny, nz = _cone_normal(shape, x, y, z)
        else:
            nx, ny, nz = _triangle_normal(shape)
        nx, ny, nz = normalised(nx, ny, nz)
    entering = nx * ray.dx + ny * ray.dy + nz * ray.dz <= 0.0
    side = 1.0 if entering else -1.0
    lit = side if opaque else 1.0
    flat, convex = opaque and kind == POLYGON, opaque and kind in (SPHERE, CONE)
    return Surface(
        x, y, z,
        nx, ny, nz,
        side * nx, side * ny, side * nz,
        lit * nx, lit * ny, lit * nz,
        entering, flat, convex,
    )  # fmt: skip


@kernel
def _cone_normal(shape: Row, x: float, y: float, z: float) -> Vector:
    """Away from the axis, tilted against the growth of the radius."""
    x, y, z = x - shape[0], y - shape[1], z - shape[2]
    ax, ay, az, growth = shape[3], shape[4], shape[5], shape[8]
    along = x * ax + y * ay + z * az
    radius = shape[7] + growth * along
    tilt = along + growth * radius
    return x - tilt * ax, y - tilt * ay, z - tilt * az


@kernel
def _triangle_normal(e: Row) -> Vector:
    return (
        e[4] * e[8] - e[5] * e[7],
        e[5] * e[6] - e[3] * e[8],
        e[3] * e[7] - e[4] * e[6],
    )


@kernel
def towards(surface: Surface, x: float, y: float, z: float) -> Vector:
    """From the surface to a light."""
    return x - surface.x, y - surface.y, z - surface.z


@kernel
def faces(surface: Surface, x: float, y: float, z: float) -> bool:
    """Whether the surface faces a light in that direction.

    Inside glass that is its outside: from the inside, the glass itself would block every light.
    """
    towards_it = surface.lx * x + surface.ly * y + surface.lz * z > 0.0
    return towards_it and x * x + y * y + z * z > 0.0  # not at a light's own place


@kernel
def reflected(ray: Ray, surface: Surface) -> Vector:
    """Mirror direction."""
    nx, ny, nz = surface.nx, surface.ny, surface.nz
    cosine = 2.0 * (ray.dx * nx + ray.dy * ny + ray.dz * nz)
    return normalised(ray.dx - cosine * nx, ray.dy - cosine * ny, ray.dz - cosine * nz)


@kernel
def refracted(ray: Ray, surface: Surface, ior: float) -> tuple[bool, Vector]:
    """Whether the ray passes, and Snell's direction; from inside it leaves for vacuum."""
    nx, ny, nz = surface.nx, surface.ny, surface.nz
    eta = 1.0 / ior if surface.entering else ior
    cosine = -(ray.dx * nx + ray.dy * ny + ray.dz * nz)
    below = 1.0 - eta * eta * (1.0 - cosine * cosine)
    if not below >= 0.0:
        return False, (0.0, 0.0, 0.0)
    bend = eta * cosine - math.sqrt(below)
    return True, normalised(
        eta * ray.dx + bend * nx, eta * ray.dy + bend * ny, eta * ray.dz + bend * nz
    )


@kernel
def normalised(x: float, y: float, z: float) -> Vector:
    """The vector at length 1."""
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length
