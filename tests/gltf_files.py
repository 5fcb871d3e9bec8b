"""glTF files put together by hand: views and accessors are appended, the rest is plain JSON."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from simmpp.common.errors import SceneError
from simmpp.scene.gltf.read import content
from simmpp.scene.node import Node

CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
HALVES = [0, 1, 2, 0, 2, 3]
"""The square's two triangles."""


class File:
    """A glTF file that grows; ``json`` may be changed at will."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}]}

    def add(self, collection: str, **entry: Any) -> int:
        """Append to one of the JSON's arrays; the index there."""
        entries = self.json.setdefault(collection, [])
        entries.append(entry)
        return len(entries) - 1

    def view(self, content: bytes, **more: Any) -> int:
        """A view of bytes that are appended to the buffer, on a multiple of 4."""
        self.data += bytes(-len(self.data) % 4)
        start = len(self.data)
        self.data += content
        place = {"buffer": 0, "byteOffset": start, "byteLength": len(content)}
        return self.add("bufferViews", **place, **more)

    def accessor(self, rows: Any, kind: str = "f4", **more: Any) -> int:
        """An accessor of rows of numbers, one after the other, in a view of its own."""
        numbers = np.atleast_2d(np.asarray(rows).T).T.astype(f"<{kind}")
        view = self.view(numbers.tobytes())
        return self.add("accessors", **described(numbers, kind, bufferView=view) | more)

    def mesh(self, *primitives: dict[str, Any], **more: Any) -> int:
        return self.add("meshes", primitives=list(primitives), **more)

    def square(self, **more: Any) -> dict[str, Any]:
        """A primitive: the unit square."""
        attributes = {"POSITION": self.accessor(SQUARE)}
        return {"attributes": attributes, "indices": self.accessor(HALVES, "u2")} | more

    def node(self, *, root: bool = True, **entry: Any) -> int:
        index = self.add("nodes", **entry)
        if root:
            self.json["scenes"][0].setdefault("nodes", []).append(index)
        return index

    def require(self, *extensions: str) -> None:
        self.json |= {"extensionsUsed": extensions, "extensionsRequired": extensions}

    def gltf(self, uri: str | None = None) -> bytes:
        """JSON, with the buffer in it unless there is a ``uri``."""
        inline = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps(self._with_buffer(uri=uri or inline)).encode()

    def glb(self) -> bytes:
        return glb(json.dumps(self._with_buffer()).encode(), bytes(self.data))

    def write(self, path: Path) -> Path:
        path.write_bytes(self.glb() if path.suffix == ".glb" else self.gltf())
        return path

    def _with_buffer(self, **entry: Any) -> dict[str, Any]:
        buffer = {"byteLength": len(self.data), **entry}
        return {"buffers": [buffer], **self.json} if self.data else self.json


def described(numbers: np.ndarray, kind: str, **more: Any) -> dict[str, Any]:
    """The accessor of an array of (count, width)."""
    count, width = numbers.shape
    return {"componentType": CODES[kind], "type": KINDS[width], "count": count, **more}


def glb(text: bytes, binary: bytes | None = None) -> bytes:
    """The container of JSON and of the bytes that follow it."""
    chunks = [(b"JSON", text + b" " * (-len(text) % 4))]
    if binary is not None:
        chunks.append((b"BIN\0", binary + bytes(-len(binary) % 4)))
    body = b"".join(struct.pack("<I", len(part)) + kind + part for kind, part in chunks)
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def one_square(**node: Any) -> File:
    """The unit square in one node."""
    file = File()
    file.node(mesh=file.mesh(file.square()), **node)
    return file


def nodes(data: bytes, file: Path) -> Sequence[Node]:
    """The meshes of a file."""
    return content(data, file).nodes


def refused(data: bytes, file: str = "a.gltf") -> str:
    """The one line that refuses a file."""
    with pytest.raises(SceneError) as caught:
        nodes(data, Path(file))
    message = str(caught.value)
    assert message.startswith(f"{file}: ") and message.isprintable() and len(message) < 300
    return message
