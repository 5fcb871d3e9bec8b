"""Matt surfaces and lamps of triangles in Mitsuba 3's path tracer: no code in common.

Mitsuba's lamps shine from their front only; what the back of a lamp lights must not be seen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.scene import Scene
from simmpp.scene.triangles import triangles


class MitsubaPaths:
    """The light of each pixel, by paths that end at the same depth."""

    def __init__(self, scene: Scene) -> None:
        import mitsuba

        mitsuba.set_variant("scalar_rgb")
        self._mitsuba, self._scene = mitsuba, scene
        parts: dict[int, list[NDArray[np.float64]]] = {}
        for item in scene.objects:
            parts.setdefault(item.material, []).append(triangles(item))
        self._shapes = {f"m{m}": self._shape(m, np.concatenate(of)) for m, of in parts.items()}

    def _shape(self, material: int, corners: NDArray[np.float64]):
        surface = self._scene.materials[material]
        properties = self._mitsuba.Properties()
        reflectance = {"type": "rgb", "value": [surface.kd * c for c in surface.colour]}
        bsdf = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}
        properties["mesh_bsdf"] = self._mitsuba.load_dict(bsdf)
        if max(surface.emission) > 0:
            radiance = {"type": "rgb", "value": list(surface.emission)}
            properties["emitter"] = self._mitsuba.load_dict({"type": "area", "radiance": radiance})
        mesh = self._mitsuba.Mesh(f"m{material}", 3 * len(corners), len(corners), props=properties)
        parameters = self._mitsuba.traverse(mesh)
        parameters["vertex_positions"] = np.ravel(corners).astype(np.float32)
        parameters["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
        parameters.update()
        return mesh

    def light(
        self, shape: tuple[int, int], samples: int, depth: int, seed: int
    ) -> NDArray[np.float64]:
        """(rows, columns, 3) of so many paths in each pixel."""
        camera, rows, columns = self._scene.camera, *shape
        look = self._mitsuba.ScalarTransform4f().look_at(
            origin=list(camera.eye), target=list(camera.at), up=list(camera.up)
        )
        film = {
            "type": "hdrfilm",
            "width": columns,
            "height": rows,
            "rfilter": {"type": "box"},
            "component_format": "float32",
        }
        sensor = {
            "type": "perspective",
            "fov": camera.angle_degrees,
            "fov_axis": "y",
            "to_world": look,
            "film": film,
        }
        sky = {"type": "rgb", "value": list(self._scene.background)}
        around = {"sky": {"type": "constant", "radiance": sky}} if max(sky["value"]) > 0 else {}
        scene = self._mitsuba.load_dict(
            {"type": "scene", "sensor": sensor, **around, **self._shapes}
        )
        integrator = self._mitsuba.load_dict({"type": "path", "max_depth": depth})
        image = self._mitsuba.render(scene, integrator=integrator, seed=seed, spp=samples)
        light = np.array(image, np.float64)[:, :, :3]
        return light
