"""Triangles around a sphere or cone, for intersectors that know nothing but triangles.

A proxy lies outside the surface or touches it, so a ray that meets the surface has to pass the
proxy. A sphere's is closed. A cone's has no caps, as the cone has none, and is a little longer: a
ray through an open end that leaves the cone at a shallow angle just inside the rim can miss it.
"""

from __future__ import annotations

import math

import numpy as np

from simmpp.scene.scene import Cone, Floats, SceneObject, Sphere
from simmpp.scene.triangles import triangles

MARGIN = 1e-6
"""Proxies grow by this share, several roundings to 32-bit reals. ESTIMATE."""
SIDES = 12
OVERHANG = 1 / 64
"""How much longer a cone's proxy is at each end, as a share of its length. ESTIMATE."""


def proxy_triangles(item: SceneObject) -> Floats:
    """Triangles (m, 3, 3) float64 around an object: 80 for a sphere, 24 for a cone or cylinder.

    Polygons and mesh parts are their own.
    """
    match item:
        case Sphere():
            return SPHERE_PROXY * abs(item.radius) + np.array(item.centre)
        case Cone():
            return _around_cone(item)
        case _:
            return triangles(item)


def _icosahedron() -> Floats:
    """Its 20 faces, (20, 3, 3) float64, corners at distance 1, seen counter-clockwise."""
    golden = (1 + math.sqrt(5)) / 2
    corners = [
        point
        for a in (-1.0, 1.0)
        for b in (-golden, golden)
        for point in ((0, a, b), (a, b, 0), (b, 0, a))
    ]
    points = np.array(corners) / math.hypot(1, golden)
    edge = 2 / math.hypot(1, golden)
    near = np.abs(np.linalg.norm(points[:, None] - points, axis=2) - edge) < 1e-6
    faces = [
        (i, j, k) if np.linalg.det(points[[i, j, k]]) > 0 else (i, k, j)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    return points[faces]


def _sphere_proxy() -> Floats:
    """80 triangles whose planes all lie outside the unit sphere."""
    corners = _icosahedron()
    middles = corners + np.roll(corners, -1, axis=1)
    middles /= np.linalg.norm(middles, axis=2, keepdims=True)
    (a, b, c), (ab, bc, ca) = np.moveaxis(corners, 1, 0), np.moveaxis(middles, 1, 0)
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    faces = np.concatenate([np.stack(part, axis=1) for part in parts])
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    nearest = (normals * faces[:, 0]).sum(axis=1).min()
    proxy: Floats = faces * ((1 + MARGIN) / nearest)
    return proxy


SPHERE_PROXY = _sphere_proxy()
"""(80, 3, 3) float64, around the unit sphere."""


def _around_cone(cone: Cone) -> Floats:
    """A prism or pyramid of SIDES sides whose sides touch the cone."""
    base, apex = np.array(cone.base), np.array(cone.apex)
    axis = (apex - base) / np.linalg.norm(apex - base)
    # Crossing with the axis of its least component keeps far from zero length.
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    angles = np.arange(SIDES) * (2 * math.pi / SIDES)
    round_about = np.outer(np.cos(angles), side) + np.outer(np.sin(angles), np.cross(axis, side))
    rings = []
    for t in (-OVERHANG, 1 + OVERHANG):
        # Past the tip of a pointed cone the radius stays 0, so the proxy is wider at the tip.
        radius = max(0.0, abs(cone.base_radius) * (1 - t) + abs(cone.apex_radius) * t)
        corners = radius * (1 + MARGIN) / math.cos(math.pi / SIDES) * round_about
        rings.append(base + t * (apex - base) + corners)
    low, high = rings
    next_low, next_high = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    proxy: Floats = np.concatenate(
        [np.stack([low, next_low, next_high], axis=1), np.stack([low, next_high, high], axis=1)]
    )
    return proxy
