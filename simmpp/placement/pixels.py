"""Which PE starts with which pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import generator
from simmpp.placement.placement import Pixels, cut


def pixel_pes(
    rule: Pixels, picture: tuple[int, int], processors: int, seed: int
) -> NDArray[np.int32]:
    """The PE of each pixel, row by row: (rows * columns,) int32.

    ``blocks`` cuts the pixels in their order at floor(i n / nb), ``tiles`` cuts the picture into
    a x b = nb rectangles nearest its aspect, ``interleaved`` deals pixels out in turn, ``random``
    deals out the blocks of a seeded permutation.
    """
    rows, columns = picture
    n = rows * columns
    if rule == "interleaved":
        return (np.arange(n) % processors).astype(np.int32)
    if rule == "tiles":
        return _tiles(rows, columns, processors)
    dealt = np.empty(n, np.int32)
    order = generator(seed, "pixels").permutation(n) if rule == "random" else np.arange(n)
    dealt[order] = cut(n, processors)
    return dealt


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
