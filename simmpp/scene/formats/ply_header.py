"""The header of a PLY file: which elements follow, and which properties each has.

Source: G. Turk, "The PLY Polygon File Format", 1994, and what programs write since: types named by
their size, 64-bit integers.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np

from simmpp.scene.formats.text import Source, decoded, shown

TYPES = {
    **dict.fromkeys(["char", "int8"], "i1"),
    **dict.fromkeys(["uchar", "uint8"], "u1"),
    **dict.fromkeys(["short", "int16"], "i2"),
    **dict.fromkeys(["ushort", "uint16"], "u2"),
    **dict.fromkeys(["int", "int32"], "i4"),
    **dict.fromkeys(["uint", "uint32"], "u4"),
    "int64": "i8",
    "uint64": "u8",
    **dict.fromkeys(["float", "float32"], "f4"),
    **dict.fromkeys(["double", "float64"], "f8"),
}
"""Names of types -> numpy's."""
COUNT_TYPES = {name for name, kind in TYPES.items() if kind[0] != "f"}
BYTE_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
KEYWORDS = {"ply", "format", "element", "property"}
COUNT = re.compile("[0-9]{1,18}")


class Property(NamedTuple):
    """A number of each row of an element, or a list of numbers."""

    name: str
    type: np.dtype[Any]
    """Of the number, or of each number of the list."""
    count_type: np.dtype[Any] | None
    """Of the length of the list; None for a number."""


class Element(NamedTuple):
    """Rows of equal properties: vertices, faces ..."""

    name: str
    n_rows: int
    properties: list[Property]


class Header(NamedTuple):
    """What follows the header, and from where."""

    byte_order: str
    """As numpy spells it; empty for text."""
    elements: list[Element]
    n_lines: int
    n_bytes: int


def read_header(data: bytes, source: Source) -> Header:
    """The header that the file begins with; SceneError, with the line, if it is none."""
    # Its first line tells how lines end: the byte after a \r may be one of a number.
    line_end = b"\r" if re.match(rb"ply[ \t]*\r(?!\n)", data) else b"\n"
    order: str | None = None
    elements: list[Element] = []
    line = begin = 0
    while (end := data.find(line_end, begin)) >= 0:
        words = decoded(data[begin:end]).split()
        line, begin = line + 1, end + 1
        match words:
            case ["ply"] if line == 1:
                pass
            case ["format", name, "1.0"] if line > 1 and order is None and name in BYTE_ORDERS:
                order = BYTE_ORDERS[name]
            case [] | ["comment" | "obj_info", *_] if line > 1:
                pass
            case ["element", name, count] if order is not None and COUNT.fullmatch(count):
                elements.append(Element(name, int(count), []))
            case ["property", *rest] if elements and (new := _property(rest, order or "")):
                elements[-1].properties.append(new)
            case ["end_header"] if order is not None:
                return Header(order, elements, line, begin)
            case [word, *_] if order is not None and not elements and word not in KEYWORDS:
                pass  # some programs sign without the word comment
            case _:
                problem = f"expected a line of a PLY header, got {shown(' '.join(words))}"
                raise source.error(problem, line)
    raise source.error("the header ends without end_header", max(line, 1))


def _property(words: list[str], order: str) -> Property | None:
    """A property as the words after the keyword declare it; None if they are not understood."""
    match words:
        case ["list", count, kind, name] if count in COUNT_TYPES and kind in TYPES:
            return Property(name, np.dtype(order + TYPES[kind]), np.dtype(order + TYPES[count]))
        case [kind, name] if kind in TYPES:
            return Property(name, np.dtype(order + TYPES[kind]), None)
    return None
