"""How many bytes an object takes in a message.

ESTIMATE: Nebel 1998 gives no sizes. Geometry goes in 64-bit reals (a point or a normal 24 bytes),
ids in 32 bits, and a primitive is padded to 128 bytes, so that sphere (32 bytes of geometry),
cone (64) and triangle (72) weigh the same: they differ less than what comes with them, a material
(8 reals, or a reference to it), ids and a bounding box. A mesh part carries its vertices once and
its faces as triples of 32-bit indices. Message headers come on top, see the machine.
"""

from __future__ import annotations

from simmpp.scene.scene import Cone, MeshPart, Polygon, SceneObject, Sphere

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
    match obj:
        case Sphere() | Cone():
            return PRIMITIVE_BYTES
        case Polygon():
            normals = 0 if obj.normals is None else len(obj.normals)
            return PRIMITIVE_BYTES + POINT_BYTES * (len(obj.vertices) - 3 + normals)
        case MeshPart():
            return MESH_BYTES + POINT_BYTES * len(obj.vertices) + FACE_BYTES * len(obj.faces)
