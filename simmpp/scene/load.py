"""From what a user names - a generator, an NFF file, a mesh - to a scene."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

from simmpp.common.errors import ConfigError, SceneError
from simmpp.common.files import refuse_special
from simmpp.scene.mesh import load_mesh
from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Scene
from simmpp.scene.spd import generators

KEYS = {"spd": {"spd", "size"}, "nff": {"nff"}, "mesh": {"mesh", "objects"}}
"""What a scene mapping starts from, and the keys it may then have."""


def load_scene(spec: str | Mapping[str, object] | os.PathLike[str]) -> Scene:
    """The scene that ``spec`` names.

    A string is a generator with or without a size (``mountain:5``, ``tetra``) or a file: ``.nff``,
    or any mesh, the cut after a colon if wanted (``bunny.glb:components``, ``bunny.glb:64`` for
    clusters of at most 64 triangles). A mapping is ``{spd: mountain, size: 5}``,
    ``{nff: file.nff}`` or ``{mesh: file.glb, objects: components}``. A generated scene is its NFF
    text read back, so both ways in are one scene. Raises ConfigError for a spec that names
    nothing known and SceneError for a file that is no scene.
    """
    if isinstance(spec, Mapping):
        return _from_mapping(spec)
    if isinstance(spec, os.PathLike):
        return _from_file(Path(spec))
    if isinstance(spec, str) and spec and "\0" not in spec:
        return _from_string(spec)
    raise ConfigError(f"scene: expected a name, a file or a mapping, got {spec!r}")


def _from_string(spec: str) -> Scene:
    head, colon, tail = spec.rpartition(":") if ":" in spec else (spec, "", "")
    if head in generators.known_names():
        return _generated(head, _size(tail, spec) if colon else None)
    # os.path answers no where pathlib raises, as for a name that no file can have.
    if os.path.exists(spec):
        return _from_file(Path(spec))
    if colon and (os.path.exists(head) or Path(head).suffix):
        return _cut(head, tail)
    if Path(spec).suffix or os.sep in spec:
        return _from_file(Path(spec))
    _refuse_capitals(head)
    known = ", ".join(generators.GENERATORS)
    raise ConfigError(f"no scene {spec!r}: no such file, and the generated scenes are {known}")


def _refuse_capitals(name: str) -> None:
    """Raise ConfigError if ``name`` would be a generator's in small letters."""
    if name.lower() in generators.known_names():
        raise ConfigError(f"no scene {name!r}: expected {name.lower()!r}")


def _cut(file: str, objects: str) -> Scene:
    """The mesh of a file, cut as the text after its name says."""
    try:
        return _from_file(
            Path(file), {"clusters": int(objects)} if objects.isdecimal() else objects
        )
    except ConfigError as error:
        raise ConfigError(error.problem, where=f"{file}:{objects}") from None


def _size(text: str, spec: str) -> int:
    if not re.fullmatch(r"[+-]?[0-9]{1,9}", text):
        raise ConfigError(f"expected a whole number for the size in {spec!r}, got {text!r}")
    return int(text)


def _from_mapping(spec: Mapping[str, object]) -> Scene:
    kinds = [kind for kind in KEYS if kind in spec]
    if len(kinds) != 1:
        raise ConfigError(f"scene: expected one of the keys {', '.join(KEYS)}, got {dict(spec)!r}")
    kind = kinds[0]
    unknown = [key for key in spec if key not in KEYS[kind]]
    if unknown:
        allowed = ", ".join(sorted(KEYS[kind]))
        raise ConfigError(f"scene: unknown key {unknown[0]!r} beside {kind!r}; known: {allowed}")
    value = spec[kind]
    if not isinstance(value, str | os.PathLike):
        raise ConfigError(f"scene.{kind}: expected a name, got {value!r}")
    if kind == "spd":
        size = spec.get("size")
        if size is not None and (isinstance(size, bool) or not isinstance(size, int)):
            raise ConfigError(f"scene.size: expected a whole number, got {size!r}")
        return _generated(str(value), size)
    if kind == "nff":
        return _nff_file(Path(value))
    if not os.path.exists(value):
        _refuse_capitals(Path(value).name)
    return load_mesh(Path(value), objects=spec.get("objects", "components"))


def _generated(name: str, size: int | None) -> Scene:
    generator = generators.find_generator(name)
    size = generator.default_size if size is None else size
    label = f"{generator.name}:{size}"
    return read_nff(generators.nff(name, size), name=label, where=label)


def _from_file(path: Path, objects: object = "components") -> Scene:
    if path.suffix.lower() == ".nff":
        return _nff_file(path)
    return load_mesh(path, objects=objects)


def _nff_file(path: Path) -> Scene:
    try:
        refuse_special(path)
        data = path.read_bytes()
    except (OSError, ValueError) as error:  # a null byte in the name is a ValueError
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(f"can't read the file: {reason}", where=str(path)) from None
    # Comments may hold anything; the words are checked to be ASCII.
    text = data.decode("utf-8-sig", errors="replace")
    return read_nff(text, name=path.stem, where=str(path))
