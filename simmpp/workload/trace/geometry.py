"""A scene as flat arrays in its normalised frame: what compiled intersections read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.columns import POLYGON, columns_of
from simmpp.scene.scene import Scene
from simmpp.workload.trace import bvh
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.surfaces import boxes_of, normals_of, padded, row_boxes, surfaces_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

FEW_TRIANGLES = 8
"""Objects of more triangles have a tree of their own."""
T_MIN = 1e-9
"""Least distance of a hit from the origin of its ray, in diagonals of the scene."""


class Shapes(NamedTuple):
    """What an intersection reads: few arrays, since compiled calls pay for each."""

    objects: NDArray[np.int32]
    """(N, 4) int32: kind; first and last + 1 of its rows of ``surfaces`` (equal if it has a tree
    of its own); root of that tree, else -1."""
    surfaces: Floats
    """(rows, 9) float64. Sphere: centre, radius. Cone: base, axis of length 1, height, base radius,
    growth of the radius per length. Triangle: a vertex and the two edges from it; edges 0 if it
    has no area."""
    bounds: Floats
    """(nodes, 6, 8) float64 of a tree: node 0 is the root over the objects' boxes, whose leaves
    are objects; after it come trees of single objects, whose leaves are rows."""
    children: NDArray[np.int32]
    """(nodes, 8) int32."""
    t_min: float
    """Hits nearer than this are not counted."""


class Geometry(NamedTuple):
    """A scene in its frame; N objects, lengths normalised."""

    shapes: Shapes
    boxes: Floats
    """(N, 6) float64: low and high corner, padded."""
    box: Floats
    """(6,) float64: the box of all; inside out without objects."""
    normals: Floats
    """(N, 3) float64 of length 1: of polygons; else 0."""
    n_triangles: NDArray[np.int32]
    """(N,) int32; 0 for spheres and cones."""
    reflects: NDArray[np.bool_]
    """(N,) bool: a hit spawns a reflected ray."""
    transmits: NDArray[np.bool_]
    """(N,) bool: a hit spawns a refracted ray."""
    ior: Floats
    """(N,) float64: index of refraction."""
    vertices: NDArray[np.float32]
    """(n, 3) float32: for embree, corners of all triangles ..."""
    faces: NDArray[np.int32]
    """(m, 3) int32: ... and which each has, in the order of their rows."""

    @property
    def kinds(self) -> NDArray[np.uint8]:
        """(N,) uint8: SPHERE, CONE, POLYGON or MESH."""
        return self.shapes.objects[:, 0].astype(np.uint8)


def flatten(scene: Scene, frame: Frame) -> Geometry:
    """The arrays of ``scene`` in ``frame``."""
    columns = columns_of(scene)
    kinds, surfaces = columns.kinds, surfaces_of(columns, frame)
    after = np.cumsum(surfaces.n_rows, dtype=np.int64)
    first = after - surfaces.n_rows
    boxes = padded(boxes_of(kinds, surfaces))
    box = np.hstack([boxes[:, :3].min(0, initial=np.inf), boxes[:, 3:].max(0, initial=-np.inf)])
    # One array for all trees: a compiled call pays for each array that it is given.
    many = surfaces.n_rows > FEW_TRIANGLES
    spans = np.stack([first[many], after[many]], axis=1)
    tree, roots = bvh.build(boxes, row_boxes(surfaces.rows, spans), spans)
    objects = np.stack([kinds, first, after, np.full(len(kinds), -1)], axis=1).astype(np.int32)
    objects[many, 1], objects[many, 3] = after[many], roots
    reflects, transmits, ior = _of_materials(scene)
    return Geometry(
        shapes=Shapes(objects, surfaces.rows, *tree, T_MIN * diagonal(box)),
        boxes=boxes,
        box=box,
        normals=normals_of(kinds, surfaces),
        n_triangles=np.where(kinds >= POLYGON, surfaces.n_rows, 0).astype(np.int32),
        reflects=reflects[columns.materials],
        transmits=transmits[columns.materials],
        ior=ior[columns.materials],
        vertices=surfaces.vertices.astype(np.float32),
        faces=surfaces.faces,
    )


def _of_materials(scene: Scene) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Floats]:
    """Which reflect, which transmit, and their indices of refraction."""
    return (
        np.array([material.reflects for material in scene.materials], dtype=np.bool_),
        np.array([material.transmits for material in scene.materials], dtype=np.bool_),
        np.array([material.ior for material in scene.materials], dtype=np.float64),
    )


def diagonal(box: Floats) -> float:
    """Length of the diagonal of ``box`` (6,) float64; 0 if it is inside out."""
    if box[0] > box[3]:
        return 0.0
    return float(np.sqrt(((box[3:] - box[:3]) ** 2).sum()))
