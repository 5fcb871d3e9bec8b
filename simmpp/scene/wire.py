"""How many bytes an object takes in a message.

ESTIMATE: Nebel 1998 gives no sizes. Geometry goes in 64-bit reals (a point or a normal 24 bytes),
ids in 32 bits, and a primitive is padded to 128 bytes, so that sphere (32 bytes of geometry),
cone (64) and triangle (72) weigh the same: they differ less than what comes with them, a material
(8 reals, or a reference to it), ids and a bounding box. A mesh part carries its vertices once and
its faces as triples of 32-bit indices. Message headers come on top, see the machine.
"""

from __future__ import annotations

import numpy as np

from simmpp.scene.columns import MESH, POLYGON, Columns, Counts, columns
from simmpp.scene.scene import SceneObject

PRIMITIVE_BYTES = 128
"""A sphere, a cone or a triangle. ESTIMATE."""
POINT_BYTES = 24
"""Three 64-bit reals."""
MESH_BYTES = 56
"""A mesh part without vertices and faces: ids, material, counts, box of six reals as 32 bits
each. ESTIMATE; so a part of one triangle takes 56 + 3 * 24 + 12 = 140 bytes."""
FACE_BYTES = 12
"""Three 32-bit indices."""


def bytes_on_the_wire(obj: SceneObject) -> int:
    """Size of an object in a message, in bytes, without the message's header. ESTIMATE.

    Sphere, cone and triangle 128; a polygon 24 more per vertex beyond the third and per vertex
    normal; a mesh part 56 + 24 per vertex + 12 per face.
    """
    return int(sizes_on_the_wire(columns([obj]))[0])


def sizes_on_the_wire(objects: Columns) -> Counts:
    """The same of all objects, (N,) int64."""
    points = POINT_BYTES * objects.n_vertices
    polygons = PRIMITIVE_BYTES + points + POINT_BYTES * (objects.n_normals - 3)
    parts = MESH_BYTES + points + FACE_BYTES * objects.n_faces
    flat = np.where(objects.kinds == MESH, parts, polygons)
    return np.where(objects.kinds < POLYGON, PRIMITIVE_BYTES, flat)
