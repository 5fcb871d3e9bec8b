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
from simmpp.scene.scene import Vector
from simmpp.workload.trace.bvh_split import WIDTH
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.trace.vectors import cross, dot, minus, moved, vector
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

    origin: Vector
    direction: Vector
    inverse: Vector


class Walk(NamedTuple):
    """Memory of a walk through a tree."""

    stack: Ints
    """Nodes still to visit."""
    entered: Floats
    """(8,) float64: where the ray enters the boxes of one node."""


@kernel
def ray_of(origins: Floats, directions: Floats, i: int) -> Ray:
    """Ray ``i`` of arrays (n, 3) float64."""
    x, y, z = direction = vector(directions, i)
    return Ray(vector(origins, i), direction, (_inverse(x), _inverse(y), _inverse(z)))


@kernel
def _inverse(component: float) -> float:
    if abs(component) > 1.0 / STEEPEST:
        return 1.0 / component
    return math.copysign(STEEPEST, component)


@kernel
def entry(boxes: Floats, i: int, ray: Ray) -> float:
    """Where ``ray`` enters box ``i`` of (n, 6) float64: 0 from inside, infinity if it does not."""
    (x, y, z), (ix, iy, iz) = ray.origin, ray.inverse
    ax, bx = (boxes[i, 0] - x) * ix, (boxes[i, 3] - x) * ix
    ay, by = (boxes[i, 1] - y) * iy, (boxes[i, 4] - y) * iy
    az, bz = (boxes[i, 2] - z) * iz, (boxes[i, 5] - z) * iz
    # The lesser of an axis's two planes is where the slab is entered, whichever way the ray goes.
    enter = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0))
    leave = min(min(max(ax, bx), max(ay, by)), max(az, bz))
    return enter if enter <= leave else np.inf


@kernel
def entries(bounds: Floats, node: int, ray: Ray, enters: Floats) -> None:
    """:func:`entry` of the eight boxes of a node of a tree, into ``enters`` (8,) float64."""
    (x, y, z), (ix, iy, iz) = ray.origin, ray.inverse
    # The near sides of all eight boxes are known from the signs of the direction: half of the
    # comparisons of ``entry``, which has one box only.
    near_x, near_y, near_z = 0 if ix > 0 else 3, 1 if iy > 0 else 4, 2 if iz > 0 else 5
    for k in range(WIDTH):
        tx = (bounds[node, near_x, k] - x) * ix
        ty = (bounds[node, near_y, k] - y) * iy
        tz = (bounds[node, near_z, k] - z) * iz
        enter = tx if tx > 0.0 else 0.0
        enter = ty if ty > enter else enter
        enter = tz if tz > enter else enter
        tx = (bounds[node, 3 - near_x, k] - x) * ix  # sides 0 and 3 are x, 1 and 4 y, 2 and 5 z
        ty = (bounds[node, 5 - near_y, k] - y) * iy
        tz = (bounds[node, 7 - near_z, k] - z) * iz
        leave = ty if ty < tx else tx
        leave = tz if tz < leave else leave
        enters[k] = enter if enter <= leave else np.inf


@kernel
def hit_triangle(triangle: Row, ray: Ray, t_min: float) -> float:
    """Distance to ``triangle`` (9,) float64 beyond ``t_min`` (Moeller and Trumbore 1997)."""
    vertex, e1, e2 = triangle[:3], triangle[3:6], triangle[6:]
    p = cross(ray.direction, e2)
    det = dot(e1, p)
    # Exactly 0, not nearly: what grazes is decided by u and v below, whatever the triangle's size.
    if det == 0.0:
        return np.inf
    inverse = 1.0 / det
    s = minus(ray.origin, vertex)
    u = dot(s, p) * inverse
    # ``not ... <=`` rather than ``>``: a NaN, of a det that is almost 0, is no hit either.
    if not -TOLERANCE <= u <= 1.0 + TOLERANCE:
        return np.inf
    q = cross(s, e1)
    v = dot(ray.direction, q) * inverse
    if not (v >= -TOLERANCE and u + v <= 1.0 + TOLERANCE):
        return np.inf
    t = dot(e2, q) * inverse
    return t if t > t_min else np.inf


@kernel
def hit_sphere(shape: Row, ray: Ray, t_min: float) -> float:
    """Distance to a sphere; seen from the point of the ray nearest to its centre."""
    radius, from_centre = shape[3], minus(ray.origin, shape[:3])
    # From far away b^2 - 4 a c is a small difference of two large squares; from here none is large.
    closest = -dot(from_centre, ray.direction)
    aside = moved(from_centre, closest, ray.direction)
    square = radius * radius - dot(aside, aside)
    if not (square >= 0.0 and radius > 0.0):
        return np.inf
    half = math.sqrt(square)
    if closest - half > t_min:
        return closest - half
    return closest + half if closest + half > t_min else np.inf


@kernel
def hit_cone(shape: Row, ray: Ray, t_min: float) -> float:
    """Distance to an open cone: |w + v t|^2 = (radius + growth z)^2 with 0 <= z <= height."""
    from_base, axis = minus(ray.origin, shape[:3]), shape[3:6]
    height, base_radius, growth = shape[6], shape[7], shape[8]
    near = -dot(from_base, ray.direction)  # t counts from the point nearest to the base, as above
    point = moved(from_base, near, ray.direction)
    along, rise = dot(point, axis), dot(ray.direction, axis)
    w, v = moved(point, -along, axis), moved(ray.direction, -rise, axis)
    radius, widening = base_radius + growth * along, growth * rise
    a = dot(v, v) - widening * widening
    b = dot(w, v) - widening * radius
    c = dot(w, w) - radius * radius
    root = b * b - a * c
    if not (root >= 0.0 and height > 0.0):
        return np.inf
    # With the sign of b the sum never cancels; the other root is c / q. Either may be infinite (a
    # is 0 along the side) or NaN (q is 0 too), which no comparison below takes for a hit.
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
    shapes: Shapes, i: int, ray: Ray, enter: float, bound: float, walk: Walk
) -> tuple[float, int]:
    """Distance to object ``i``, whose box ``ray`` enters at ``enter``, and the row hit.

    A distance before the box is a rounding: it is taken to be ``enter``. So no hit comes before
    its box, and a search that ends at a hit has seen every box entered until then. Hits beyond
    ``bound`` may be missed, or not be the nearest.
    """
    root = shapes.objects[i, 3]
    if root >= 0:
        t, row = _hit_tree(shapes, root, ray, bound, walk)
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
def _hit_tree(shapes: Shapes, root: int, ray: Ray, bound: float, walk: Walk) -> tuple[float, int]:
    """Nearest triangle below ``root``, ties by (distance, row)."""
    best, nearest = np.inf, -1
    stack, entered = walk
    stack[0] = root
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        entries(shapes.bounds, node, ray, entered)
        for k in range(WIDTH):
            # ``<=``: behind a box entered at the best distance may lie a tie of a lower row.
            if not (entered[k] <= min(best, bound) and entered[k] < np.inf):
                continue
            child = shapes.children[node, k]
            if child >= 0:
                stack[depth] = child
                depth += 1
                continue
            t = hit_triangle(row_of(shapes.surfaces, ~child), ray, shapes.t_min)
            # As for whole objects: a hit that is rounded to before its box must not be the best,
            # since boxes that are entered between the two would be passed over.
            t = max(t, entered[k])
            if t < best or (t == best and ~child < nearest):
                best, nearest = t, ~child
    return best, nearest
