"""The paper's figure 2: which of the two classical dataflows wins, over nb and x."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import NullLocator

from simmpp.common.files import replaced
from simmpp.model.analytical import Makespans
from simmpp.model.border import winners
from simmpp.plot.matplotlib_panels import DOTS_PER_INCH
from simmpp.studies.nebel98.figure2_data import WinnerMap

RAY_COLOUR, OBJECT_COLOUR = "#cfe3f5", "#e69f00"
"""Light blue and orange differ in lightness too: the map holds in grey and for the colour-blind
(Okabe and Ito 2008)."""
PANELS_ACROSS = 4
MARK_ROOM = 1.12
"""Room for the marks of the first and the last nb."""


def draw_figure2(panels: Sequence[WinnerMap], heading: str, folder: Path) -> list[Path]:
    """Write ``figure2.png`` and ``figure2.svg``; returns their paths."""
    across = min(len(panels), PANELS_ACROSS)
    down = -(-len(panels) // across)
    figure = Figure(figsize=(0.8 + 2.5 * across, 1.5 + 2.5 * down), layout="constrained")
    grid = figure.subplots(down, across, squeeze=False, sharex=True, sharey=True)
    for axes in grid.flat[len(panels) :]:
        axes.remove()
    for panel, axes in zip(panels, grid.flat, strict=False):
        _map(axes, panel)
    figure.suptitle(heading, fontsize=10)
    for axes in grid[:, 0]:
        axes.set_ylabel("processors nb", fontsize=8)
    for axes in list(grid.flat)[max(len(panels) - across, 0) : len(panels)]:
        axes.set_xlabel("fraction x of the scene on each PE", fontsize=8)
        axes.tick_params(labelbottom=True)
    figure.legend(handles=_legend(), loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    paths = [folder / "figure2.png", folder / "figure2.svg"]
    with matplotlib.rc_context({"svg.hashsalt": "simmpp", "svg.fonttype": "none"}):
        # Not plot's save: it draws the SVG with the PNG's layout, which would be other bytes.
        with replaced(paths[0]) as part:
            figure.savefig(part, format="png", dpi=DOTS_PER_INCH)
        with replaced(paths[1]) as part:
            figure.savefig(part, format="svg", dpi=DOTS_PER_INCH, metadata={"Date": None})
    return paths


def _map(axes: Axes, panel: WinnerMap) -> None:
    fine = panel.fine
    x, nb = fine.fractions, fine.processors
    difference = np.log(fine.ratio)
    axes.contourf(x, nb, difference, [-np.inf, 0.0, np.inf], colors=[RAY_COLOUR, OBJECT_COLOUR])
    if difference.min() < 0 < difference.max():
        axes.contour(x, nb, difference, levels=[0.0], colors="black", linewidths=1.6)
    axes.fill_between(1.0 / nb, nb, nb.min(), facecolor="none", edgecolor="0.6", hatch="////")
    _dots(axes, panel.grid)
    axes.set_title(panel.title, fontsize=8)
    axes.set_yscale("log", base=2)
    axes.set_yticks(panel.grid.processors, [str(n) for n in panel.grid.processors])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(nb.min() / MARK_ROOM, nb.max() * MARK_ROOM)
    axes.tick_params(labelsize=7)


def _dots(axes: Axes, grid: Makespans) -> None:
    """The points that were asked for, marked by their winner."""
    x, nb = np.meshgrid(grid.fractions, grid.processors)
    won = winners(grid)
    for sign, marker, face in ((-1, "o", "white"), (1, "s", "black")):
        theirs = won == sign
        axes.scatter(
            x[theirs], nb[theirs], 9, face, marker=marker, edgecolors="black", linewidths=0.4
        )


def _legend() -> list[Patch]:
    return [
        Patch(facecolor=RAY_COLOUR, edgecolor="black", label="ray dataflow wins (o)"),
        Patch(facecolor=OBJECT_COLOUR, edgecolor="black", label="object dataflow wins (■)"),
        Patch(facecolor="none", edgecolor="0.6", hatch="////", label="x < 1/nb: no room"),
    ]
