"""Draws maps of tiles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes

from simmpp.plot.curves import TILE, Tiles

HATCHED: dict[str, Any] = {"facecolor": "0.93", "hatch": "////"}


def draw_tiles(axes: Axes, tiles: Tiles, colours: Sequence[str]) -> None:
    """Draw a map into its axes, with the legend beside it."""
    for layer in tiles.layers:
        is_hatched = layer.style is None
        style = HATCHED if is_hatched else {"facecolor": colours[(layer.style or 0) % len(colours)]}
        bottom = [tile.y - TILE / 2 for tile in layer.tiles]
        axes.bar([t.x for t in layer.tiles], TILE, TILE, bottom, label=layer.label, **style)
    axes.set_xticks(range(len(tiles.x.names)), tiles.x.names)
    axes.set_yticks(range(len(tiles.y.names)), tiles.y.names)
    axes.set_xlabel(tiles.x.label)
    axes.set_ylabel(tiles.y.label)
    axes.set_title(tiles.title, fontsize=9)
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
