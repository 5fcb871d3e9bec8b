"""The axis-aligned box of an object: where a ray has to pass for the object to be tested."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.columns import CONE, MESH, POLYGON, SPHERE, Columns, columns
from simmpp.scene.scene import Floats, SceneObject

ORIGIN: Floats = np.zeros(3)
"""The origin of the scene's own coordinates."""


def boxes(objects: Sequence[SceneObject], origin: Floats = ORIGIN) -> Floats:
    """Bounds of objects, seen from ``origin`` (3,): (n, 2, 3) float64, low and high corners.

    An offset of everything, the origin too, leaves them as they are, if the coordinates bear it.
    """
    return boxes_of(columns(objects), origin)


def boxes_of(objects: Columns, origin: Floats = ORIGIN) -> Floats:
    """The same of objects that are columns already."""
    bounds = np.empty((len(objects.kinds), 2, 3))
    bounds[objects.kinds == SPHERE] = _sphere_boxes(objects.spheres, origin)
    bounds[objects.kinds == CONE] = _cone_boxes(objects.cones, origin)
    flat = objects.kinds >= POLYGON
    if flat.any():
        sizes = objects.n_vertices[flat]
        starts = np.cumsum(sizes) - sizes
        low = high = objects.vertices - origin
        unused = _unused(objects)
        if unused.any():
            low = high.copy()
            low[unused], high[unused] = np.inf, -np.inf
        bounds[flat, 0] = np.minimum.reduceat(low, starts)
        bounds[flat, 1] = np.maximum.reduceat(high, starts)
    return bounds


def scene_box(objects: Sequence[SceneObject]) -> Floats:
    """Bounds of all objects together: (2, 3) float64; at least one object is needed."""
    bounds = boxes(objects)
    return np.stack([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])


def _unused(objects: Columns) -> NDArray[np.bool_]:
    """(n,) bool: vertices of meshes that no face uses, which are not to be hit."""
    unused = np.repeat(objects.kinds == MESH, objects.n_vertices)
    if len(objects.faces):
        unused[objects.faces] = False
    return unused


def _sphere_boxes(spheres: Floats, origin: Floats) -> Floats:
    centre, radius = spheres[:, :3] - origin, np.abs(spheres[:, 3:])
    return np.stack([centre - radius, centre + radius], axis=1)


def _cone_boxes(cones: Floats, origin: Floats) -> Floats:
    """Bounds of two discs each: a disc of radius r reaches r sqrt(1 - a_k^2) along axis k.

    1 - a_k^2 is taken from the other two components, so that a disc across an axis has no
    thickness of rounding.
    """
    base, base_radius, apex, apex_radius = np.split(cones, (3, 4, 7), axis=1)
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
