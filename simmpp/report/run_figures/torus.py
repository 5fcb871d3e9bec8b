"""Draws the torus layer by layer: PEs by their load, links by the bytes that crossed them."""

from __future__ import annotations

from typing import Any, cast

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from simmpp.machine.torus import Torus
from simmpp.report.run_figures.data import Motion

LOAD_COLOURS = "Blues"
LINK_COLOURS = LinearSegmentedColormap.from_list(
    "links", matplotlib.colormaps["YlOrRd"](np.linspace(0.2, 1)), bad="0.9"
)
"""Without the palest colours, which paper swallows; grey for links that nothing crossed."""
_MOST_COLUMNS = 8
_LEAST_HEIGHT = 3.2
"""Inches that the labels beside the scales need, however few PEs there are."""
_SCALE_PARTS = 6
"""Divisions of a scale: without a number they depend on its height, which is not yet known when
its labels are given room."""
_STUB = 0.45
"""Length of a link that leads out of a layer, or round the ring, in distances of PEs."""


def sizes_of(motion: Motion) -> tuple[int, int, int]:
    """Those of the torus."""
    return cast(Torus, motion.topology).sizes


def draw_torus(figure: Figure, motion: Motion) -> None:
    """One map for each z: x to the right, y up; links along z as diagonal stubs."""
    x_size, y_size, z_size = sizes_of(motion)
    columns = min(z_size, _MOST_COLUMNS, max(1, 16 // x_size))
    rows = -(-z_size // columns)
    figure.set_size_inches(
        max(6.3, 1.8 + 0.6 * columns * (x_size + 0.4)),
        max(_LEAST_HEIGHT, 0.7 + 0.6 * rows * (y_size + 0.6)),
    )
    grid = figure.subplots(rows, columns, squeeze=False)
    most = int(motion.link_bytes.max(initial=0)) / 1e6 or 1.0
    links = matplotlib.colors.Normalize(0, most)
    loads = matplotlib.colors.Normalize(0, max(float(motion.load.max(initial=0)), 1e-9))
    for z, axes in enumerate(grid.flat):
        axes.set_axis_off()
        if z < z_size:
            _draw_layer(axes, motion, z, links, loads)
    for norm, cmap, label in (
        (links, LINK_COLOURS, "MB over a link, one way (grey: none)"),
        (loads, LOAD_COLOURS, "rays held, mean over time"),
    ):
        scale = matplotlib.cm.ScalarMappable(norm, cmap)
        figure.colorbar(
            scale, ax=grid, label=label, aspect=30, pad=0.01, ticks=MaxNLocator(_SCALE_PARTS)
        )
    figure.suptitle(f"{motion.title}: links by bytes, PEs by load", fontsize=9)


def _draw_layer(axes: Axes, motion: Motion, z: int, links: Any, loads: Any) -> None:
    x_size, y_size, _ = sizes_of(motion)
    first = x_size * y_size * z
    pes = np.arange(first, first + x_size * y_size)
    places = np.array([pes % x_size, pes // x_size % y_size], float).T
    segments, amounts = _links_of(motion, pes, places)
    used = np.ma.masked_equal(amounts / 1e6, 0)
    lines = LineCollection(segments, array=used, cmap=LINK_COLOURS, norm=links, linewidths=3)
    axes.add_collection(lines)
    (x, y), load = places.T, motion.load[pes]
    axes.scatter(x, y, 190, load, cmap=LOAD_COLOURS, norm=loads, edgecolors="0.3", zorder=2)
    for pe, place in zip(pes, places, strict=True):
        colour = "w" if loads(motion.load[pe]) > 0.6 else "k"
        axes.annotate(str(pe), place, ha="center", va="center", fontsize=6, color=colour)
    axes.set(xlim=(-0.7, x_size - 0.3), ylim=(-0.7, y_size - 0.3), aspect="equal")
    axes.set_title(f"z = {z}", fontsize=8)


def _links_of(
    motion: Motion, pes: NDArray[np.int64], places: NDArray[np.float64]
) -> tuple[list[Any], NDArray[np.float64]]:
    """Segments from PEs, side by side for the two ways, and the bytes over them."""
    ways = [(1, 0), (-1, 0), (0, 1), (0, -1), (0.7, 0.7), (-0.7, -0.7)]
    segments, amounts = [], []
    for pe, place in zip(pes, places, strict=True):
        for direction, way in enumerate(ways):
            size = sizes_of(motion)[direction // 2]
            if size == 1 or (size == 2 and direction % 2):  # such a link is not there
                continue
            step = np.array(way, float)
            aside = 0.07 * np.array([-step[1], step[0]])
            end = place + step
            within = direction < 4 and 0 <= end[direction // 2] < size
            end = end if within else place + _STUB * step
            segments.append([place + aside, end + aside])
            amounts.append(motion.link_bytes[pe, direction])
    return segments, np.array(amounts, float)
