"""Meshes: any triangle mesh that trimesh reads, cut into objects.

Colours come from the file: the base colour of a material, or the mean of vertex or face colours;
textures are not read. A material reflects if it is clearly a mirror, metallic >= 0.9 and
roughness <= 0.3; everything is opaque. Camera and lights of the file are not read either.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.common.files import refuse_special
from simmpp.scene.boxes import scene_box
from simmpp.scene.cut import Cut, compacted, cut_named, welded
from simmpp.scene.framing import framing
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.node import Node
from simmpp.scene.scene import SKY_BLUE, Floats, Material, MeshPart, Scene, Vector

Y_UP: Vector = (0.0, 1.0, 0.0)
Z_UP: Vector = (0.0, 0.0, 1.0)
Z_UP_FORMATS = (".stl",)
"""Formats of construction, where z points up; in the others (glTF by its standard) y does."""
LEAST_METALLIC, MOST_ROUGHNESS = 0.9, 0.3
MIRROR = 0.5
"""Kd and Ks of a mirror: those of the SPD's balls."""


@np.errstate(over="ignore", invalid="ignore")  # what is not finite is refused here, in words
def load_mesh(path: str | PathLike[str], *, objects: object = "components") -> Scene:
    """The scene of a mesh file, cut into objects.

    ``objects`` is ``nodes``, ``components`` or ``{clusters: k}`` (at most k triangles each); a cut
    never joins two nodes. Nodes are ordered by name, components by their first triangle, clusters
    by bisection. The camera shows everything. Raises SceneError for a file that can't be read, or
    that holds no triangle, or a vertex that is not finite.
    """
    file = Path(fspath(path))
    label, cut = cut_named(objects)
    materials: dict[Material, int] = {}
    parts: list[MeshPart] = []
    for node in _nodes(file):
        material = materials.setdefault(node.material, len(materials))
        parts.extend(_parts(node, cut, material))
    if not parts:
        raise SceneError("no triangles", where=str(file))
    bounds = scene_box(parts)
    if not np.any(bounds[1] > bounds[0]):
        raise SceneError("all vertices are the same point", where=str(file))
    up = Z_UP if file.suffix.lower() in Z_UP_FORMATS else Y_UP
    camera, lights = framing(bounds, up=up)
    name = f"{file.name}:{label}"
    return Scene(name, tuple(parts), tuple(materials), lights, camera, SKY_BLUE)


def _parts(node: Node, cut: Cut, material: int) -> Iterator[MeshPart]:
    vertices, faces = welded(node.vertices, node.faces)
    pieces = compacted(vertices, faces, cut(vertices, faces))
    for i, piece in enumerate(pieces):
        name = node.name if len(pieces) == 1 else f"{node.name}/{i}"
        yield MeshPart(*piece, material, name)


def _nodes(file: Path) -> Iterator[Node]:
    """The meshes of a file, by the name of their node."""
    scene = _read(file)
    for name in sorted(scene.graph.nodes_geometry):
        matrix, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        faces = np.asarray(getattr(mesh, "faces", ()), dtype=np.int64).reshape(-1, 3)
        if not len(faces):
            continue
        vertices = np.asarray(mesh.vertices, dtype=np.float64)
        if faces.min() < 0 or faces.max() >= len(vertices):
            problem = f"a face of {name!r} names a vertex that is not there"
            raise SceneError(problem, where=str(file))
        vertices = _placed(vertices, np.asarray(matrix, dtype=np.float64))
        if not np.all(np.abs(vertices[faces]) <= LARGEST):
            problem = f"a vertex of {name!r} is not a finite number of at most {LARGEST:g}"
            raise SceneError(problem, where=str(file))
        if np.linalg.det(matrix[:3, :3]) < 0:  # a mirrored copy would be inside out
            faces = faces[:, ::-1]
        yield Node(str(name), vertices, faces, _material(mesh))


def _read(file: Path) -> Any:
    """trimesh's scene of the file, as it is stored: nothing merged, nothing removed."""
    # Slow to import; NFF scenes don't need it.
    import trimesh
    from trimesh.exchange.load import mesh_formats

    kind = file.suffix.lower().lstrip(".")
    try:
        refuse_special(file)
        with file.open("rb") as opened:
            opened.read(1)  # a folder, or a file that may not be read, is told by its own error
        if kind not in mesh_formats():
            formats = ", ".join(sorted(mesh_formats()))
            problem = f"neither NFF (.nff) nor a mesh that trimesh reads ({formats})"
            raise SceneError(problem, where=str(file))
        options = {"split_objects": True} if kind == "obj" else {}  # others know no such option
        return trimesh.load_scene(str(file), process=False, **options)
    except SceneError:
        raise
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise SceneError(f"can't read the file: {reason}", where=str(file)) from None
    except ImportError as error:  # for damaged text, too: it looks for a guesser of encodings
        problem = f"not a readable {kind} mesh: damaged, or it needs {error.name} to be read"
        raise SceneError(problem, where=str(file)) from None
    except Exception as error:  # its readers raise whatever their parsers do
        reason = (str(error).strip().splitlines() or [""])[0][:200] or type(error).__name__
        raise SceneError(f"not a readable {kind} mesh: {reason}", where=str(file)) from None


def _placed(vertices: Floats, matrix: Floats) -> Floats:
    """Vertices under an affine matrix; sums in a fixed order, which BLAS does not promise."""
    x, y, z = vertices.T
    rows = [m[0] * x + m[1] * y + m[2] * z + m[3] for m in matrix[:3]]
    return np.stack(rows, axis=1)


def _material(mesh: Any) -> Material:
    """What the file says of a mesh's surface; grey and matt if it says nothing."""
    visual = mesh.visual
    kind = getattr(visual, "kind", None)
    if kind in ("vertex", "face"):
        rows = visual.vertex_colors if kind == "vertex" else visual.face_colors
        return Material(_colour(np.asarray(rows, dtype=np.float64).mean(axis=0)))
    surface = getattr(visual, "material", None)
    if kind != "texture" or surface is None:
        return Material()
    base = getattr(surface, "baseColorFactor", None)
    if base is None:
        base = getattr(surface, "diffuse", None)
    colour = Material().colour if base is None else _colour(np.asarray(base, dtype=np.float64))
    roughness = getattr(surface, "roughnessFactor", None)
    metallic = getattr(surface, "metallicFactor", None)
    metallic = 1.0 if metallic is None else metallic  # glTF's default, as roughness 1 is
    if roughness is not None and metallic >= LEAST_METALLIC and roughness <= MOST_ROUGHNESS:
        return Material(colour, kd=MIRROR, ks=MIRROR)
    return Material(colour)


def _colour(rgba: Floats) -> Vector:
    """A colour of 0 ... 255 as 0 ... 1; not finite counts as black."""
    values = [float(value) / 255 for value in rgba.ravel()[:3]]
    red, green, blue = (min(max(v, 0.0), 1.0) if math.isfinite(v) else 0.0 for v in values)
    return red, green, blue
