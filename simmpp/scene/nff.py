"""Reading and writing scenes in NFF, the Neutral File Format of the SPD (Haines 1987).

An NFF file is a stream of words; line breaks carry no meaning, ``#`` starts a comment. Opaque
objects are visible from outside; a negative radius, "visible from inside" in NFF, is read as its
absolute value.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import NoReturn

from simmpp.common.garbage import uncollected
from simmpp.scene.nff_objects import cones, patches, polygons, spheres
from simmpp.scene.nff_text import EXACT
from simmpp.scene.nff_words import Words
from simmpp.scene.packed import name_of, read_whole
from simmpp.scene.scene import (
    Camera,
    Cone,
    Light,
    Material,
    MeshPart,
    Polygon,
    Scene,
    SceneObject,
    Sphere,
    Vector,
)

MAX_RESOLUTION = 65536
WHITE: Vector = (1.0, 1.0, 1.0)


def load_nff(file: str | PathLike[str]) -> Scene:
    """The scene of an NFF file, plain or packed by gzip, called as the file is.

    Raises SceneError for one that can't be read.
    """
    path = Path(file)
    data = read_whole(path)
    # Comments may hold anything; the words are checked to be ASCII.
    text = data.decode("utf-8-sig", errors="replace")
    return read_nff(text, name=name_of(path), where=str(path))


@uncollected()
def read_nff(text: str, *, name: str, where: str) -> Scene:
    """The scene of an NFF text.

    ``where`` is the file that errors name. Raises SceneError, with the line, for anything that is
    not NFF or that no renderer could use; polygons without area are kept, they can't be hit.
    """
    return _Reader(Words(text, where)).scene(name)


class _Reader:
    """What has been read so far, one method per NFF keyword."""

    def __init__(self, words: Words) -> None:
        self.words = words
        self.camera: Camera | None = None
        self.background: Vector | None = None
        self.lights: list[Light] = []
        self.objects: list[SceneObject] = []
        self.materials: dict[Material, int] = {}
        self.material = -1
        self.read: dict[str, Callable[[], None]] = {
            "v": self._view,
            "b": self._background,
            "l": self._light,
            "f": self._material,
            "s": partial(self._objects, spheres),
            "c": partial(self._objects, cones),
            "p": partial(self._objects, polygons),
            "pp": partial(self._objects, patches),
        }

    def scene(self, name: str) -> Scene:
        words = self.words
        while words.left:
            keyword = words.word()
            read = self.read.get(keyword)
            if read is None:
                keywords = ", ".join(self.read)
                words.fail(f"expected a keyword ({keywords}), got {words.shown(keyword)}")
            read()
        if self.camera is None:
            words.fail("no view: an NFF file needs one 'v'", at_end=True)
        return Scene(
            name=name,
            objects=tuple(self.objects),
            materials=tuple(self.materials),
            lights=tuple(self.lights),
            camera=self.camera,
            background=self.background or (0.0, 0.0, 0.0),
        )

    def _view(self) -> None:
        if self.camera is not None:
            self._fail("a second view: an NFF file has one 'v'")
        words = self.words
        eye = words.vector("the eye", keyword="from")
        at = words.vector("the point looked at", keyword="at")
        up = words.vector("the up vector", keyword="up")
        words.expect("angle")
        angle = words.number("the angle of view")
        if not 0 < angle < 180:
            self._fail(f"the angle of view must be between 0 and 180 degrees, got {angle:g}")
        hither, resolution = 0.0, (512, 512)
        if words.skip("hither"):
            hither = words.number("the hither distance")
            if hither < 0:
                self._fail(f"the hither distance must not be negative, got {hither:g}")
        if words.skip("resolution"):
            side = partial(words.count, "the resolution", 1, MAX_RESOLUTION)
            resolution = side(), side()
        self.camera = Camera(eye, at, up, angle, hither, resolution)
        if not self.camera.aims:
            self._fail("the view needs a direction ('from' is not 'at') and an 'up' not along it")

    def _background(self) -> None:
        if self.background is not None:
            self._fail("a second background: an NFF file has one 'b'")
        self.background = self._colour("the background colour")

    def _light(self) -> None:
        position = self.words.vector("the position of a light")
        has_colour = self.words.next_is_number()
        colour = self._colour("the colour of a light") if has_colour else WHITE
        self.lights.append(Light(position, colour))

    def _material(self) -> None:
        colour = self._colour("the colour of a surface")
        kd, ks, shine, transmittance, ior = self.words.numbers(
            5, "Kd, Ks, shine, T and index of refraction of a surface"
        )
        if min(kd, ks, shine, transmittance, ior) < 0:
            self._fail("Kd, Ks, shine, T and index of refraction must not be negative")
        if transmittance > 1:
            self._fail(f"the transmittance must be at most 1, got {transmittance:g}")
        if transmittance > 0 and ior == 0:
            self._fail("a transmitting surface needs an index of refraction above 0")
        material = Material(colour, kd, ks, shine, transmittance, ior)
        self.material = self.materials.setdefault(material, len(self.materials))

    def _objects(self, read: Callable[[Words, int], Sequence[SceneObject]]) -> None:
        if self.material < 0:  # before the first ``f``
            self.material = self.materials.setdefault(Material(), len(self.materials))
        self.objects += read(self.words, self.material)

    def _colour(self, what: str) -> Vector:
        colour = self.words.vector(what)
        if min(colour) < 0:
            self._fail(f"{what} must not be negative, got {colour}")
        return colour

    def _fail(self, problem: str) -> NoReturn:
        self.words.fail(problem)


def write_nff(scene: Scene) -> str:
    """The scene as NFF text that reads back as the same geometry, to the last bit.

    Meshes are written triangle by triangle. An ``f`` line is written where the material changes, as
    the SPD's generators do; that something shines NFF has no word for. Raises SceneError for a
    scene that NFF can't hold.
    """
    # Fields of a camera and a material are called as the writers of their lines call them.
    parts = [EXACT.background(scene.background), EXACT.view(**vars(scene.camera))]
    parts += [
        EXACT.light(light.position, () if light.colour == WHITE else light.colour)
        for light in scene.lights
    ]
    current = -1
    for obj in scene.objects:
        if obj.material != current:
            current = obj.material
            fields = dict(vars(scene.materials[current]))
            del fields["emission"]
            parts.append(EXACT.material(**fields))
        parts.append(_object_lines(obj))
    return "".join(parts)


def _object_lines(obj: SceneObject) -> str:
    match obj:
        case Sphere():
            return EXACT.sphere(obj.centre, obj.radius)
        case Cone():
            return EXACT.cone(obj.base, obj.base_radius, obj.apex, obj.apex_radius)
        case Polygon():
            vertices = obj.vertices.tolist()
            if obj.normals is None:
                return EXACT.polygon(vertices)
            return EXACT.patch(vertices, obj.normals.tolist())
        case MeshPart():
            corners = obj.vertices[obj.faces].tolist()
            return "".join(EXACT.polygon(triangle) for triangle in corners)
