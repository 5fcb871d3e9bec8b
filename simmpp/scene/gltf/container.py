"""The bytes of a file: the chunks of a GLB, and its buffers, wherever they are kept."""

from __future__ import annotations

import base64
import binascii
import os
import re
import struct
from pathlib import Path
from urllib.parse import unquote_to_bytes

from simmpp.common.errors import SceneError
from simmpp.common.files import refuse_special
from simmpp.common.units import shown
from simmpp.scene.gltf.document import item
from simmpp.scene.gltf.schema import Document

MAGIC = b"glTF"
JSON, BIN = b"JSON", b"BIN\0"


def split(data: bytes, *, binary: bool) -> tuple[bytes, memoryview | None]:
    """The JSON of a file, and the bytes that follow it in a GLB.

    A file that begins as a GLB is one; one that is ``binary`` by its name has to.
    """
    if not binary and not data.startswith(MAGIC):
        return data, None
    chunks = _chunks(data)
    (kind, text), *others = chunks or [(b"", memoryview(b""))]
    if kind != JSON:
        raise _unreadable("its first chunk is not its JSON")
    return bytes(text), next((body for kind, body in others[:1] if kind == BIN), None)


def _chunks(data: bytes) -> list[tuple[bytes, memoryview]]:
    """Type and content of each chunk of a GLB; nothing is copied."""
    if not data.startswith(MAGIC) or len(data) < 12:
        raise _unreadable("expected 'glTF' and two numbers at its beginning")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise _unreadable(f"version {version} of the format: expected 2")
    if length > len(data):
        raise _unreadable(f"its header says {length} bytes, the file has {len(data)}")
    chunks, at = [], 12
    while at < length:
        head, body = data[at : at + 8], at + 8
        size = int.from_bytes(head[:4], "little")
        if len(head) < 8 or size > length - body:
            raise _unreadable(f"the chunk at byte {at} goes beyond the end of the file")
        chunks.append((head[4:], memoryview(data)[body : body + size]))
        at = body + size
    return chunks


def _unreadable(reason: str) -> SceneError:
    return SceneError(f"not a readable glb mesh: {reason}")


class Buffers:
    """The buffers of a file; each is read when something needs it."""

    def __init__(self, document: Document, chunk: memoryview | None, folder: Path) -> None:
        self._document, self._chunk, self._folder = document, chunk, folder
        self._read: dict[int, bytes | memoryview] = {}

    def view(self, index: int) -> tuple[memoryview, int | None]:
        """The bytes of a buffer view, and those from one element to the next if it says so."""
        view = item(self._document.buffer_views, index, "bufferViews")
        whole = self._buffer(view.buffer)
        end = view.byte_offset + view.byte_length
        if end > len(whole):
            problem = f"bufferViews[{index}] ends at byte {end} of buffers[{view.buffer}]"
            raise SceneError(f"{problem}, which has {len(whole)}")
        return memoryview(whole)[view.byte_offset : end], view.byte_stride

    def _buffer(self, index: int) -> bytes | memoryview:
        if index not in self._read:
            buffer = item(self._document.buffers, index, "buffers")
            content = self._content(index, buffer.uri, buffer.byte_length)
            if len(content) < buffer.byte_length:
                problem = f"buffers[{index}]: {buffer.byte_length} bytes are named"
                raise SceneError(f"{problem}, but there are {len(content)}")
            self._read[index] = content[: buffer.byte_length]
        return self._read[index]

    def _content(self, index: int, uri: str | None, length: int) -> bytes | memoryview:
        name = f"buffers[{index}]"
        if uri is None:
            if index > 0 or self._chunk is None:
                raise SceneError(f"{name} has neither a uri nor a chunk of a GLB")
            return self._chunk
        if uri[:5].lower() == "data:":
            return _inline(uri, name)
        if re.match(r"[A-Za-z][A-Za-z0-9+.-]+:", uri):
            raise SceneError(f"{name} is at {shown(uri)}: expected a file beside it, or data:")
        return _beside(self._folder / os.fsdecode(unquote_to_bytes(uri)), name, length)


def _inline(uri: str, name: str) -> bytes:
    """The bytes that a ``data:`` URI spells."""
    head, comma, body = uri.partition(",")
    content = unquote_to_bytes(body)
    if not comma:
        raise SceneError(f"{name}: its data: URI has no comma")
    if not head.lower().endswith(";base64"):
        return content
    try:
        return base64.b64decode(content, validate=True)
    except binascii.Error as error:
        raise SceneError(f"{name}: not base64: {str(error)[:100]}") from None


def _beside(file: Path, name: str, length: int) -> bytes:
    """The first ``length`` bytes of another file, or all of it if it has fewer."""
    try:
        refuse_special(file)
        with file.open("rb") as opened:
            return opened.read(min(length, os.fstat(opened.fileno()).st_size))
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(f"{name}: can't read {str(file)!r}: {reason}") from None
