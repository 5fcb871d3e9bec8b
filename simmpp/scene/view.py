"""From where a scene is seen, and by what it is lit: what users set over what its file says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from pydantic import Field, model_validator

from simmpp.common.errors import ConfigError, SceneError
from simmpp.common.strict import Expect, Short, Strict, is_line, mistake, only, parsed_by
from simmpp.common.units import counted, shown
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.scene import Camera, Light, Scene, Vector

AXES: dict[str, Vector] = {"y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
"""What ``up`` names."""
MOST_CAMERAS = 2**31
EVERYTHING, FRAMED = "everything", "a camera that sees everything"
"""The name of what sees a mesh where its file has no camera, and what is said of it."""
A_CAMERA = "the name or number of a camera of the file"
_ANGLE = "an angle above 0 and below 180"
_OPEN = {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 180}
_THREE = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}


def is_number(value: object, least: float = -LARGEST) -> bool:
    """Is it a number to reckon with? Neither a switch nor NaN is."""
    is_real = isinstance(value, int | float) and not isinstance(value, bool)
    return is_real and least <= value <= LARGEST  # type: ignore[operator]


def three(example: str, least: float = -LARGEST) -> tuple[Any, Expect]:
    """Marks of three numbers: ``Annotated[Vector, *three("[0, 1, 0]")]``."""
    expected = f"three numbers{' from 0' if least == 0 else ''}, such as {example}"

    def parse(value: object) -> Vector:
        numbers = value if isinstance(value, list | tuple) else ()
        if len(numbers) != 3 or not all(is_number(number, least) for number in numbers):
            raise ConfigError(f"value {shown(value)}: expected {expected}")
        x, y, z = map(float, numbers)
        return x, y, z

    return parsed_by(parse), Expect(expected, _THREE)


def listed(expected: str, least: int) -> tuple[Any, Any, Expect]:
    """Marks of a list of at least so many mappings."""

    def parse(value: object) -> object:
        if not isinstance(value, list | tuple) or len(value) < least:
            raise ConfigError(f"value {shown(value)}: expected {expected}")
        return value

    return Field(min_length=least), parsed_by(parse), Expect(expected)


def _is_angle(value: object) -> bool:
    return is_number(value, 0) and 0 < value < 180  # type: ignore[operator]


def _is_name(value: object) -> bool:
    is_whole = isinstance(value, int) and not isinstance(value, bool)
    return is_line(value) or (is_whole and 0 <= value < MOST_CAMERAS)  # type: ignore[operator]


class CameraSettings(Strict):
    """A pinhole camera: one of the file, or parts of one; the rest stays as the scene has it."""

    name: Annotated[str | int, *only(_is_name, Expect(A_CAMERA))] | None = None
    """One that the file has: by its name, or by its number from 0 (`simmpp scene` lists them);
    `everything` is the one that shows all of a mesh."""
    eye: Annotated[Vector, *three("[0, 1.5, -4]")] | None = None
    """Where it stands, in the coordinates of the file."""
    at: Annotated[Vector, *three("[0, 1, 0]")] | None = None
    """What it looks at: the centre of the picture."""
    up: Annotated[Vector, *three("[0, 1, 0]")] | None = None
    """The direction that is upwards in the picture; `scene.up` when not given."""
    angle: Annotated[float, *only(_is_angle, Expect(_ANGLE, _OPEN, "degrees"))] | None = None
    """NFF's angle of view: from the upper to the lower edge of the picture (glTF's yfov). Pixels
    are squares, so the resolution decides how much is seen across."""

    @model_validator(mode="after")
    def _sees(self) -> CameraSettings:
        if self.eye is not None and self.eye == self.at:
            raise mistake(f"eye and at are both {list(self.eye)}: expected two points")
        if self.up is not None and not any(self.up):
            raise mistake("up is [0, 0, 0]: expected a direction")
        if self.eye and self.at and self.up and not Camera(self.eye, self.at, self.up).aims:
            raise mistake(f"up {list(self.up)} is along the view: expected a direction across it")
        return self


def long_camera(value: object) -> object:
    """The mapping that a name or a number is short for."""
    return {"name": value} if isinstance(value, str | int) else value


CameraKey = Annotated[
    CameraSettings, parsed_by(long_camera), Short(A_CAMERA, {"type": ["string", "integer"]})
]


class LightSettings(Strict):
    """A point light."""

    position: Annotated[Vector, *three("[0, 9, 0]")]
    """Where it is, in the coordinates of the file."""
    colour: Annotated[Vector, *three("[1, 1, 0.8]", 0.0)] = (1.0, 1.0, 1.0)
    """Red, green and blue of what it emits."""


Lights = Annotated[
    tuple[LightSettings, ...], *listed("a list such as [{position: [0, 9, 0]}]; [] for none", 0)
]


@dataclass(frozen=True)
class View:
    """What a user says of the view; None leaves it to the scene."""

    camera: CameraSettings | None = None
    lights: Sequence[LightSettings] | None = None
    up: str | None = None
    """The axis that points upwards, one of AXES."""
    background: Vector | None = None


def viewed(scene: Scene, view: View) -> Scene:
    """The scene as it is to be seen.

    Raises SceneError for a camera that the file hasn't, or that looks at itself or along ``up``.
    """
    origin, lights = scene.origin, scene.lights
    if view.lights is not None:
        lights = tuple(Light(light.position, light.colour) for light in view.lights)
        origin = replace(origin, lights=f"{counted(len(lights), 'light')} as set")
    if view.background is not None:
        scene = replace(scene, background=view.background)
    said, camera = _camera(scene, view)
    if not camera.aims and camera != scene.camera:
        eye, at, up = (shown([*map(float, point)]) for point in (camera.eye, camera.at, camera.up))
        problem = f"scene.camera: eye {eye} and at {at} are one point, or up {up} is along the view"
        raise SceneError(problem, where=scene.name)
    return replace(scene, camera=camera, lights=lights, origin=replace(origin, camera=said))


def _camera(scene: Scene, view: View) -> tuple[str, Camera]:
    """The camera, and what is said of it."""
    said, camera, own = scene.origin.camera, scene.camera, view.camera or CameraSettings()
    if own.name is not None:
        name, camera = _named(scene, own.name)
        said = of_file(name)
    changed = [key for key in ("eye", "at", "up", "angle") if getattr(own, key) is not None]
    if changed:
        said += f", {' and '.join(changed)} as set"
    if own.eye is not None and own.at is not None:
        said = "a camera as set"
    up = camera.up
    if own.eye is not None or own.at is not None:
        up = scene.origin.up or up  # seen from elsewhere, how it was held means nothing
    if view.up and own.up is None:
        up = AXES[view.up]
        said = f"{said.removesuffix(f', {view.up} up')}, {view.up} up"
    up = own.up or up
    eye, at, angle = own.eye or camera.eye, own.at or camera.at, own.angle or camera.angle_degrees
    return said, replace(camera, eye=eye, at=at, up=up, angle_degrees=float(angle))


def of_file(name: str) -> str:
    """What is said of a camera that is named."""
    return FRAMED if name == EVERYTHING else f"camera {shown(name)} of the file"


def _named(scene: Scene, wanted: str | int) -> tuple[str, Camera]:
    """A camera of the file by its name, or by its number from 0."""
    cameras = scene.origin.cameras
    if isinstance(wanted, int):
        found = list(cameras[wanted : wanted + 1])
    else:
        found = [(name, camera) for name, camera in cameras if name == wanted]
    if found:
        return found[0]
    known = ", ".join(f"{number} ({shown(name)})" for number, (name, _) in enumerate(cameras[:10]))
    problem = f"there is no camera {shown(wanted)}: expected {known or 'parts of its only one'}"
    raise SceneError(problem, where=scene.name)
