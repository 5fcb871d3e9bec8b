"""A scene as flat arrays in its normalised frame: what compiled intersections read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.scene import Cone, MeshPart, Polygon, Scene, SceneObject, Sphere
from simmpp.scene.triangles import triangles
from simmpp.workload.trace import bvh
from simmpp.workload.trace.frame import Frame
from simmpp.workload.workload import CONE, OBJECT_KINDS, POLYGON, SPHERE

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

PADDING = 2.0**-46
"""Boxes grow by this share of their diagonal and distance from the origin: 64 roundings, so that a
ray that hits a flat object also enters its box."""
FEW_TRIANGLES = 8
"""Objects of more triangles have a tree of their own."""
SLIVER = 1e-14
"""A triangle whose sine of the angle between two edges is below this has no area."""
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

    @property
    def kinds(self) -> NDArray[np.uint8]:
        """(N,) uint8: SPHERE, CONE, POLYGON or MESH."""
        return self.shapes.objects[:, 0].astype(np.uint8)


def flatten(scene: Scene, frame: Frame) -> Geometry:
    """The arrays of ``scene`` in ``frame``."""
    things = scene.objects
    kinds = np.array([OBJECT_KINDS.index(thing.kind) for thing in things], dtype=np.int32)
    surfaces, counts = _surfaces(things, frame)
    after = np.cumsum(counts, dtype=np.int32)
    first = after - counts
    boxes = padded(_boxes(kinds, first, surfaces))
    box = np.hstack([boxes[:, :3].min(0, initial=np.inf), boxes[:, 3:].max(0, initial=-np.inf)])
    roots, tree = _trees(boxes, first, counts, surfaces)
    objects = np.stack([kinds, np.where(roots < 0, first, after), after, roots], axis=1)
    materials = [scene.materials[thing.material] for thing in things]
    return Geometry(
        shapes=Shapes(objects.astype(np.int32), surfaces, *tree, T_MIN * diagonal(box)),
        boxes=boxes,
        box=box,
        normals=_normals(kinds, first, surfaces),
        n_triangles=np.where(kinds >= POLYGON, counts, 0).astype(np.int32),
        reflects=np.array([material.reflects for material in materials], dtype=np.bool_),
        transmits=np.array([material.transmits for material in materials], dtype=np.bool_),
        ior=np.array([material.ior for material in materials], dtype=np.float64),
    )


def padded(boxes: Floats) -> Floats:
    """Boxes (n, 6) float64 grown by PADDING."""
    low, high = boxes[:, :3], boxes[:, 3:]
    # Slab tests subtract the origin from a bound, so they round by a share of where the box lies,
    # and intersections by a share of how large its object is: either may be the larger.
    reach = np.abs(boxes).max(axis=1, initial=0.0)
    grow = PADDING * (np.sqrt(((high - low) ** 2).sum(axis=1)) + reach)[:, None]
    return np.hstack([low - grow, high + grow])


def diagonal(box: Floats) -> float:
    """Length of the diagonal of ``box`` (6,) float64; 0 if it is inside out."""
    if box[0] > box[3]:
        return 0.0
    return float(np.sqrt(((box[3:] - box[:3]) ** 2).sum()))


def _surfaces(things: tuple[SceneObject, ...], frame: Frame) -> tuple[Floats, Ints]:
    """``Shapes.surfaces`` of all objects, and how many rows each has, (N,) int32."""
    flat = [triangles(thing) for thing in things if isinstance(thing, Polygon | MeshPart)]
    round_rows = [_round_row(thing, frame) for thing in things if isinstance(thing, Sphere | Cone)]
    is_round = np.array([isinstance(thing, Sphere | Cone) for thing in things], dtype=np.bool_)
    counts = np.ones(len(things), dtype=np.int32)
    counts[~is_round] = [len(part) for part in flat]
    surfaces = np.empty((counts.sum(), 9))
    of_round = np.repeat(is_round, counts)
    surfaces[of_round] = np.array(round_rows).reshape(-1, 9)
    surfaces[~of_round] = _with_edges(frame.points(np.concatenate([np.empty((0, 3, 3)), *flat])))
    return surfaces, counts


def _round_row(thing: Sphere | Cone, frame: Frame) -> Floats:
    if isinstance(thing, Cone):
        return _cone(thing, frame)
    row = np.zeros(9)
    row[:3] = frame.points(np.array(thing.centre))
    row[3] = abs(thing.radius) * frame.scale
    return row


def _cone(cone: Cone, frame: Frame) -> Floats:
    """A cone's row; height 0 if it has no surface."""
    base, apex = frame.points(np.array([cone.base, cone.apex]))
    height = float(np.sqrt(((apex - base) ** 2).sum()))
    radius, apex_radius = abs(cone.base_radius) * frame.scale, abs(cone.apex_radius) * frame.scale
    # Two points apart in the scene may be one here, where both have lost their last digits.
    if height == 0.0 or max(radius, apex_radius) == 0.0:
        return np.array([*base, 0.0, 0.0, 1.0, 0.0, radius, 0.0])
    axis, growth = (apex - base) / height, (apex_radius - radius) / height
    return np.array([*base, *axis, height, radius, growth])


def _with_edges(corners: Floats) -> Floats:
    edges = corners[:, 1:] - corners[:, :1]
    area = np.cross(edges[:, 0], edges[:, 1])
    lengths = np.sqrt((edges**2).sum(axis=2)).prod(axis=1)
    # Edges of 0 make a determinant of 0: never hit, whatever direction roundings gave the sliver.
    edges[np.sqrt((area**2).sum(axis=1)) <= SLIVER * lengths] = 0.0
    return np.concatenate([corners[:, 0], edges[:, 0], edges[:, 1]], axis=1)


def _normals(kinds: Ints, first: Ints, surfaces: Floats) -> Floats:
    """Unit normals (N, 3) of polygons: sums of area vectors, right even at a concave corner."""
    normals = np.zeros((len(kinds), 3))
    if len(kinds):  # reduceat refuses an index into nothing
        # Rows of spheres and cones give areas without a meaning, of which none is taken.
        areas = np.add.reduceat(np.cross(surfaces[:, 3:6], surfaces[:, 6:]), first)
        normals[kinds == POLYGON] = areas[kinds == POLYGON]
    lengths = np.sqrt((normals**2).sum(axis=1, keepdims=True))
    return normals / np.where(lengths > 0, lengths, 1.0)  # without area it is never hit


def _boxes(kinds: Ints, first: Ints, surfaces: Floats) -> Floats:
    """Tight boxes (N, 6) float64."""
    boxes = np.empty((len(kinds), 6))
    spheres, cones, flat = kinds == SPHERE, kinds == CONE, kinds >= POLYGON
    centre, radius = np.split(surfaces[first[spheres], :4], (3,), axis=1)
    boxes[spheres] = np.hstack([centre - radius, centre + radius])
    boxes[cones] = _cone_boxes(surfaces[first[cones]])
    if flat.any():  # as for normals, all rows are taken as triangles, and round ones dropped
        low, high = np.split(_triangle_boxes(surfaces), 2, axis=1)
        boxes[flat, :3] = np.minimum.reduceat(low, first)[flat]
        boxes[flat, 3:] = np.maximum.reduceat(high, first)[flat]
    return boxes


def corners_of(rows: Floats) -> Floats:
    """Corners (n, 3, 3) of triangles (n, 9), as intersections see them."""
    # Not those of the scene: vertex + (corner - vertex) may be rounded to another number.
    vertex, e1, e2 = np.split(rows, 3, axis=1)
    return np.stack([vertex, vertex + e1, vertex + e2], axis=1)


def _triangle_boxes(rows: Floats) -> Floats:
    """Boxes (n, 6) of triangles (n, 9)."""
    corners = corners_of(rows)
    return np.hstack([corners.min(axis=1), corners.max(axis=1)])


def _cone_boxes(cones: Floats) -> Floats:
    """Boxes of the two rims of each cone (n, 9): a disc reaches r sqrt(1 - axis^2) to each side.

    1 - axis^2 is the sum of the other two squares: a difference would lose half the digits.
    """
    base, axis, height, radius, growth = np.split(cones, (3, 6, 7, 8), axis=1)
    reach = np.sqrt(axis[:, [1, 0, 0]] ** 2 + axis[:, [2, 2, 1]] ** 2)
    apex, apex_radius = base + height * axis, radius + height * growth
    low = np.minimum(base - radius * reach, apex - apex_radius * reach)
    high = np.maximum(base + radius * reach, apex + apex_radius * reach)
    return np.hstack([low, high])


def _trees(boxes: Floats, first: Ints, counts: Ints, surfaces: Floats) -> tuple[Ints, bvh.Tree]:
    """Roots (N,) int32 of objects of many triangles, and all nodes, the objects' tree first."""
    roots = np.full(len(first), -1, dtype=np.int32)
    trees = [bvh.build(boxes)]
    n_nodes = len(trees[0].children)
    for i in np.flatnonzero(counts > FEW_TRIANGLES):
        part = surfaces[first[i] : first[i] + counts[i]]
        tree = bvh.build(padded(_triangle_boxes(part)))
        # One array for all trees: a compiled call pays for each array that it is given.
        trees.append(bvh.shifted(tree, nodes=n_nodes, leaves=int(first[i])))
        roots[i] = n_nodes
        n_nodes += len(tree.children)
    return roots, bvh.Tree(*(np.concatenate(arrays) for arrays in zip(*trees, strict=True)))
