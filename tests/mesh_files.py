"""Polygons written as OBJ, PLY, STL and OFF, as plainly as each format allows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from simmpp.scene.mesh import load_mesh
from simmpp.scene.scene import Floats, Scene
from simmpp.scene.triangles import triangles

Rows = Sequence[Sequence[Any]]
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
U = [(0, 0, 0), (3, 0, 0), (3, 3, 0), (2, 3, 0), (2, 1, 0), (1, 1, 0), (1, 3, 0), (0, 3, 0)]
"""An octagon of area 7; a fan of it has 11."""
STRUCT = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def lines(rows: Rows) -> str:
    return "".join(" ".join(map(str, row)) + "\n" for row in rows)


def obj(vertices: Rows, polygons: Rows) -> bytes:
    faces = [("f", *(i + 1 for i in polygon)) for polygon in polygons]
    return (lines([("v", *v) for v in vertices]) + lines(faces)).encode()


def off(vertices: Rows, polygons: Rows) -> bytes:
    faces = [(len(polygon), *polygon) for polygon in polygons]
    return f"OFF\n{len(vertices)} {len(faces)} 0\n{lines(vertices)}{lines(faces)}".encode()


def ply_header(order: str, vertices: int, faces: int, real: str = "float") -> bytes:
    name = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    axes = "".join(f"property {real} {axis}\n" for axis in "xyz")
    return (
        f"ply\nformat {name} 1.0\nelement vertex {vertices}\n{axes}element face {faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    ).encode()


def ply(vertices: Rows, polygons: Rows, order: str = "", real: str = "float") -> bytes:
    header = ply_header(order, len(vertices), len(polygons), real)
    if not order:
        return header + (lines(vertices) + lines([(len(p), *p) for p in polygons])).encode()
    numbers = np.array(vertices, dtype=f"{order}f{4 if real == 'float' else 8}").tobytes()
    faces = [bytes([len(p)]) + np.array(p, dtype=f"{order}i4").tobytes() for p in polygons]
    return header + numbers + b"".join(faces)


def stl(corners: Any, header: bytes = b"binary", count: int | None = None) -> bytes:
    """Binary STL of triangles (n, 3, 3)."""
    facets = np.zeros(len(corners), STRUCT)
    facets["corners"] = corners
    said = len(corners) if count is None else count
    return header.ljust(80) + said.to_bytes(4, "little") + facets.tobytes()


def stl_text(corners: Any, name: str = "a") -> bytes:
    facets = "".join(
        " facet normal 0 0 0\n  outer loop\n"
        + "".join(f"   vertex {x!r} {y!r} {z!r}\n" for x, y, z in np.asarray(triangle).tolist())
        + "  endloop\n endfacet\n"
        for triangle in corners
    )
    return f"solid {name}\n{facets}endsolid {name}\n".encode()


def read(folder: Path, name: str, content: bytes, objects: object = "nodes") -> Scene:
    (folder / name).write_bytes(content)
    return load_mesh(folder / name, objects=objects)


def corners_of(scene: Scene) -> Floats:
    """All triangles, in the order of the objects: (n, 3, 3)."""
    return np.concatenate([triangles(part) for part in scene.objects])


def area(corners: Floats) -> float:
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(sides, axis=1).sum() / 2)


def facts(scene: Scene) -> tuple[int, float]:
    """Triangles and their area."""
    corners = corners_of(scene)
    return len(corners), round(area(corners), 9)
