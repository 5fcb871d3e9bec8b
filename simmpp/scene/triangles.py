"""The triangles of an object, as an intersector wants them."""

from __future__ import annotations

from itertools import pairwise

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

from simmpp.scene.scene import Cone, Floats, MeshPart, Polygon, SceneObject, Sphere

Faces = NDArray[np.int64]
Pair = tuple[float, float]


def triangles(obj: SceneObject) -> Floats:
    """Triangles of a polygon or mesh part, (m, 3, 3) float64; m is 0 for spheres and cones.

    A convex polygon becomes a fan from its first vertex, a concave one is cut by ear clipping. m
    is at least 1 for a polygon, whatever its shape; triangles may have no area.
    """
    match obj:
        case Polygon():
            vertices = np.asarray(obj.vertices, dtype=np.float64)
            if len(vertices) == 3:
                return vertices[None]
            return vertices[polygon_faces(vertices)]
        case MeshPart():
            return np.asarray(obj.vertices, dtype=np.float64)[obj.faces]
        case Sphere() | Cone():
            return np.empty((0, 3, 3))


def polygon_faces(vertices: Floats) -> Faces:
    """Indices (m, 3) int64 of triangles that tile the polygon with these vertices (n, 3)."""
    flat = _dominant_plane(vertices)
    steps = np.arange(1, len(flat) - 1)
    fan: Faces = np.stack([np.zeros_like(steps), steps, steps + 1], axis=1)
    if _is_convex(flat):
        return fan
    plane, rings = np.array(flat), np.array([len(flat)], dtype=np.uint32)
    cut = mapbox_earcut.triangulate_float64(plane, rings).reshape(-1, 3).astype(np.int64)
    # Without an area there is nothing to cut; of a quad bent so far that its edges cross, seen
    # from here, the ear clipper would leave a half.
    if len(cut) < min(2, len(fan)):
        return fan
    return _oriented(cut, plane)


# Plain numbers: most polygons have four vertices, too few for arrays to pay.


def _dominant_plane(vertices: Floats) -> list[Pair]:
    """The vertices seen along the axis in which the polygon's area is largest.

    From the first vertex and in a power of two near their extent: neither place nor unit counts.
    """
    spokes = vertices - vertices[0]
    points = np.ldexp(spokes, -np.frexp(np.abs(spokes).max())[1]).tolist()
    x = y = z = 0.0
    for (ax, ay, az), (bx, by, bz) in pairwise([*points, points[0]]):
        x += ay * bz - az * by
        y += az * bx - ax * bz
        z += ax * by - ay * bx
    widest = max(abs(x), abs(y), abs(z))
    if abs(x) == widest:
        return [(y, z) for _, y, z in points]
    if abs(y) == widest:
        return [(z, x) for x, _, z in points]
    return [(x, y) for x, y, _ in points]


def _turn(a: Pair, b: Pair, c: Pair) -> float:
    """Twice the area of a triangle, positive if counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _is_convex(flat: list[Pair]) -> bool:
    """Whether all corners turn one way, straight ones aside."""
    turns = [_turn(flat[i - 2], flat[i - 1], flat[i]) for i in range(len(flat))]
    return min(turns) >= 0 or max(turns) <= 0


def _oriented(faces: Faces, plane: Floats) -> Faces:
    """The faces turned the way of the polygon: the ear clipper picks its own."""
    after = np.roll(plane, -1, axis=0)
    around = (plane[:, 0] * after[:, 1] - plane[:, 1] * after[:, 0]).sum()
    ab, ac = plane[faces[:, 1]] - plane[faces[:, 0]], plane[faces[:, 2]] - plane[faces[:, 0]]
    wrong = (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) * around < 0
    faces[wrong] = faces[wrong][:, ::-1]
    return faces
