"""A scene in Mitsuba 3 (scalar, float32), in the tracer's normalised frame: no code in common.

Spheres and cylinders are Mitsuba's own equations, triangles its bundled Embree 3's. Polygons are
cut into the triangles that the tracer has too. Truncated cones Mitsuba has not.
"""

from __future__ import annotations

import numpy as np

from simmpp.scene.scene import Cone, Scene, Sphere
from simmpp.scene.triangles import triangles
from simmpp.workload.trace.frame import Frame

TRIANGLES = "triangles"


class MitsubaScene:
    """Nearest hits and occlusion, one ray at a time."""

    def __init__(self, scene: Scene, frame: Frame) -> None:
        import mitsuba

        mitsuba.set_variant("scalar_rgb")
        self._mitsuba = mitsuba
        parts = [triangles(item) for item in scene.objects]
        self._objects = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
        """(triangles,) int64: the object of each triangle."""
        shapes = {f"o{i}": _round(item, frame) for i, item in enumerate(scene.objects)}
        shapes = {name: shape for name, shape in shapes.items() if shape}
        if len(self._objects):
            shapes[TRIANGLES] = self._mesh(frame.points(np.concatenate(parts)))
        self._scene = mitsuba.load_dict({"type": "scene", **shapes})

    def _mesh(self, corners: np.ndarray):
        mesh = self._mitsuba.Mesh(TRIANGLES, 3 * len(corners), len(corners))
        parameters = self._mitsuba.traverse(mesh)
        parameters["vertex_positions"] = np.ravel(corners).astype(np.float32)
        parameters["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
        parameters.update()
        return mesh

    def nearest(self, origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Objects hit (n,), -1 for none, and distances (n,), infinity for none."""
        hits, distances = np.full(len(origins), -1), np.full(len(origins), np.inf)
        for i, (origin, direction) in enumerate(
            zip(origins.tolist(), directions.tolist(), strict=True)
        ):
            found = self._scene.ray_intersect_preliminary(self._mitsuba.Ray3f(origin, direction))
            if found.is_valid():
                name = found.shape.id()
                is_triangle = name == TRIANGLES
                hits[i] = self._objects[found.prim_index] if is_triangle else int(name[1:])
                distances[i] = found.t
        return hits, distances

    def blocked(
        self, origins: np.ndarray, directions: np.ndarray, lights: np.ndarray
    ) -> np.ndarray:
        """Does anything lie before the light? (n,) bool."""
        rays = zip(origins.tolist(), directions.tolist(), lights.tolist(), strict=True)
        ray = self._mitsuba.Ray3f
        return np.array(
            [self._scene.ray_test(ray(o, d, light, 0.0, [])) for o, d, light in rays], bool
        )


def _round(item: object, frame: Frame) -> dict[str, object] | None:
    """A sphere or an open cylinder, seen from both sides."""
    if isinstance(item, Sphere):
        centre = frame.points(np.array(item.centre)).tolist()
        return {"type": "sphere", "center": centre, "radius": item.radius * frame.scale}
    if isinstance(item, Cone):
        if item.base_radius != item.apex_radius:
            raise ValueError("Mitsuba has no truncated cones")
        base, apex = (frame.points(np.array(end)).tolist() for end in (item.base, item.apex))
        return {
            "type": "cylinder",
            "p0": base,
            "p1": apex,
            "radius": item.base_radius * frame.scale,
        }
    return None
