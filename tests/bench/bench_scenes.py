"""What large scenes cost: python tests/bench/bench_scenes.py [MILLIONS OF TRIANGLES | spheres ...]

Binary PLY and GLB of a height field of so many triangles, and NFF of 66,000 spheres (1 and spheres
if nothing is given), are read and traced with 512 x 512 primary rays, each in a process of its own.
Seconds of CPU and memory at the peak are those beyond a cube of 12 triangles, or one sphere; beside
them stands what embree needs for a scene of the same triangles, by itself. Asserts nothing. 16
million take 6 GB.
"""

from __future__ import annotations

import json
import resource
import struct
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

SPHERES = 66_000
REPEATS = 3
"""1 of what takes long."""
HEADER = """ply
format binary_little_endian 1.0
element vertex {}
property float x
property float y
property float z
element face {}
property list uchar int vertex_indices
end_header
"""
VIEW = "v\nfrom 3 3 3\nat 0 0 0\nup 0 0 1\nangle 45\nhither 1\nresolution 512 512\nl 5 5 5\n"
Vertices, Faces = NDArray[np.float32], NDArray[np.int32]


class Cost(NamedTuple):
    """Of a process, or of what it does beyond another."""

    seconds: float
    """Of its CPU, all threads."""
    peak_bytes: float

    def beyond(self, other: Cost) -> Cost:
        return Cost(self.seconds - other.seconds, self.peak_bytes - other.peak_bytes)


# --- in a child ---


def spent() -> Cost:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return Cost(usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss)


def trace(file: str, resolution: int) -> Cost:
    """Of reading a scene and tracing its primary rays; compiled code is there already."""
    from simmpp.workload.picture import Picture
    from simmpp.workload.sources import load_scene
    from simmpp.workload.trace.tracer import trace

    picture = Picture(
        resolution=resolution, max_depth=1, shadows=False, reflection=False, refraction=False
    )
    trace(load_scene(file), picture)
    return spent()


def build(folder: str, *_: object) -> Cost:
    """Of embree's scene alone."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    vertices, faces = (np.load(f"{folder}/{name}.npy") for name in ("vertices", "faces"))
    before = spent()
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, vertices, faces)
    scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))
    return spent().beyond(before)


# --- in the parent ---


def least(work: str, file: Path, resolution: int = 512, repeats: int = REPEATS) -> Cost:
    """The least of some children that do the same: others use the machine, too."""
    command = [sys.executable, __file__, f"--{work}", str(file), str(resolution)]
    costs = [
        Cost(*json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout))
        for _ in range(repeats)
    ]
    return Cost(min(cost.seconds for cost in costs), min(cost.peak_bytes for cost in costs))


def height_field(millions: float) -> tuple[Vertices, Faces]:
    side = round((millions * 1e6 / 2) ** 0.5) + 1
    x = np.linspace(-1, 1, side, dtype=np.float32)
    vertices = np.empty((side, side, 3), np.float32)
    vertices[..., 0], vertices[..., 2] = x[:, None], x
    noise = np.random.default_rng(0).random((side, side), np.float32) / side
    vertices[..., 1] = 0.1 * np.sin(9 * x)[:, None] * np.cos(7 * x) + noise
    at = np.arange(side * side, dtype=np.int32).reshape(side, side)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    return vertices.reshape(-1, 3), np.stack([a, d, c, a, c, b], axis=-1).reshape(-1, 3)


def cube() -> tuple[Vertices, Faces]:
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]
    return np.array(corners, np.float32), np.array(faces, np.int32)


def write_ply(file: Path, vertices: Vertices, faces: Faces) -> None:
    rows = np.empty(len(faces), np.dtype([("n", "u1"), ("corners", "<i4", 3)]))
    rows["n"], rows["corners"] = 3, faces
    with file.open("wb") as out:
        out.write(HEADER.format(len(vertices), len(faces)).encode())
        out.write(vertices.data)
        out.write(rows.data)


def write_glb(file: Path, vertices: Vertices, faces: Faces) -> None:
    length = faces.nbytes + vertices.nbytes
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": faces.nbytes},
        {"buffer": 0, "byteOffset": faces.nbytes, "byteLength": vertices.nbytes},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5125, "count": faces.size, "type": "SCALAR"},
        {"bufferView": 1, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
    ]
    content = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
        "buffers": [{"byteLength": length}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    with file.open("wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + length))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", length, b"BIN\0"))
        out.write(faces.data)
        out.write(vertices.data)


def write_spheres(file: Path, n: int) -> None:
    numbers = np.random.default_rng(1).uniform((-1, -1, -1, 0.005), (1, 1, 1, 0.02), (n, 4))
    with file.open("w") as out:
        out.write(VIEW + "".join(f"s {x:g} {y:g} {z:g} {r:g}\n" for x, y, z, r in numbers.tolist()))


WRITERS = {"ply": write_ply, "glb": write_glb}


def meshes(folder: Path, millions: list[float]) -> None:
    for name, write in WRITERS.items():
        write(folder / f"cube.{name}", *cube())
        least("trace", folder / f"cube.{name}")  # compiles
    for size in millions:
        vertices, faces = height_field(size)
        for name, array in (("vertices", vertices), ("faces", faces)):
            np.save(folder / name, array)
        for name, write in WRITERS.items():
            write(folder / f"large.{name}", vertices, faces)
        n = len(faces)
        del vertices, faces  # children need the room
        repeats = REPEATS if size < 2 else 1
        embree = least("build", folder, repeats=repeats)
        for name in WRITERS:
            ours = least("trace", folder / f"large.{name}", repeats=repeats)
            ours = ours.beyond(least("trace", folder / f"cube.{name}"))
            more = (ours.seconds - embree.seconds) / n * 1e6
            print(
                f"{name} of {n} triangles: {ours.seconds:.2f} s, embree {embree.seconds:.2f} s"
                f" and {more:.2f} s per million more; {ours.peak_bytes / n:.0f} bytes a triangle,"
                f" embree {embree.peak_bytes / n:.0f}",
                flush=True,
            )


def spheres(folder: Path) -> None:
    write_spheres(folder / "one.nff", 1)
    write_spheres(folder / "many.nff", SPHERES)
    for resolution in (1, 512):
        costs = [least("trace", folder / f"{name}.nff", resolution) for name in ("many", "one")]
        seconds, peak_bytes = costs[0].beyond(costs[1])
        print(
            f"nff of {SPHERES} spheres, {resolution} x {resolution} rays: {seconds:.2f} s,"
            f" {seconds / SPHERES * 1e6:.1f} us and {peak_bytes / SPHERES:.0f} bytes a sphere",
            flush=True,
        )


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        words = sys.argv[1:] or ["1", "spheres"]
        meshes(Path(name), [float(word) for word in words if word != "spheres"])
        if "spheres" in words:
            spheres(Path(name))


if __name__ == "__main__":
    CHILDREN = {"--trace": trace, "--build": build}
    if sys.argv[1:] and sys.argv[1] in CHILDREN:
        print(json.dumps(CHILDREN[sys.argv[1]](sys.argv[2], int(sys.argv[3]))))
    else:
        main()
