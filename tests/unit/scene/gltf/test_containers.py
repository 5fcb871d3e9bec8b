"""GLB and JSON that are not what they say."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from gltf_files import glb, nodes, one_square, refused

WHOLE = one_square().glb()


def header(version: int = 2, length: int = len(WHOLE)) -> bytes:
    return b"glTF" + struct.pack("<II", version, length)


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (b"", "expected 'glTF' and two numbers at its beginning"),
        (b"{}", "expected 'glTF' and two numbers at its beginning"),
        (WHOLE[:11], "expected 'glTF' and two numbers"),
        (header(version=1) + WHOLE[12:], "version 1 of the format: expected 2"),
        (WHOLE[:-1], f"its header says {len(WHOLE)} bytes, the file has {len(WHOLE) - 1}"),
        (header(length=12), "its first chunk is not its JSON"),
        (WHOLE[:16] + b"BIN\0" + WHOLE[20:], "its first chunk is not its JSON"),
        (header() + b"\xff\xff\xff\xff" + WHOLE[16:], "the chunk at byte 12 goes beyond the end"),
        (
            WHOLE[:12] + struct.pack("<I", len(WHOLE) - 12) + WHOLE[16:],
            "the chunk at byte 12 goes beyond the end",
        ),
        (header(length=15) + b"\0\0\0", "the chunk at byte 12 goes beyond the end"),
    ],
)
def test_containers(data: bytes, problem: str) -> None:
    assert f"not a readable glb mesh: {problem}" in refused(data, "a.glb")


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (b"", "EOF while parsing a value at line 1 column 0"),
        (b'{"asset":\n {"version" "2.0"}}', "expected `:` at line 2 column 12"),
        (b'{"nodes": [{"name": "n\xfc"}]}', "invalid unicode code point at line 1 column 23"),
        (b'{"nodes": [{"name": "\\ud800"}]}', "unexpected end of hex escape at line 1"),
        (b"[" * 10_000, "recursion limit exceeded at line 1"),
        (b'{"scene": ' + b"9" * 10_000 + b"}", "number out of range at line 1"),
    ],
)
def test_text_that_is_not_json(text: bytes, problem: str) -> None:
    for data, file in ((text, "a.gltf"), (glb(text.ljust(4)), "a.glb")):
        assert f"its JSON: {problem}"[:40] in refused(data, file)


def test_a_byte_order_mark_is_skipped() -> None:
    assert nodes(b"\xef\xbb\xbf" + one_square().gltf(), Path("a.gltf"))


def test_what_follows_the_end_is_not_looked_at() -> None:
    assert nodes(WHOLE + b"more", Path("a.glb"))


def test_only_the_first_buffer_is_in_the_container() -> None:
    file = one_square()
    file.json["buffers"] = [{"byteLength": 60}] * 2
    for view in file.json["bufferViews"]:
        view["buffer"] = 1
    assert "buffers[1] has neither a uri nor a chunk of a GLB" in refused(file.glb())


def test_json_of_another_kind() -> None:
    assert "its JSON: value: expected a valid object" in refused(b"[]")
