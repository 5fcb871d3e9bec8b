"""Draws levels and fat-trees: PEs by their load, and above them who joins them, links by bytes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from simmpp.machine.fat_tree import Tree
from simmpp.machine.levels import Blocks
from simmpp.report.run_figures.data import Motion
from simmpp.report.run_figures.torus import LINK_COLOURS, LOAD_COLOURS

Place = tuple[float, float]
_ASIDE = 0.06
"""Distance of the lines of the two ways of a link, in distances of PEs."""


class Link(NamedTuple):
    """Between two places, the lower one first."""

    below: Place
    above: Place
    up_bytes: int
    down_bytes: int


def draw_tree(figure: Figure, motion: Motion) -> None:
    """PEs side by side below, blocks or switches above them, level by level."""
    links = links_of(motion)
    nb, height = len(motion.load), max(link.above[1] for link in links)
    figure.set_size_inches(min(14, max(6.3, 2 + 0.35 * nb)), 1.6 + 1.1 * height)
    axes = figure.subplots()
    amounts = np.array([n for link in links for n in (link.up_bytes, link.down_bytes)]) / 1e6
    of_links = matplotlib.colors.Normalize(0, float(amounts.max(initial=0)) or 1.0)
    of_loads = matplotlib.colors.Normalize(0, max(float(motion.load.max(initial=0)), 1e-9))
    segments = [segment for link in links for segment in _both_ways(link)]
    used = np.ma.masked_equal(amounts, 0)
    axes.add_collection(
        LineCollection(segments, array=used, cmap=LINK_COLOURS, norm=of_links, linewidths=2)
    )
    x, y = np.array(sorted({link.above for link in links})).T
    axes.scatter(x, y, 60, "w", marker="s", edgecolors="0.3", zorder=2)
    axes.scatter(
        np.arange(nb), np.zeros(nb), 120, motion.load, cmap=LOAD_COLOURS, norm=of_loads,
        edgecolors="0.3", zorder=2,
    )  # fmt: skip
    if nb <= 64:
        for pe, load in enumerate(motion.load):
            colour = "w" if of_loads(load) > 0.6 else "k"
            axes.annotate(str(pe), (pe, 0), ha="center", va="center", fontsize=6, color=colour)
    axes.set(xlim=(-0.7, nb - 0.3), ylim=(-0.4, height + 0.3))
    axes.set_axis_off()
    for norm, cmap, label in (
        (of_links, LINK_COLOURS, "MB, one way (grey: none)"),
        (of_loads, LOAD_COLOURS, "rays held, mean over time"),
    ):
        scale = matplotlib.cm.ScalarMappable(norm, cmap)
        figure.colorbar(scale, ax=axes, label=label, aspect=30, pad=0.01)
    title = f"{motion.title}: {motion.topology}; links by bytes, up on the left, PEs by load"
    figure.suptitle(title, fontsize=9)


def links_of(motion: Motion) -> list[Link]:
    """All links, those of the PEs first."""
    return _LAYOUTS[type(motion.topology)](motion.topology, motion)


def _both_ways(link: Link) -> list[NDArray[np.float64]]:
    ends = np.array([link.below, link.above])
    return [ends + np.array([side * _ASIDE, 0]) for side in (-1, 1)]


def _middle(first: int, size: int, nb: int) -> float:
    """Above the middle of the PEs that there are from ``first`` on."""
    return (first + min(first + size, nb) - 1) / 2


def _of_pes(motion: Motion, above: Callable[[int], Place]) -> list[Link]:
    """A link for each PE: what it sent and what came."""
    out, into = motion.bytes.sum(axis=1).tolist(), motion.bytes.sum(axis=0).tolist()
    return [Link((pe, 0), above(pe), out[pe], into[pe]) for pe in range(len(out))]


def _of_blocks(topology: Blocks, motion: Motion) -> list[Link]:
    """The ports of each block, side by side where there are several."""
    nb, sizes = topology.pe_count, topology.block_sizes

    def place(level: int, pe: int) -> Place:
        size = sizes[level]
        return _middle(pe - pe % size, size, nb), level + 1

    links = _of_pes(motion, lambda pe: place(0, pe))
    rows = iter(motion.link_bytes.tolist())
    for level, of in enumerate(topology.levels[1:], 1):
        for first in range(0, nb, sizes[level - 1]):
            (x, y), above = place(level - 1, first), place(level, first)
            for port in range(of.ports):
                aside = 4 * _ASIDE * (port - (of.ports - 1) / 2)
                links.append(Link((x + aside, y), above, *next(rows)))
    return links


def _of_switches(topology: Tree, motion: Motion) -> list[Link]:
    """Links between switches; those of one place of the tree stand side by side."""
    nb, reaches = topology.pe_count, topology.reaches
    widths = [1, *topology.copies]

    def place(level: int, pe: int, copy: int) -> Place:
        """Of a switch; level 0 is the lowest."""
        reach = reaches[level]
        first = pe - pe % reach
        span = min(first + reach, nb) - first
        aside = (copy + 0.5) / widths[level] - 0.5
        return _middle(first, reach, nb) + aside * span, level + 1

    links = _of_pes(motion, lambda pe: place(0, pe, 0))
    rows = iter(motion.link_bytes.tolist())
    for level, reach in enumerate(reaches[:-1]):
        for first in range(0, nb, reach):
            for copy in range(widths[level + 1]):
                below = place(level, first, copy % widths[level])
                links.append(Link(below, place(level + 1, first, copy), *next(rows)))
    return links


_LAYOUTS: dict[type, Callable[[Any, Motion], list[Link]]] = {Blocks: _of_blocks, Tree: _of_switches}
