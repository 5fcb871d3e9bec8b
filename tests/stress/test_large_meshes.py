"""Memory of large meshes, by the triangle: a copy too many of all corners takes 72 bytes more."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from gltf_files import File
from mesh_files import ply

from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.tracer import trace

SIDE = 150
"""Squares along an edge of the height field."""
N = 2 * SIDE * SIDE
READING, TRACING = 150, 450
"""Bytes a triangle at most, embree's own aside. As counted here, memory that numpy asks for and
that is never written counts as well: of a tree's nodes half."""


def height_field() -> tuple[np.ndarray, np.ndarray]:
    x = np.arange(SIDE + 1)
    vertices = np.stack([*np.meshgrid(x, x), np.sin(x)[:, None] * np.cos(x)], axis=-1)
    at = np.arange((SIDE + 1) ** 2).reshape(SIDE + 1, SIDE + 1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    return vertices.reshape(-1, 3), np.stack([a, d, c, a, c, b], axis=-1).reshape(-1, 3)


def as_ply(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    return ply(vertices.tolist(), faces.tolist(), "<")


def as_glb(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    file = File()
    attributes = {"POSITION": file.accessor(vertices)}
    indices = file.accessor(faces.ravel(), "u4")
    file.node(mesh=file.mesh({"attributes": attributes, "indices": indices}))
    return file.glb()


def peak(work: Callable[[], object]) -> float:
    """Bytes a triangle that are allocated at one time."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1] / N
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("write", [as_ply, as_glb])
def test_memory(tmp_path: Path, write: Callable[..., bytes]) -> None:
    file = tmp_path / f"a.{write.__name__[3:]}"
    file.write_bytes(write(*height_field()))
    picture = Picture(resolution=1)
    trace(load_scene(file), picture)  # imports and compiles
    scenes: list[Scene] = []
    assert peak(lambda: scenes.append(load_scene(file))) < READING
    assert peak(lambda: trace(scenes[0], picture)) < TRACING
