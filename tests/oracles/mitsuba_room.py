"""A room in Mitsuba 3: its own camera, its own surfaces, its own mirrored and refracted rays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rooms import GLASS, GLASS_IOR, MIRROR, SHAPE, Array, Body, Room

from simmpp.scene.scene import SKY_BLUE, MeshPart, Scene
from simmpp.workload.picture import Picture
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import PRIMARY, REFLECTED, REFRACTED, Workload

CLOSEST = 1.0 - 1e-6
"""The random number that glass takes for "refract", however little it reflects."""
FLIP = np.diag([-1.0, 1.0, -1.0, 1.0])
"""Mitsuba's cameras look along z, with x to the left."""


class MitsubaRoom:
    """Which bodies the rays of a picture meet, and the picture."""

    def __init__(self, room: Room) -> None:
        import mitsuba

        mitsuba.set_variant("scalar_rgb")
        self._mitsuba, self._room = mitsuba, room
        with TemporaryDirectory() as folder:
            shapes = {
                f"body{number}": self._shape(body, Path(folder) / f"{number}.ply")
                for number, body in enumerate(room.bodies)
            }
            self._scene = mitsuba.load_dict(
                {"type": "scene", "sensor": self._sensor(), **shapes, **self._lights()}
            )

    def _shape(self, body: Body, file: Path) -> dict[str, Any]:
        mesh = self._mitsuba.Mesh(body.name, len(body.vertices), len(body.faces))
        parameters = self._mitsuba.traverse(mesh)
        parameters["vertex_positions"] = np.ravel(body.vertices).astype(np.float32)
        parameters["faces"] = np.ravel(body.faces).astype(np.uint32)
        parameters.update()
        mesh.write_ply(str(file))
        surface = {
            MIRROR: {"type": "conductor"},
            GLASS: {"type": "dielectric", "int_ior": GLASS_IOR, "ext_ior": 1.0},
        }
        reflectance = {"type": "rgb", "value": list(body.colour)}
        matt = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}
        bsdf = surface.get(body.finish, matt)
        return {"type": "ply", "filename": str(file), "face_normals": True, "bsdf": bsdf}

    def _sensor(self) -> dict[str, Any]:
        columns, rows = SHAPE
        return {
            "type": "perspective",
            "fov": self._room.angle_degrees,
            "fov_axis": "y",
            "to_world": self._mitsuba.ScalarTransform4f(self._room.to_world @ FLIP),
            "film": {
                "type": "hdrfilm",
                "width": columns,
                "height": rows,
                "rfilter": {"type": "box"},
            },
        }

    def _lights(self) -> dict[str, Any]:
        """As bright at the middle of the room as those that do not fade."""
        sky = {"type": "rgb", "value": list(SKY_BLUE)}
        lights: dict[str, Any] = {"sky": {"type": "constant", "radiance": sky}}
        for number, place in enumerate(self._room.lights):
            bright = {"type": "rgb", "value": [float(np.dot(place, place))] * 3}
            lights[f"light{number}"] = {
                "type": "point",
                "position": list(place),
                "intensity": bright,
            }
        return lights

    def names(self) -> tuple[Array, Array, Array]:
        """What each pixel's primary ray meets, and its mirrored and its refracted ray.

        Three arrays (rows, columns) of names, "" for nothing; None where there is no such ray.
        """
        columns, rows = SHAPE
        found = np.full((3, rows, columns), None, dtype=object)
        for row in range(rows):
            for column in range(columns):
                place = [(column + 0.5) / columns, (row + 0.5) / rows]
                found[:, row, column] = self._of_pixel(place)
        return found[0], found[1], found[2]

    def _of_pixel(self, place: list[float]) -> tuple[Any, Any, Any]:
        ray, _ = self._scene.sensors()[0].sample_ray(0.0, 0.5, place, [0.5, 0.5])
        met = self._scene.ray_intersect(ray)
        if not met.is_valid():
            return "", None, None
        finish = self._room.bodies[int(met.shape.id().removeprefix("body"))].finish
        mirrored = self._next(met, 0.0) if finish in (MIRROR, GLASS) else None
        return self._name(met), mirrored, self._next(met, CLOSEST) if finish == GLASS else None

    def _next(self, met: Any, choice: float) -> str:
        context = self._mitsuba.BSDFContext()
        sample, _ = met.bsdf().sample(context, met, choice, [0.5, 0.5])
        return self._name(self._scene.ray_intersect(met.spawn_ray(met.to_world(sample.wo))))

    def _name(self, met: Any) -> str:
        if not met.is_valid():
            return ""
        return self._room.bodies[int(met.shape.id().removeprefix("body"))].name

    def render(self, samples: int) -> np.ndarray:
        """(rows, columns, 3) uint8, of as many paths in each pixel."""
        integrator = self._mitsuba.load_dict({"type": "path", "max_depth": 8})
        image = self._mitsuba.render(self._scene, integrator=integrator, seed=0, spp=samples)
        linear = self._mitsuba.Bitmap(image)
        return np.array(
            linear.convert(
                self._mitsuba.Bitmap.PixelFormat.RGB,
                self._mitsuba.Struct.Type.UInt8,
                srgb_gamma=False,
            )
        )


@dataclass(frozen=True)
class Agreement:
    """Rays of one kind: how many there are, and how many meet the same body in both renderers."""

    rays: int
    same: int

    @property
    def share(self) -> float:
        return self.same / self.rays


def compare(scene: Scene, theirs: MitsubaRoom) -> dict[str, Agreement]:
    """Primary rays, and the mirrored and the refracted ones of those that meet the same body."""
    workload = trace(scene, Picture(resolution=SHAPE, max_depth=2, shadows=False))
    ours = {kind: _names(scene, workload, kind) for kind in (PRIMARY, REFLECTED, REFRACTED)}
    primary, mirrored, refracted = theirs.names()
    same = ours[PRIMARY] == primary
    found = {"primary": Agreement(same.size, int(same.sum()))}
    for name, kind, met in (("mirrored", REFLECTED, mirrored), ("refracted", REFRACTED, refracted)):
        # One that only one of the renderers has counts as a difference.
        rays = same & ~(np.equal(ours[kind], None) & np.equal(met, None))
        found[name] = Agreement(int(rays.sum()), int((ours[kind] == met)[rays].sum()))
    return found


def _names(scene: Scene, workload: Workload, kind: int) -> Array:
    """What the ray of that kind meets in each pixel, (rows, columns), None where there is none."""
    names = [part.name for part in scene.objects if isinstance(part, MeshPart)]
    rays = np.flatnonzero(workload.kinds == kind)
    met = np.full(workload.n_primaries, None, dtype=object)
    met[workload.pixels[rays]] = np.array([*names, ""], dtype=object)[workload.hits[rays]]
    return met.reshape(workload.picture)
