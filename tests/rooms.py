"""Two small scenes, written as files for the package and told body by body for another renderer.

``room.glb`` (y up) has its own camera and two lights; nodes are turned, mirrored and sheared.
``yard.yaml`` (z up) puts an OBJ with an MTL and a second one, turned and mirrored, together; camera
and lights are the configuration's. Either has a mirror and glass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gltf_files import File
from scipy.spatial.transform import Rotation

SHAPE = (320, 180)
"""Columns and rows."""
YFOV_DEGREES, ANGLE_DEGREES = 40.0, 35.0
GLASS_IOR = 1.5
MATT, MIRROR, GLASS = "matt", "mirror", "glass"
Array = np.ndarray[Any, np.dtype[Any]]


@dataclass(frozen=True)
class Body:
    """A closed surface in its place."""

    name: str
    """The object's in the package."""
    vertices: Array
    """(n, 3) in the scene's coordinates."""
    faces: Array
    """(m, 3) counter-clockwise seen from the outside."""
    finish: str
    colour: tuple[float, float, float]


@dataclass(frozen=True)
class Room:
    """What another renderer needs to know."""

    bodies: list[Body]
    to_world: Array
    """(4, 4): the camera looks along -z with y upwards, as in glTF."""
    angle_degrees: float
    """From top to bottom."""
    lights: list[tuple[float, float, float]]


def box(*size: float) -> tuple[Array, Array]:
    """A box around the origin."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return corners * size, np.array(faces)


def ball(radius: float, steps: int = 12) -> tuple[Array, Array]:
    """A sphere of triangles; poles are along y."""
    down = np.arange(1, steps) * np.pi / steps
    around = np.arange(2 * steps) * np.pi / steps
    rings = [
        (math.sin(a) * math.cos(b), math.cos(a), math.sin(a) * math.sin(b))
        for a in down
        for b in around
    ]
    n, faces = 2 * steps, []
    for i in range(n):
        j = (i + 1) % n
        faces.append((0, 1 + j, 1 + i))
        for row in range(steps - 2):
            a, b, c, d = (1 + n * row + k for k in (i, j, n + i, n + j))
            faces += [(a, b, c), (b, d, c)]
        last = 1 + n * (steps - 2)
        faces.append((1 + n * (steps - 1), last + i, last + j))
    return radius * np.array([(0, 1, 0), *rings, (0, -1, 0)]), np.array(faces)


def affine(linear: Any = None, move: Any = (0, 0, 0)) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) if linear is None else linear
    matrix[:3, 3] = move
    return matrix


def turn(axis: str, degrees: float) -> Array:
    return Rotation.from_euler(axis, degrees, degrees=True).as_matrix()


def body(name: str, shape: tuple[Array, Array], matrix: Array, finish: str, colour: Any) -> Body:
    """The shape under the matrix; its outside is where its volume is positive."""
    vertices = shape[0] @ matrix[:3, :3].T + matrix[:3, 3]
    faces = shape[1]
    volume = np.linalg.det(vertices[faces] - vertices.mean(axis=0)).sum()
    return Body(name, vertices, faces if volume > 0 else faces[:, ::-1], finish, colour)


SHEAR = np.array([[1, 0.5, 0], [0, 1, 0], [0, 0.2, 1]])
ROOM: list[tuple[str, tuple[Array, Array], Array, str, tuple[float, float, float]]] = [
    ("floor", box(9, 0.2, 9), affine(move=(0, -0.1, 0)), MATT, (0.8, 0.8, 0.8)),
    ("wall", box(9, 4, 0.2), affine(move=(0, 2, -4.5)), MATT, (0.8, 0.6, 0.2)),
    (
        "sheared",
        box(1, 1.4, 1),
        affine(SHEAR @ np.diag([-1, 1, 1]), (-2.2, 0.7, -0.4)),
        MATT,
        (0.8, 0.2, 0.2),
    ),
    (
        "mirror",
        box(2.4, 2.6, 0.1),
        affine(turn("y", 30) @ np.diag([1, 1, -1]), (-1.2, 1.3, -2.6)),
        MIRROR,
        (1.0, 1.0, 1.0),
    ),
    (
        "glass",
        ball(0.9),
        affine(turn("z", 20) @ np.diag([-1, 1.1, 1]), (0.8, 1.0, 0.6)),
        GLASS,
        (1.0, 1.0, 1.0),
    ),
    ("pillar", box(0.5, 3, 0.5), affine(turn("y", 40), (2.4, 1.5, -1.6)), MATT, (0.2, 0.4, 0.8)),
]
CAMERA_ABOVE = affine(turn("y", 12), (0.4, 1.2, 0.5))
CAMERA_LOCAL = affine(turn("x", -11), (1, 1, 7))
ROOM_LIGHTS = [(3.5, 4.5, 4.0), (-3.0, 4.0, 2.0)]


def room(folder: Path) -> Room:
    """Write ``room.glb``, and tell what is in it."""
    file = File()
    for name, (vertices, faces), matrix, finish, colour in ROOM:
        attributes = {"POSITION": file.accessor(vertices)}
        indices = file.accessor(faces.ravel(), "u2")
        material = file.add("materials", **_gltf_finish(finish, colour))
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        file.node(name=name, mesh=file.mesh(primitive), matrix=matrix.T.ravel().tolist())
    file.add("cameras", type="perspective", perspective={"yfov": math.radians(YFOV_DEGREES)})
    camera = file.node(name="Camera", camera=0, root=False, matrix=CAMERA_LOCAL.T.ravel().tolist())
    file.node(children=[camera], matrix=CAMERA_ABOVE.T.ravel().tolist())
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    for place in ROOM_LIGHTS:
        file.node(translation=place, extensions={"KHR_lights_punctual": {"light": 0}})
    file.write(folder / "room.glb")
    bodies = [
        # Positions are of 32 bits in the file.
        body(name, (shape[0].astype(np.float32).astype(float), shape[1]), matrix, finish, colour)
        for name, shape, matrix, finish, colour in ROOM
    ]
    return Room(bodies, CAMERA_ABOVE @ CAMERA_LOCAL, YFOV_DEGREES, ROOM_LIGHTS)


def _gltf_finish(finish: str, colour: Any) -> dict[str, Any]:
    metal = {"metallicFactor": float(finish == MIRROR), "roughnessFactor": float(finish == MATT)}
    said: dict[str, Any] = {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1]} | metal}
    if finish == GLASS:
        said["extensions"] = {
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_ior": {"ior": GLASS_IOR},
        }
    return said


Z_UP = turn("x", 90)
"""From y up to z up."""
YARD = [
    ("ground", box(10, 10, 0.2), affine(move=(0, 0, -0.1)), MATT, (0.7, 0.7, 0.6)),
    ("tower", box(1, 1, 3), affine(turn("z", 25), (-2, 1.5, 1.5)), MATT, (0.7, 0.3, 0.2)),
    ("pane", box(3, 0.1, 2), affine(turn("z", -20), (1.2, 2.6, 1.1)), MIRROR, (0.1, 0.1, 0.1)),
    ("bulb", ball(0.8), affine(Z_UP, (-0.3, -0.6, 0.85)), GLASS, (1.0, 1.0, 1.0)),
]
CART = [
    ("cart", box(1.6, 0.6, 0.8), affine(move=(0.3, 0.5, 0)), MATT, (0.2, 0.6, 0.3)),
    ("wedge", (box(1, 1, 1)[0] * (1, 1, 0.3), box(1, 1, 1)[1]), affine(SHEAR, (1, 1, 0)), MATT,
     (0.3, 0.3, 0.8)),
]  # fmt: skip
CART_TURN, CART_SCALE, CART_MOVE = (90, 0, 130), (1.2, 1.0, -1.2), (1.4, 0.2, 0.1)
EYE, AT = (2.5, -8.0, 4.0), (0.0, 0.5, 0.8)
YARD_LIGHTS = [(4.0, -5.0, 6.0), (-5.0, -2.0, 5.0)]
FINISHES = {
    MATT: "illum 2\nKs 0.5 0.5 0.5\nNs 90\n",
    MIRROR: "illum 3\nKs 0.9 0.9 0.9\nNs 200\n",
    GLASS: f"illum 7\nd 0.1\nNi {GLASS_IOR}\nKs 0.1 0.1 0.1\n",
}


def yard(folder: Path) -> Room:
    """Write ``yard.yaml`` and what it names, and tell what is in it."""
    _write_obj(folder / "yard.obj", YARD)
    _write_obj(folder / "cart.obj", CART)
    lights = ", ".join(f"{{position: {list(place)}}}" for place in YARD_LIGHTS)
    cart = f"move: {list(CART_MOVE)}, turn: {list(CART_TURN)}, scale: {list(CART_SCALE)}"
    (folder / "yard.yaml").write_text(
        "# Two files in one scene, z up, seen and lit as set here.\n"
        "scene:\n"
        f"  parts: [{{mesh: yard.obj}}, {{mesh: cart.obj, {cart}}}]\n"
        "  objects: groups\n"
        "  up: z\n"
        f"  camera: {{eye: {list(EYE)}, at: {list(AT)}, angle: {ANGLE_DEGREES:g}}}\n"
        f"  lights: [{lights}]\n"
        f"picture: {{resolution: {list(SHAPE)}}}\n"
        "processors: 16\n"
    )
    put = affine(turn("xyz", CART_TURN) @ np.diag(CART_SCALE), CART_MOVE)  # type: ignore[arg-type]
    bodies = [
        body(f"0.yard/{name}_of_{name}", shape, matrix, finish, colour)
        for name, shape, matrix, finish, colour in YARD
    ]
    bodies += [
        body(f"1.cart/{name}_of_{name}", shape, put @ matrix, finish, colour)
        for name, shape, matrix, finish, colour in CART
    ]
    return Room(bodies, _looking(), ANGLE_DEGREES, YARD_LIGHTS)


def _write_obj(file: Path, bodies: list[Any]) -> None:
    """Each body a group, with a material of its own."""
    lines, library, before = [f"mtllib {file.stem}.mtl"], "", 1
    for name, (points, faces), matrix, finish, colour in bodies:
        vertices = points @ matrix[:3, :3].T + matrix[:3, 3]
        inside_out = np.linalg.det(matrix[:3, :3]) < 0
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
        lines += [f"g {name}", f"usemtl of_{name}"]
        lines += ["f " + " ".join(map(str, face)) for face in (
            (faces[:, ::-1] if inside_out else faces) + before
        ).tolist()]  # fmt: skip
        before += len(vertices)
        library += f"newmtl of_{name}\nKd {' '.join(map(str, colour))}\n{FINISHES[finish]}"
    file.write_text("\n".join(lines) + "\n")
    file.with_suffix(".mtl").write_text(library)


def _looking() -> Array:
    """The camera that stands at EYE, in glTF's way."""
    back = np.subtract(EYE, AT) / math.dist(EYE, AT)
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    return affine(np.stack([right, np.cross(back, right), back], axis=1), EYE)
