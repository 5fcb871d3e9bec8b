"""What a renderer is given: objects with materials, lights, a camera.

An *object* is the unit of data of the whole study: what one processing element owns, asks for and
sends. It is an NFF primitive (sphere, cone or cylinder, polygon) or a part of a mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from simmpp.common.documented import documented
from simmpp.common.files import in_utf8

Vector = tuple[float, float, float]
Floats = NDArray[np.float64]
SKY_BLUE: Vector = (0.078, 0.361, 0.753)
"""Background of most SPD scenes, "UNC sky blue"."""


@documented
@dataclass(frozen=True)
class Material:
    """Surface of an object, as NFF's ``f`` line gives it (Haines 1987)."""

    colour: Vector = (0.75, 0.75, 0.75)
    """Red, green and blue of what it reflects, from 0 to 1."""
    kd: float = 1.0
    """Diffuse share."""
    ks: float = 0.0
    """Specular share; a surface with ks > 0 reflects."""
    shine: float = 1.0
    """Phong's cosine power."""
    transmittance: float = 0.0
    """Share of the light that passes; a surface with more than 0 refracts."""
    ior: float = 1.0
    """Index of refraction; only read where transmittance > 0."""
    emission: Vector = (0.0, 0.0, 0.0)
    """Red, green and blue of what it shines by itself, to both sides; only paths see it."""

    @property
    def reflects(self) -> bool:
        """A hit spawns a reflected ray: the SPD's rule, transmitters reflect too."""
        return self.ks > 0 or self.transmittance > 0

    @property
    def transmits(self) -> bool:
        """A hit spawns a refracted ray."""
        return self.transmittance > 0


@documented
@dataclass(frozen=True)
class Light:
    """A point light."""

    position: Vector
    """Where it is, in scene units."""
    colour: Vector = (1.0, 1.0, 1.0)
    """Red, green and blue of what it emits."""


@documented
@dataclass(frozen=True)
class Camera:
    """A pinhole camera, as NFF's ``v`` lines give it."""

    eye: Vector
    """Where it stands."""
    at: Vector
    """What it looks at, the centre of the picture."""
    up: Vector = (0.0, 0.0, 1.0)
    """The direction that is upwards in the picture."""
    angle_degrees: float = 45.0
    """Full field of view from the upper to the lower edge of the picture; pixels are squares."""
    hither: float = 0.0
    """Near plane of hidden-surface programs; a ray tracer ignores it."""
    resolution: tuple[int, int] = (512, 512)
    """Columns and rows that the file asks for; ``Picture`` decides what is traced."""

    @property
    def aims(self) -> bool:
        """It looks somewhere, and ``up`` is not along that."""
        towards, upwards = _scaled(np.subtract(self.at, self.eye)), _scaled(np.array(self.up))
        sideways = np.linalg.norm(np.cross(towards, upwards))
        # What overflowed to NaN is no direction either.
        return bool(sideways > 1e-12 * np.linalg.norm(towards) * np.linalg.norm(upwards))


def _scaled(vector: Floats) -> Floats:
    """The vector with 1 as its largest number, so that squares are neither 0 nor infinite."""
    largest = np.abs(vector).max()
    return vector / largest if largest > 0 else vector


@dataclass(frozen=True)
class Origin:
    """Where the view of a scene comes from, and what its file says that was not read."""

    camera: str = "its own camera"
    lights: str = "its own lights"
    cameras: tuple[tuple[str, Camera], ...] = ()
    """Those that can be asked for, with their names."""
    up: Vector | None = None
    """What is upwards in its coordinates, if that is known."""
    notes: tuple[str, ...] = ()
    """What the file says that was not read, one line each."""

    @property
    def view(self) -> str:
        """In words."""
        return f"seen by {self.camera}, lit by {self.lights}"


@dataclass(frozen=True, eq=False)
class Sphere:
    """A sphere; the wire carries its equation, never triangles."""

    kind: ClassVar[str] = "sphere"
    centre: Vector
    radius: float
    material: int = 0


@dataclass(frozen=True, eq=False)
class Cone:
    """An open cylinder or truncated cone, without end caps."""

    kind: ClassVar[str] = "cone"
    base: Vector
    base_radius: float
    apex: Vector
    apex_radius: float
    material: int = 0


@dataclass(frozen=True, eq=False)
class Polygon:
    """A planar polygon of any number of vertices, convex or concave."""

    kind: ClassVar[str] = "polygon"
    vertices: Floats
    """(n, 3) float64, counter-clockwise seen from the outside."""
    normals: Floats | None = None
    """(n, 3) float64, one per vertex for smooth shading, or None."""
    material: int = 0


@dataclass(frozen=True, eq=False)
class MeshPart:
    """A part of a triangle mesh: a scene node, a connected component or a cluster."""

    kind: ClassVar[str] = "mesh"
    vertices: Floats
    """(n, 3) float64."""
    faces: NDArray[np.int32]
    """(m, 3) int32 into ``vertices``."""
    material: int = 0
    name: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", in_utf8(self.name))


SceneObject = Sphere | Cone | Polygon | MeshPart


@documented
@dataclass(frozen=True, eq=False)
class Scene:
    """Objects, their materials, lights and a camera; the order of objects is their id.

    Its name, as those of objects, is text that can be written, whatever the file's name is.
    """

    name: str
    """Label in tables, e.g. ``mountain:5``."""
    objects: tuple[SceneObject, ...]
    """Spheres, cones, polygons and parts of meshes."""
    materials: tuple[Material, ...]
    """``object.material`` indexes this tuple."""
    lights: tuple[Light, ...]
    """Each gets a shadow ray from every hit whose surface faces it."""
    camera: Camera
    """From where the picture is taken."""
    background: Vector = (0.0, 0.0, 0.0)
    """Colour of rays that hit nothing."""
    origin: Origin = Origin()
    """Where camera and lights come from."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", in_utf8(self.name))
