"""The rows of a PLY file, as text or in binary, by the same walk over both."""

from __future__ import annotations

from array import array
from collections.abc import Collection
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.cut import Indices
from simmpp.scene.formats.ply_header import Element, Header
from simmpp.scene.formats.text import Source, decoded, floats, integers, shown
from simmpp.scene.nff_words import line_of_word

Kind = np.dtype[Any]
ROWS = {"vertex": "vertices", "face": "faces"}


Starts = range | NDArray[np.int64]
"""Positions; a range where all rows are alike, which then are not looked at one by one."""


class Column(NamedTuple):
    """A property of all rows."""

    is_list: bool
    starts: Starts
    """The position of its first number in each of n rows."""
    sizes: Indices
    """(n,) the lengths of lists; 1 for numbers."""
    values: NDArray[Any]
    """(sum of sizes,) of the type of the property."""


class Body(Protocol):
    """Numbers by their position: the index of a word in a text, of a byte in a binary file."""

    n: int
    """Positions that there are."""

    def width(self, kind: Kind) -> int:
        """How far it is from one number to the next."""

    def count(self, at: int, kind: Kind) -> int:
        """The whole number at a position."""

    def is_constant(self, at: range, kind: Kind) -> bool:
        """Whether the same whole number stands at all these positions; it may say no if unsure."""

    def take(self, at: Indices, kind: Kind) -> NDArray[Any]:
        """The numbers at these positions (n,)."""

    def rows(self, starts: range, size: int, kind: Kind) -> NDArray[Any]:
        """So many numbers from each of these positions on, (n, size)."""

    def is_blank(self, at: int) -> bool:
        """Whether nothing follows from a position on."""

    def line(self, at: int) -> int | None:
        """The line of a position, where there are lines."""


class _Text:
    """A body of words."""

    def __init__(self, data: bytes, header: Header, source: Source) -> None:
        self.text = decoded(data[header.n_bytes :])
        self.words = self.text.split()
        self.n, self.lines_before, self.source = len(self.words), header.n_lines, source

    def width(self, _kind: Kind) -> int:
        return 1

    def count(self, at: int, _kind: Kind) -> int:
        return int(integers(self.words[at : at + 1], self.source, lambda _: self.line(at))[0])

    def is_constant(self, at: range, _kind: Kind) -> bool:
        words = self.words[at.start : at.stop : at.step]
        return words.count(words[0]) == len(words)

    def take(self, at: Indices, kind: Kind) -> NDArray[Any]:
        words = [self.words[i] for i in at.tolist()]
        if kind.kind != "f":
            return integers(words, self.source, lambda i: self.line(at[i]))
        return floats(words, self.source, lambda i: self.line(at[i])).astype(kind)

    def rows(self, starts: range, size: int, kind: Kind) -> NDArray[Any]:
        at = np.array(starts)[:, None] + np.arange(size)
        return self.take(at.ravel(), kind).reshape(at.shape)

    def is_blank(self, at: int) -> bool:
        return at == self.n

    def line(self, at: int) -> int:
        return self.lines_before + line_of_word(self.text, at)


class _Binary:
    """A body of bytes."""

    def __init__(self, data: bytes, header: Header) -> None:
        self.bytes = memoryview(data)[header.n_bytes :]
        self.array = np.frombuffer(self.bytes, np.uint8)
        self.n = len(self.bytes)
        self.order: Literal["big", "little"] = "big" if header.byte_order == ">" else "little"

    def width(self, kind: Kind) -> int:
        return kind.itemsize

    def count(self, at: int, kind: Kind) -> int:
        number = self.bytes[at : at + kind.itemsize]
        return int.from_bytes(number, self.order, signed=kind.kind == "i")

    def is_constant(self, at: range, kind: Kind) -> bool:
        numbers = self.rows(at, 1, kind)
        return bool((numbers == numbers[0]).all())

    def take(self, at: Indices, kind: Kind) -> NDArray[Any]:
        return self.array[at[:, None] + np.arange(kind.itemsize)].view(kind)[:, 0]

    def rows(self, starts: range, size: int, kind: Kind) -> NDArray[Any]:
        strides = starts.step, kind.itemsize
        return np.ndarray((len(starts), size), kind, self.bytes, starts.start, strides)

    def is_blank(self, at: int) -> bool:
        return not bytes(self.bytes[at:]).strip(b"\0 \t\r\n")

    def line(self, _at: int) -> None:
        return None


def body_of(data: bytes, header: Header, source: Source) -> Body:
    """What follows the header."""
    return _Binary(data, header) if header.byte_order else _Text(data, header, source)


def read_element(
    body: Body, element: Element, begin: int, wanted: Collection[str], source: Source
) -> tuple[dict[str, Column], int]:
    """The wanted columns of an element whose rows begin at a position, and where they end."""
    if not element.properties:
        return {}, begin
    places, end = _places(body, element, begin, source)
    columns = {}
    for (name, kind, count), (starts, sizes) in zip(element.properties, places, strict=True):
        if name in wanted:
            values = _values(body, kind, starts, sizes)
            columns[name] = Column(count is not None, starts, sizes, values)
    return columns, end


def _values(body: Body, kind: Kind, starts: Starts, sizes: Indices) -> NDArray[Any]:
    if isinstance(starts, range):
        return body.rows(starts, int(sizes[0]), kind).ravel()
    within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    return body.take(np.repeat(starts, sizes) + body.width(kind) * within, kind)


Places = list[tuple[Starts, Indices]]
"""Of each property where it begins in each row, and how many numbers it has there."""


def _places(body: Body, element: Element, begin: int, source: Source) -> tuple[Places, int]:
    n = element.n_rows
    if n > 1:  # mostly, all rows have lists as long as those of the first
        first, after = _walked(body, element, begin, 1, source)
        step = after - begin
        end = begin + n * step
        if end <= body.n and all(
            body.is_constant(range(start - body.width(kind), end, step), kind)
            for (_, _, kind), ((start,), _) in zip(element.properties, first, strict=True)
            if kind is not None
        ):
            return [
                (range(start, end, step), np.broadcast_to(size, n)) for (start,), size in first
            ], end
    return _walked(body, element, begin, n, source)


def _walked(
    body: Body, element: Element, begin: int, n_rows: int, source: Source
) -> tuple[Places, int]:
    """The same, row by row: where a list ends is known when its length is read."""
    places = [(array("q"), array("q")) for _ in element.properties]
    steps = [
        (count_kind, body.width(count_kind) if count_kind else 0, body.width(kind), *place)
        for (_, kind, count_kind), place in zip(element.properties, places, strict=True)
    ]
    at = begin
    for row in range(n_rows):
        for count_kind, count_width, width, starts, sizes in steps:
            size = 1
            if count_kind is not None:
                size = body.count(at, count_kind) if at + count_width <= body.n else 0
                at += count_width
            if size < 0:
                problem = f"row {row + 1} of {shown(element.name)} has a list of {size} numbers"
                raise source.error(problem, body.line(at))
            if at + size * width > body.n:
                rows = ROWS.get(element.name, f"rows of {shown(element.name)}")
                problem = f"the header says {element.n_rows} {rows}, {row} are there"
                raise source.error(problem)
            starts.append(at)
            sizes.append(size)
            at += size * width
    return [(np.array(starts), np.array(sizes)) for starts, sizes in places], at
