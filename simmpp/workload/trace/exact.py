"""Intersections in float64 that decide every hit: spheres, open cones, triangles.

Distances are those of a ray with a direction of length 1; a miss is infinity. All surfaces are
hit from both sides. Nothing here asks embree.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.workload.trace.bvh import WIDTH
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.workload import CONE, SPHERE

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Row = tuple[float, float, float, float, float, float, float, float, float]

TOLERANCE = 1e-12
"""By how much barycentric coordinates may leave a triangle, so that shared edges do not leak."""
STEEPEST = 1e300
"""Inverse of a direction component that is zero: finite, so that 0 times it is 0 and never NaN."""


class Ray(NamedTuple):
    """Origin, direction of length 1, and the direction's inverses."""

    ox: float
    oy: float
    oz: float
    dx: float
    dy: float
    dz: float
    ix: float
    iy: float
    iz: float


@kernel
def ray_of(origins: Floats, directions: Floats, i: int) -> Ray:
    """Ray ``i`` of arrays (n, 3) float64."""
    dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
    ox, oy, oz = origins[i, 0], origins[i, 1], origins[i, 2]
    return Ray(ox, oy, oz, dx, dy, dz, _inverse(dx), _inverse(dy), _inverse(dz))


@kernel
def _inverse(component: float) -> float:
    if abs(component) > 1.0 / STEEPEST:
        return 1.0 / component
    return math.copysign(STEEPEST, component)


@kernel
def entry(boxes: Floats, i: int, ray: Ray) -> float:
    """Where ``ray`` enters box ``i`` of (n, 6) float64: 0 from inside, infinity if it does not."""
    ax, bx = (boxes[i, 0] - ray.ox) * ray.ix, (boxes[i, 3] - ray.ox) * ray.ix
    ay, by = (boxes[i, 1] - ray.oy) * ray.iy, (boxes[i, 4] - ray.oy) * ray.iy
    az, bz = (boxes[i, 2] - ray.oz) * ray.iz, (boxes[i, 5] - ray.oz) * ray.iz
    enter = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0))
    leave = min(min(max(ax, bx), max(ay, by)), max(az, bz))
    return enter if enter <= leave else np.inf


@kernel
def entries(bounds: Floats, node: int, ray: Ray, found: Floats) -> None:
    """:func:`entry` of the eight boxes of a node of a tree, into ``found`` (8,) float64."""
    x, y, z = 0 if ray.ix > 0 else 3, 1 if ray.iy > 0 else 4, 2 if ray.iz > 0 else 5
    for k in range(WIDTH):
        tx = (bounds[node, x, k] - ray.ox) * ray.ix
        ty = (bounds[node, y, k] - ray.oy) * ray.iy
        tz = (bounds[node, z, k] - ray.oz) * ray.iz
        enter = tx if tx > 0.0 else 0.0
        enter = ty if ty > enter else enter
        enter = tz if tz > enter else enter
        tx = (bounds[node, 3 - x, k] - ray.ox) * ray.ix
        ty = (bounds[node, 5 - y, k] - ray.oy) * ray.iy
        tz = (bounds[node, 7 - z, k] - ray.oz) * ray.iz
        leave = ty if ty < tx else tx
        leave = tz if tz < leave else leave
        found[k] = enter if enter <= leave else np.inf


@kernel
def hit_triangle(triangle: Row, ray: Ray, t_min: float) -> float:
    """Distance to ``triangle`` (9,) float64 beyond ``t_min`` (Moeller and Trumbore 1997)."""
    e1x, e1y, e1z = triangle[3], triangle[4], triangle[5]
    e2x, e2y, e2z = triangle[6], triangle[7], triangle[8]
    px = ray.dy * e2z - ray.dz * e2y
    py = ray.dz * e2x - ray.dx * e2z
    pz = ray.dx * e2y - ray.dy * e2x
    det = e1x * px + e1y * py + e1z * pz
    if det == 0.0:
        return np.inf
    inverse = 1.0 / det
    sx, sy, sz = ray.ox - triangle[0], ray.oy - triangle[1], ray.oz - triangle[2]
    u = (sx * px + sy * py + sz * pz) * inverse
    if not -TOLERANCE <= u <= 1.0 + TOLERANCE:
        return np.inf
    qx, qy, qz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
    v = (ray.dx * qx + ray.dy * qy + ray.dz * qz) * inverse
    if not (v >= -TOLERANCE and u + v <= 1.0 + TOLERANCE):
        return np.inf
    t = (e2x * qx + e2y * qy + e2z * qz) * inverse
    return t if t > t_min else np.inf


@kernel
def hit_sphere(shape: Row, ray: Ray, t_min: float) -> float:
    """Distance to a sphere; seen from the point of the ray nearest to its centre."""
    x, y, z = ray.ox - shape[0], ray.oy - shape[1], ray.oz - shape[2]
    closest = -(x * ray.dx + y * ray.dy + z * ray.dz)
    x, y, z = x + closest * ray.dx, y + closest * ray.dy, z + closest * ray.dz
    half = shape[3] * shape[3] - (x * x + y * y + z * z)
    if not (half >= 0.0 and shape[3] > 0.0):
        return np.inf
    half = math.sqrt(half)
    if closest - half > t_min:
        return closest - half
    return closest + half if closest + half > t_min else np.inf


@kernel
def hit_cone(shape: Row, ray: Ray, t_min: float) -> float:
    """Distance to an open cone: |w + v t|^2 = (radius + growth z)^2 with 0 <= z <= height."""
    x, y, z = ray.ox - shape[0], ray.oy - shape[1], ray.oz - shape[2]
    ax, ay, az, height, growth = shape[3], shape[4], shape[5], shape[6], shape[8]
    near = -(x * ray.dx + y * ray.dy + z * ray.dz)
    x, y, z = x + near * ray.dx, y + near * ray.dy, z + near * ray.dz
    along, rise = x * ax + y * ay + z * az, ray.dx * ax + ray.dy * ay + ray.dz * az
    wx, wy, wz = x - along * ax, y - along * ay, z - along * az
    vx, vy, vz = ray.dx - rise * ax, ray.dy - rise * ay, ray.dz - rise * az
    radius, widening = shape[7] + growth * along, growth * rise
    a = vx * vx + vy * vy + vz * vz - widening * widening
    b = wx * vx + wy * vy + wz * vz - widening * radius
    c = wx * wx + wy * wy + wz * wz - radius * radius
    root = b * b - a * c
    if not (root >= 0.0 and height > 0.0):
        return np.inf
    q = -(b + math.copysign(math.sqrt(root), b))
    best = np.inf
    for t in (q / a, c / q):
        if t + near > t_min and t + near < best and 0.0 <= along + t * rise <= height:
            best = t + near
    return best


@kernel
def row_of(surfaces: Floats, k: int) -> Row:
    """Row ``k`` of ``surfaces`` (rows, 9) float64 as nine numbers."""
    return (
        surfaces[k, 0],
        surfaces[k, 1],
        surfaces[k, 2],
        surfaces[k, 3],
        surfaces[k, 4],
        surfaces[k, 5],
        surfaces[k, 6],
        surfaces[k, 7],
        surfaces[k, 8],
    )


@kernel
def hit_object(
    shapes: Shapes, i: int, ray: Ray, enter: float, bound: float, stack: Ints, found: Floats
) -> tuple[float, int]:
    """Distance to object ``i``, whose box ``ray`` enters at ``enter``, and the row hit.

    A distance before the box is a rounding: it is taken to be ``enter``. So no hit comes before
    its box, and a search that ends at a hit has seen every box entered until then. Hits beyond
    ``bound`` may be missed, or not be the nearest. ``stack`` and ``found`` are memory.
    """
    root = shapes.objects[i, 3]
    if root >= 0:
        t, row = _hit_tree(shapes, root, ray, bound, stack, found)
    else:
        t, row = _hit_rows(shapes, i, ray)
    return max(t, enter), row


@kernel
def _hit_rows(shapes: Shapes, i: int, ray: Ray) -> tuple[float, int]:
    """Nearest of the few rows of object ``i``."""
    kind, first, after = shapes.objects[i, 0], shapes.objects[i, 1], shapes.objects[i, 2]
    best, nearest = np.inf, first
    for k in range(first, after):
        row = row_of(shapes.surfaces, k)
        if kind == SPHERE:
            t = hit_sphere(row, ray, shapes.t_min)
        elif kind == CONE:
            t = hit_cone(row, ray, shapes.t_min)
        else:
            t = hit_triangle(row, ray, shapes.t_min)
        if t < best:
            best, nearest = t, k
    return best, nearest


@kernel
def _hit_tree(
    shapes: Shapes, root: int, ray: Ray, bound: float, stack: Ints, found: Floats
) -> tuple[float, int]:
    """Nearest triangle below ``root``, ties by (distance, row)."""
    best, nearest = np.inf, -1
    stack[0] = root
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        entries(shapes.bounds, node, ray, found)
        for k in range(WIDTH):
            if not (found[k] <= min(best, bound) and found[k] < np.inf):
                continue
            child = shapes.children[node, k]
            if child >= 0:
                stack[depth] = child
                depth += 1
                continue
            t = hit_triangle(row_of(shapes.surfaces, ~child), ray, shapes.t_min)
            t = max(t, found[k])
            if t < best or (t == best and ~child < nearest):
                best, nearest = t, ~child
    return best, nearest
