"""The axis-aligned box of an object: where a ray has to pass for the object to be tested."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simmpp.scene.scene import Cone, Floats, MeshPart, Polygon, SceneObject, Sphere

ORIGIN: Floats = np.zeros(3)
"""The origin of the scene's own coordinates."""


def boxes(objects: Sequence[SceneObject], origin: Floats = ORIGIN) -> Floats:
    """Bounds of objects, seen from ``origin`` (3,): (n, 2, 3) float64, low and high corners.

    An offset of everything, the origin too, leaves them as they are, if the coordinates bear it.
    """
    bounds = np.empty((len(objects), 2, 3))
    spheres = [i for i, obj in enumerate(objects) if isinstance(obj, Sphere)]
    cones = [i for i, obj in enumerate(objects) if isinstance(obj, Cone)]
    bounds[spheres] = _sphere_boxes([objects[i] for i in spheres], origin)
    bounds[cones] = _cone_boxes([objects[i] for i in cones], origin)
    flat = [i for i, obj in enumerate(objects) if isinstance(obj, Polygon | MeshPart)]
    if flat:
        corners = [_corners(objects[i]) for i in flat]
        starts = np.cumsum([0] + [len(part) for part in corners[:-1]])
        points = np.concatenate(corners) - origin
        bounds[flat, 0] = np.minimum.reduceat(points, starts)
        bounds[flat, 1] = np.maximum.reduceat(points, starts)
    return bounds


def scene_box(objects: Sequence[SceneObject]) -> Floats:
    """Bounds of all objects together: (2, 3) float64; at least one object is needed."""
    bounds = boxes(objects)
    return np.stack([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])


def _corners(obj: SceneObject) -> Floats:
    if isinstance(obj, MeshPart):
        return obj.vertices[np.unique(obj.faces)]  # one that no face uses is not to be hit
    if isinstance(obj, Polygon):
        return obj.vertices
    raise TypeError(f"no corners: {obj.kind}")


def _sphere_boxes(objects: Sequence[SceneObject], origin: Floats) -> Floats:
    rows = [(*s.centre, s.radius) for s in objects if isinstance(s, Sphere)]
    values = np.array(rows).reshape(-1, 4)
    centre, radius = values[:, :3] - origin, np.abs(values[:, 3:])
    return np.stack([centre - radius, centre + radius], axis=1)


def _cone_boxes(objects: Sequence[SceneObject], origin: Floats) -> Floats:
    """Bounds of two discs each: a disc of radius r reaches r sqrt(1 - a_k^2) along axis k.

    1 - a_k^2 is taken from the other two components, so that a disc across an axis has no
    thickness of rounding.
    """
    rows = [
        (*c.base, c.base_radius, *c.apex, c.apex_radius) for c in objects if isinstance(c, Cone)
    ]
    values = np.array(rows).reshape(-1, 8)
    base, base_radius, apex, apex_radius = np.split(values, (3, 4, 7), axis=1)
    base, apex = base - origin, apex - origin
    along = (apex - base) ** 2
    across = along[:, [1, 0, 0]] + along[:, [2, 2, 1]]
    length = along.sum(axis=1, keepdims=True)
    # Without a length there is no axis to be across: the object is no thicker than its centre.
    reach = np.sqrt(across / np.where(length > 0, length, 1))
    base_reach, apex_reach = np.abs(base_radius) * reach, np.abs(apex_radius) * reach
    low = np.minimum(base - base_reach, apex - apex_reach)
    high = np.maximum(base + base_reach, apex + apex_reach)
    return np.stack([low, high], axis=1)
