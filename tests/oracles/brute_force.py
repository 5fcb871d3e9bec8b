"""Nearest hits by trying every object's own equation: slow, obvious, and no code of the tracer's.

Spheres and cones by the quadratic in world coordinates; polygons of any shape by their plane and
an even-odd count of crossings, with edges counted as inside or as outside.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from simmpp.scene.scene import Cone, MeshPart, Polygon, Scene, Sphere

EDGE = 1e-12
"""Points this near to an edge are inside."""
OPEN = -1e-9
"""Points this near to an edge, without the sign, are outside."""


class BruteForce:
    """Every object of a scene, in coordinates (x - origin) * scale."""

    def __init__(self, scene: Scene, origin: np.ndarray, scale: float) -> None:
        rounds, corners, starts, owners = [], [], [0], []
        for i, thing in enumerate(scene.objects):
            if isinstance(thing, Sphere):
                centre = (np.array(thing.centre) - origin) * scale
                rounds.append([i, *centre, abs(thing.radius) * scale, *centre, -1.0])
            elif isinstance(thing, Cone):
                base, apex = (np.array([thing.base, thing.apex]) - origin) * scale
                radii = thing.base_radius * scale, thing.apex_radius * scale
                rounds.append([i, *base, radii[0], *apex, radii[1]])
            else:
                for face in _faces(thing):
                    corners.append((face - origin) * scale)
                    starts.append(starts[-1] + len(face))
                    owners.append(i)
        self.rounds = np.array(rounds, dtype=np.float64).reshape(-1, 9)
        self.corners = np.concatenate([np.empty((0, 3)), *corners])
        self.starts = np.array(starts)
        self.owners = np.array(owners, dtype=np.int64)
        self.normals = np.array([_area(face) for face in corners]).reshape(-1, 3)

    def nearest(
        self, origins: np.ndarray, directions: np.ndarray, t_min: float, edge: float = EDGE
    ) -> tuple[np.ndarray, np.ndarray]:
        """Object (n,) int64, -1 for none, and distance (n,) float64 of each ray's first hit."""
        return _nearest(
            self.rounds,
            self.corners,
            self.starts,
            self.owners,
            self.normals,
            origins,
            directions,
            t_min,
            edge,
        )


def _faces(thing: Polygon | MeshPart) -> list[np.ndarray]:
    if isinstance(thing, Polygon):
        return [thing.vertices]
    return list(thing.vertices[thing.faces])


def _area(face: np.ndarray) -> np.ndarray:
    spokes = face - face[0]
    return np.cross(spokes[:-1], spokes[1:]).sum(axis=0)


@njit(error_model="numpy")
def _nearest(rounds, corners, starts, owners, normals, origins, directions, t_min, edge):
    ids, distances = np.full(len(origins), -1, np.int64), np.full(len(origins), np.inf)
    for i in range(len(origins)):
        o, d = origins[i], directions[i]
        for k in range(len(rounds)):
            row = rounds[k]
            near = -np.dot(o - row[1:4], d)  # from there, where distances are small
            p = o + near * d
            t = _sphere(row, p, d, t_min - near) if row[8] < 0 else _cone(row, p, d, t_min - near)
            t += near
            if t < distances[i] or (t == distances[i] and row[0] < ids[i]):
                ids[i], distances[i] = int(row[0]), t
        for k in range(len(owners)):
            t = _polygon(corners[starts[k] : starts[k + 1]], normals[k], o, d, t_min, edge)
            if t < distances[i] or (t == distances[i] and owners[k] < ids[i]):
                ids[i], distances[i] = owners[k], t
    return ids, distances


@njit(error_model="numpy")
def _sphere(row, o, d, t_min):
    a = b = c = 0.0
    for k in range(3):
        a += d[k] * d[k]
        b += d[k] * (o[k] - row[1 + k])
        c += (o[k] - row[1 + k]) ** 2
    return _first_root(a, b, c - row[4] ** 2, t_min, 0.0, 0.0, -1.0, 1.0)


@njit(error_model="numpy")
def _cone(row, o, d, t_min):
    """Points at base + s (apex - base), 0 <= s <= 1, of distance r(s) from the axis."""
    length2 = oa = da = a = b = c = 0.0
    for k in range(3):
        axis = row[5 + k] - row[1 + k]
        length2 += axis * axis
        oa += (o[k] - row[1 + k]) * axis
        da += d[k] * axis
        a += d[k] * d[k]
        b += d[k] * (o[k] - row[1 + k])
        c += (o[k] - row[1 + k]) ** 2
    s0, s1 = oa / length2, da / length2
    r0, r1 = row[4] + s0 * (row[8] - row[4]), s1 * (row[8] - row[4])
    a -= s1 * s1 * length2 + r1 * r1
    b -= s0 * s1 * length2 + r0 * r1
    c -= s0 * s0 * length2 + r0 * r0
    return _first_root(a, b, c, t_min, s0, s1, 0.0, 1.0)


@njit(error_model="numpy")
def _first_root(a, b, c, t_min, s0, s1, least, most):
    """Least t > t_min with a t^2 + 2 b t + c = 0 and least <= s0 + s1 t <= most."""
    best = np.inf
    if a == 0.0:
        t = -c / (2 * b)
        return t if t > t_min and least <= s0 + s1 * t <= most else best
    root = b * b - a * c
    if root >= 0.0:
        for sign in (-1.0, 1.0):
            t = (-b + sign * math.sqrt(root)) / a
            if t_min < t < best and least <= s0 + s1 * t <= most:
                best = t
    return best


@njit(error_model="numpy")
def _polygon(corners, normal, o, d, t_min, edge):
    slope = normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2]
    if slope == 0.0:
        return np.inf
    t = 0.0
    for k in range(3):
        t += normal[k] * (corners[0, k] - o[k])
    t /= slope
    if not t > t_min:
        return np.inf
    drop = 0
    for k in range(3):
        drop = k if abs(normal[k]) > abs(normal[drop]) else drop
    x, y = (drop + 1) % 3, (drop + 2) % 3
    px, py = o[x] + t * d[x], o[y] + t * d[y]
    inside = False
    for k in range(len(corners)):
        ax, ay, bx, by = corners[k - 1, x], corners[k - 1, y], corners[k, x], corners[k, y]
        if _near(px - ax, py - ay, bx - ax, by - ay, abs(edge)):
            return t if edge > 0 else np.inf
        if (ay > py) != (by > py) and px < ax + (py - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return t if inside else np.inf


@njit(error_model="numpy")
def _near(px, py, ex, ey, edge):
    """Whether (px, py) is within ``edge`` of the segment from 0 to (ex, ey)."""
    length2 = ex * ex + ey * ey
    s = min(max((px * ex + py * ey) / length2, 0.0), 1.0) if length2 > 0 else 0.0
    return (px - s * ex) ** 2 + (py - s * ey) ** 2 <= edge * edge
