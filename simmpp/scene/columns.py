"""The numbers of many objects as arrays: what is asked of all of them is asked at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any, NamedTuple, get_args
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.scene import Cone, Floats, MeshPart, Polygon, Scene, SceneObject, Sphere

KINDS = tuple(of.kind for of in get_args(SceneObject))
SPHERE, CONE, POLYGON, MESH = range(len(KINDS))
FLAT = (Polygon, MeshPart)
Counts = NDArray[np.int64]


class Columns(NamedTuple):
    """N objects in their order."""

    kinds: NDArray[np.uint8]
    """(N,) uint8: of KINDS."""
    materials: Counts
    """(N,) int64."""
    spheres: Floats
    """(k, 4) float64: centre and radius of each sphere."""
    cones: Floats
    """(k, 8) float64: base, base radius, apex, apex radius of each cone."""
    n_vertices: Counts
    """(N,) int64: of polygons and parts of meshes; 0 for others."""
    vertices: Floats
    """(n, 3) float64, one object after the other."""
    n_normals: Counts
    """(N,) int64: vertex normals of polygons."""
    n_faces: Counts
    """(N,) int64: of parts of meshes; 0 for others."""
    faces: NDArray[np.int32]
    """(m, 3) int32 into ``vertices``, one object after the other."""

    def of_kind(self, kind: int) -> NDArray[np.int64]:
        """Numbers of the objects of a kind."""
        return np.flatnonzero(self.kinds == kind)


_OF_SCENES: WeakKeyDictionary[Scene, Columns] = WeakKeyDictionary()


def columns_of(scene: Scene) -> Columns:
    """The columns of a scene that ``check_scene`` finds nothing wrong with.

    Made once: who changes an object needs another scene.
    """
    if scene not in _OF_SCENES:
        _OF_SCENES[scene] = columns(scene.objects)
    return _OF_SCENES[scene]


def columns(objects: Sequence[SceneObject]) -> Columns:
    """The columns of objects."""
    codes = {kind: code for code, kind in enumerate(KINDS)}
    kinds = np.array([codes[obj.kind] for obj in objects], dtype=np.uint8)
    flat = [obj for obj in objects if isinstance(obj, FLAT)]
    parts = [obj for obj in flat if isinstance(obj, MeshPart)]
    n_vertices, n_normals, n_faces = np.zeros((3, len(objects)), np.int64)
    n_vertices[kinds >= POLYGON] = [len(obj.vertices) for obj in flat]
    n_faces[kinds == MESH] = [len(part.faces) for part in parts]
    n_normals[kinds == POLYGON] = [
        0 if obj.normals is None else len(obj.normals) for obj in flat if isinstance(obj, Polygon)
    ]
    faces = _joined([part.faces for part in parts], np.int32)
    before = (np.cumsum(n_vertices) - n_vertices)[kinds == MESH]
    if before.any():  # not in place: the faces of a single part are its own
        faces = faces + np.repeat(before, n_faces[kinds == MESH]).astype(np.int32)[:, None]
    return Columns(
        kinds=kinds,
        materials=np.array([obj.material for obj in objects], dtype=np.int64),
        spheres=_spheres([obj for obj in objects if isinstance(obj, Sphere)]),
        cones=_cones([obj for obj in objects if isinstance(obj, Cone)]),
        n_vertices=n_vertices,
        vertices=_joined([obj.vertices for obj in flat], np.float64),
        n_normals=n_normals,
        n_faces=n_faces,
        faces=faces,
    )


def _spheres(spheres: Sequence[Sphere]) -> Floats:
    radii = np.array([sphere.radius for sphere in spheres], dtype=np.float64)
    return np.column_stack([_rows([sphere.centre for sphere in spheres], 3), radii])


def _cones(cones: Sequence[Cone]) -> Floats:
    rows = ((*c.base, c.base_radius, *c.apex, c.apex_radius) for c in cones)
    return _rows(rows, 8)


def _rows(rows: Iterable[tuple[float, ...]], width: int) -> Floats:
    return np.fromiter(chain.from_iterable(rows), np.float64).reshape(-1, width)


def _joined(parts: list[NDArray[Any]], dtype: type) -> NDArray[Any]:
    """(n, 3) of a type; a single array stays itself if it is of that type already."""
    if len(parts) == 1:
        return np.ascontiguousarray(parts[0], dtype)
    return np.concatenate([np.empty((0, 3), dtype), *parts], dtype=dtype, casting="unsafe")
