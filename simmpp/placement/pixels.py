"""Which PE starts with which pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import generator
from simmpp.placement.placement import Cells, Pixels, cut


def pixel_pes(
    rule: Pixels | Cells, picture: tuple[int, int], processors: int, seed: int
) -> NDArray[np.int32]:
    """The PE of each pixel, row by row: (rows * columns,) int32.

    ``blocks`` cuts the pixels in their order at floor(i n / nb), ``tiles`` cuts the picture into
    a x b = nb rectangles nearest its aspect, ``random`` deals out the blocks of a seeded
    permutation. In turn, the first to PE 0, are dealt the pixels (``interleaved``), the rows of the
    picture (``rows``), or the squares of Cells, row by row, cut off at the right and lower edge.
    """
    rows, columns = picture
    n = rows * columns
    if isinstance(rule, Cells):
        return _in_turn(rows, columns, (rule.cells, rule.cells), processors)
    if rule == "interleaved":
        return _in_turn(rows, columns, (1, 1), processors)
    if rule == "rows":
        return _in_turn(rows, columns, (1, columns), processors)
    if rule == "tiles":
        return _tiles(rows, columns, processors)
    dealt = np.empty(n, np.int32)
    order = generator(seed, "pixels").permutation(n) if rule == "random" else np.arange(n)
    dealt[order] = cut(n, processors)
    return dealt


def _in_turn(rows: int, columns: int, cell: tuple[int, int], processors: int) -> NDArray[np.int32]:
    """PE = number of the cell, row by row, mod nb; ``cell`` is its rows and columns."""
    height, width = cell
    across = -(-columns // width)
    number = np.arange(rows)[:, None] // height * across + np.arange(columns) // width
    return (number % processors).astype(np.int32).reshape(-1)


def _tiles(rows: int, columns: int, processors: int) -> NDArray[np.int32]:
    """PE = tile column + tile columns * tile row."""
    shapes = [(a, processors // a) for a in range(1, processors + 1) if processors % a == 0]
    # a rows of b tiles fit best where a tile is nearest to a square: compare rows b and columns a.
    down, across = min(shapes, key=lambda shape: (_skew(rows, columns, *shape), shape))
    return (cut(rows, down)[:, None] * across + cut(columns, across)[None, :]).reshape(-1)


def _skew(rows: int, columns: int, down: int, across: int) -> float:
    """How far from square a tile is: the ratio of its longer to its shorter side."""
    height, width = rows * across, columns * down
    return max(height, width) / max(1, min(height, width))
