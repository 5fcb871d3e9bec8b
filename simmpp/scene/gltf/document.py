"""The JSON of a file, checked: what has to be known of it is, and what is not read is refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails, from_json

from simmpp.common.errors import SceneError
from simmpp.common.units import shown
from simmpp.scene.gltf.schema import Document, Head

T = TypeVar("T")
HARMLESS = (
    *("KHR_materials_", "EXT_materials_", "MSFT_materials_", "ADOBE_materials_"),
    *("KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_"),
    *("KHR_animation_", "KHR_xmp", "KHR_audio_", "EXT_mesh_gpu_instancing"),
    *("KHR_mesh_quantization", "KHR_node_visibility", "KHR_technique"),
)
"""How the names of extensions begin that are read, or change neither a triangle nor its place."""
COMPRESSED = {
    "KHR_draco_mesh_compression": "Draco",
    "EXT_meshopt_compression": "meshopt",
    "KHR_meshopt_compression": "meshopt",
}


def parsed(text: bytes) -> Document:
    """The JSON of a file, if all that is read of it is of the right kind."""
    try:
        content = from_json(text.removeprefix(b"\xef\xbb\xbf"))
    except ValueError as error:
        raise SceneError(f"not a readable gltf mesh: its JSON: {error}") from None
    try:
        _refuse_unknown(Head.model_validate(content))
        return Document.model_validate(content)
    except ValidationError as error:
        raise SceneError(_explained(error.errors(include_url=False)[0])) from None


def item(items: Sequence[T], index: int, name: str) -> T:
    """``items[index]``, if there is one."""
    if index >= len(items):
        raise SceneError(f"{name}[{index}] is named, but there are {len(items)} {name}")
    return items[index]


def _explained(error: ErrorDetails) -> str:
    place = "".join(map(_step, error["loc"])).lstrip(".")
    wrong = error["msg"].replace("Input should be", "expected").split(" or instance")[0]
    wrong = wrong.replace("dictionary", "object")
    if error["type"] == "missing":
        return f"{place}: missing"
    value = error["input"]
    found = f"value {shown(value)}" if isinstance(value, str | int | float) else "value"
    return f"{place or 'its JSON'}: {found}: {wrong}"


def _step(key: int | str) -> str:
    is_plain = isinstance(key, str) and key.isidentifier() and len(key) < 60
    return f".{key}" if is_plain else f"[{shown(key)}]"


def _refuse_unknown(head: Head) -> None:
    version, oldest = head.asset.version, head.asset.min_version
    if not str(version).startswith("2.") or oldest != "2.0":
        problem = f"of glTF {shown(version)}, for readers of {shown(oldest)} at least"
        raise SceneError(f"{problem}: expected glTF 2.0, save it as that")
    for name in head.extensions_required:
        if name in COMPRESSED:
            raise compressed(COMPRESSED[name])
        if not name.startswith(HARMLESS):
            problem = f"needs the extension {shown(name)}, which is not read: save it without"
            raise SceneError(problem)


def compressed(way: str) -> SceneError:
    """The error for a file that has to be decompressed."""
    return SceneError(f"compressed with {way}, which is not read: save it without compression")
