"""Draws curves and stacked bars as PNG and SVG, readable in print and by the colour-blind."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter, NullLocator
from PIL import Image

from simmpp.common.files import replaced
from simmpp.plot.curves import (
    PART_COLOURS,
    Bars,
    Curve,
    Drawable,
    Hatched,
    Panel,
    Scale,
    Stated,
    Tiles,
)
from simmpp.plot.matplotlib_tiles import draw_tiles

STYLES: tuple[dict[str, Any], ...] = (
    {"color": "#0072B2", "marker": "o", "linestyle": "-"},
    {"color": "#D55E00", "marker": "s", "linestyle": "--"},
    {"color": "#009E73", "marker": "^", "linestyle": "-."},
    {"color": "#CC79A7", "marker": "D", "linestyle": (0, (5, 1, 1, 1, 1, 1))},
    {"color": "#E69F00", "marker": "v", "linestyle": (0, (1, 1))},
    {"color": "#56B4E9", "marker": "P", "linestyle": (0, (6, 2))},
    {"color": "#000000", "marker": "X", "linestyle": (0, (3, 1))},
)
"""Colours of Okabe and Ito (2008), which all readers tell apart; markers and lines differ too."""
GUIDE: dict[str, Any] = {"color": "0.45", "linewidth": 0.9, "linestyle": (0, (2, 2))}
STATED: dict[str, Any] = {"facecolor": "0.9", "edgecolor": "0.72", "hatch": "////"}
FLOOR: dict[str, Any] = {"alpha": 0.3, "linewidth": 0}
LEGEND: dict[str, Any] = {"fontsize": 8, "title_fontsize": 8, "handlelength": 3.2}
FADE = 1.35
"""A band below a level is drawn down to that part of it: others lie deeper."""
PART_STYLES: tuple[dict[str, Any], ...] = (
    {"facecolor": "#1f5f8b"},
    {"facecolor": "#e8963a", "hatch": "\\\\\\"},
    {"facecolor": "#d5dbe1"},
    {"facecolor": "#8c62b3", "hatch": "////"},
    {"facecolor": "#f3cfa0"},
    {"facecolor": "#b3423a", "hatch": "...."},
    {"facecolor": "#7f93a6", "hatch": "xxxx"},
    {"facecolor": "#7fc4ae", "hatch": "||||"},
)
"""Of parts of bars, by the number of their colour: they differ in lightness too."""
WIDTH_IN, HEIGHT_IN, DOTS_PER_INCH, SCREEN_DOTS_PER_INCH = 6.3, 4.1, 200, 96
MOST_IN_TWOS = 4
"""Panels up to which two are side by side; of more it is three."""
SETTINGS: Any = {
    "svg.hashsalt": "simmpp",
    "svg.fonttype": "none",
    "hatch.linewidth": 0.4,
    "hatch.color": "0.72",
    "font.size": 9,
    "axes.titley": 1.0,  # else each title is placed four times, after all ticks
}
"""Equal figures give equal bytes: ids in SVG are hashes with this salt, not random."""
PNG_LEVEL = 3
"""Of compression: takes half the time of the usual 6 for a tenth more bytes, which leaving out
the opacity saves again (tests/bench/README.md)."""


class Drawing(Figure):
    """A figure that notebooks show, whether they use pyplot or not."""

    def _repr_png_(self) -> bytes:
        """Called by notebooks."""
        buffer = BytesIO()
        self.savefig(buffer, dpi=SCREEN_DOTS_PER_INCH)
        return buffer.getvalue()


def draw(panels: Sequence[Drawable], stem: Path) -> list[Path]:
    """Write the panels side by side as ``stem``.png and ``stem``.svg; returns these."""
    with matplotlib.rc_context(SETTINGS):
        return save(drawing(panels), stem)


def drawing(panels: Sequence[Drawable]) -> Drawing:
    """The panels side by side, at least one."""
    across = min(len(panels), 2 if len(panels) <= MOST_IN_TWOS else 3)
    down = -(-len(panels) // across)
    with matplotlib.rc_context(SETTINGS):
        figure = Drawing(figsize=(WIDTH_IN * across, HEIGHT_IN * down), layout="constrained")
        grid = figure.subplots(down, across, squeeze=False)
        for axes in grid.flat[len(panels) :]:
            axes.remove()
        for axes, panel in zip(grid.flat, panels, strict=False):
            if isinstance(panel, Tiles):
                draw_tiles(axes, panel, [style["color"] for style in STYLES])
            elif isinstance(panel, Bars):
                _draw_bars(axes, panel)
            else:
                _draw_panel(axes, panel)
    return figure


def save(figure: Figure, stem: Path) -> list[Path]:
    """Write a figure as ``stem``.png and ``stem``.svg, without dates.

    ``Figure.savefig`` would draw each twice, once only to lay it out; what one sees is the same.
    """
    png, svg = (stem.with_name(f"{stem.name}.{kind}") for kind in ("png", "svg"))
    dots_of_images = figure.dpi
    figure.set_dpi(DOTS_PER_INCH)
    raster: Any = FigureCanvasAgg(figure)
    raster.draw()
    picture = Image.frombuffer("RGBA", raster.get_width_height(), raster.buffer_rgba())
    dots = (DOTS_PER_INCH, DOTS_PER_INCH)
    with replaced(png) as part:
        picture.convert("RGB").save(part, format="png", dpi=dots, compress_level=PNG_LEVEL)
    figure.set_layout_engine("none")  # laid out once; the second file is to be the same
    figure.set_dpi(dots_of_images)
    vector: Any = FigureCanvasSVG(figure)
    with replaced(svg) as part:
        vector.print_svg(part, metadata={"Date": None})
    return [png, svg]


def _draw_panel(axes: Axes, panel: Panel) -> None:
    for stated in panel.stated:
        _draw_stated(axes, stated)
    for strip in panel.hatched:
        _draw_hatched(axes, strip)
    if panel.level is not None:
        axes.axhline(panel.level, color="black", linewidth=0.7, zorder=1.5)
    for curve in panel.curves:
        style = GUIDE if curve.is_guide else STYLES[panel.style_of(curve) % len(STYLES)]
        _draw_curve(axes, curve, style, panel)
    axes.set_xscale("log" if panel.x.is_log else "linear")
    axes.set_yscale("log" if panel.y.is_log else "linear")
    _divide(axes.xaxis, panel.x)
    _divide(axes.yaxis, panel.y)
    if panel.y.limits:
        axes.set_ylim(*panel.y.limits)
    elif not panel.y.is_log:
        axes.set_ylim(bottom=0)
    if any(curve.notes for curve in panel.curves):
        axes.margins(y=0.14)  # room for what is written above the highest point
    title = f"{panel.title}\n{panel.note}" if panel.note else panel.title
    axes.set_title(title, fontsize=9)
    axes.grid(linewidth=0.3, color="0.8")
    axes.set_axisbelow(True)
    if panel.curves or panel.hatched:
        _draw_legend(axes, panel.legend)


def _draw_legend(axes: Axes, title: str) -> None:
    """A legend with each label once, however many curves have it."""
    handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    axes.legend(handles.values(), handles.keys(), title=title or None, **LEGEND)


def _draw_bars(axes: Axes, bars: Bars) -> None:
    """Parts on top of each other, one bar for each name."""
    places = range(len(bars.x.names))
    bottom = [0.0] * len(places)
    for part, heights in bars.parts.items():
        style = PART_STYLES[PART_COLOURS[part]]
        axes.bar(places, heights, 0.85, bottom, label=part, edgecolor="white", lw=0.3, **style)
        bottom = [low + height for low, height in zip(bottom, heights, strict=True)]
    axes.set_xticks(places, bars.x.names, fontsize=7)
    axes.set_xlabel(bars.x.label)
    axes.set_ylabel(bars.y.label)
    if bars.y.limits:
        axes.set_ylim(*bars.y.limits)
    axes.set_title(bars.title, fontsize=9)
    if bars.parts:
        axes.legend(fontsize=8, loc="upper right", framealpha=0.9)


def _draw_stated(axes: Axes, stated: Stated) -> None:
    corner = (stated.left, stated.low)
    width, height = stated.right - stated.left, stated.high - stated.low
    axes.add_patch(Rectangle(corner, width, height, label=stated.label or None, zorder=0, **STATED))


def _draw_hatched(axes: Axes, strip: Hatched) -> None:
    colour = STYLES[strip.style % len(STYLES)]["color"]
    corner, width, height = (
        (strip.left, strip.low),
        strip.right - strip.left,
        strip.high - strip.low,
    )
    looks: dict[str, Any] = {"facecolor": "none", "edgecolor": colour, "hatch": "////"}
    axes.add_patch(Rectangle(corner, width, height, zorder=0.5, linewidth=0.6, **looks))
    axes.plot([], [], color=colour, linestyle=":", linewidth=0.6, label=strip.label)


def _draw_curve(axes: Axes, curve: Curve, style: dict[str, Any], panel: Panel) -> None:
    """The mean as a line, the spread of the seeds as a band; or points with bars, if so wished."""
    xs = sorted(curve.points)
    spreads = [curve.points[x] for x in xs]
    means = [spread.mean for spread in spreads]
    if curve.is_guide:
        axes.plot(xs, means, label=curve.label, **style)
        return
    lows, highs = [spread.low for spread in spreads], [spread.high for spread in spreads]
    if curve.is_before:
        axes.plot(xs, means, label=curve.label, linewidth=5, alpha=0.3, color=style["color"])
        return
    if panel.x.names:
        axes.vlines(xs, lows, highs, color=style["color"], linewidth=1.2)
        style = style | {"linestyle": ""}
    if panel.has_bands:
        axes.fill_between(xs, lows, highs, color=style["color"], alpha=0.22, linewidth=0)
    axes.plot(xs, means, label=curve.label, linewidth=1.4, markersize=4, **style)
    if curve.floor:
        axes.fill_between(xs, curve.floor / FADE, curve.floor, color=style["color"], **FLOOR)
    for x, text in curve.notes.items():
        place = (x, curve.points[x].mean)
        axes.annotate(text, place, (3, 3), textcoords="offset points", fontsize=6.5)


def _divide(axis: Axis, scale: Scale) -> None:
    """Label an axis and choose its ticks."""
    axis.set_label_text(scale.label)
    if scale.is_log:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_minor_locator(NullLocator())
        axis.set_minor_formatter(NullFormatter())
    if scale.ticks:
        axis.set_major_locator(FixedLocator(list(scale.ticks)))
    if scale.names:
        axis.set_ticks(list(scale.ticks), list(scale.names))
    else:
        axis.set_major_formatter("{x:g}")
