"""Panels as figures that plotly.js draws in a browser: the only import of plotly.

Figures are plain data in the form of plotly's schema; checking each by plotly's own classes takes
20 ms, so tests do that. Colours are names such as ``var(--c2)``: the page gives them values, in
light and in dark.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence

from simmpp.plot.curves import (
    PART_COLOURS,
    TILE,
    Bars,
    Curve,
    Drawable,
    Hatched,
    Layer,
    Panel,
    Spread,
    Stated,
    Tiles,
)
from simmpp.plot.plotly_axes import Drawn, layout, limited, placed

SYMBOLS = ("circle", "square", "triangle-up", "diamond", "triangle-down", "cross", "x")
DASHES = ("solid", "dash", "dashdot", "longdash", "dot", "longdashdot", "solid")
"""Curves differ by markers and lines too, as in print."""
N_COLOURS = len(SYMBOLS)


def script() -> str:
    """The library itself, as text of a script."""
    import plotly.offline

    return str(plotly.offline.get_plotlyjs())


def drawn(panel: Drawable) -> Drawn:
    """A panel as plotly.js takes it, with its title, and a text for those who don't see it."""
    if isinstance(panel, Tiles):
        drawing = _tiles(panel)
    else:
        drawing = _curves(panel) if isinstance(panel, Panel) else _bars(panel)
    return drawing | {"title": panel.title, "alt": alt_text(panel)}


def alt_text(panel: Drawable) -> str:
    """What a panel shows, for those who don't see it."""
    if isinstance(panel, Tiles):
        parts = [f"{layer.label} {len(layer.tiles)} of the tiles" for layer in panel.layers]
    elif isinstance(panel, Bars):
        parts = [f"{name} {_span(heights)}" for name, heights in panel.parts.items()]
    else:
        measured = [curve for curve in panel.curves if not curve.is_guide]
        parts = [f"{c.label} {_span(s.mean for s in c.points.values())}" for c in measured]
    of = f" ({panel.title})" if panel.title else ""
    return (
        f"{panel.y.label} over {panel.x.label or 'policies'}{of}: {'; '.join(parts) or 'nothing'}"
    )


def _span(values: Iterable[float]) -> str:
    numbers = list(values)
    return f"{min(numbers):.3g} to {max(numbers):.3g}" if numbers else "nothing"


def _curves(panel: Panel) -> Drawn:
    traces = [
        _guide(curve) if curve.is_guide else _line(curve, panel.style_of(curve) % N_COLOURS, panel)
        for curve in panel.curves
    ]
    traces = [*(_hatched(strip) for strip in panel.hatched), *traces]
    drawing = layout(panel.x, limited(panel))
    drawing["shapes"] = [_stated(stated) for stated in panel.stated]
    drawing["annotations"] = [_remark(stated, panel) for stated in panel.stated if stated.label]
    if panel.level is not None:
        drawing["shapes"].append(_level(panel.level))
    if any(curve.notes for curve in panel.curves):
        drawing["margin"] = {"t": 22, "r": 30}  # room for what stands beside the outermost points
    return {"data": traces, "layout": drawing}


def _hatched(strip: Hatched) -> Drawn:
    """A strip, which goes with the curve of its name; legends show the curve, if there is one."""
    style = strip.style % N_COLOURS
    return {
        "type": "scatter",
        "name": html.escape(strip.label),
        "legendgroup": strip.label,
        "x": [strip.left, strip.right, strip.right, strip.left],
        "y": [strip.low, strip.low, strip.high, strip.high],
        "mode": "lines",
        "line": {"color": f"var(--c{style})", "width": 1, "dash": "dot"},
        "fill": "toself",
        "fillpattern": {"shape": "/", "size": 7, "solidity": 0.2, "fgcolor": f"var(--c{style})"},
        "hoverinfo": "skip",
    }


def _guide(curve: Curve) -> Drawn:
    xs = sorted(curve.points)
    line = {"color": "var(--muted)", "width": 1.2, "dash": "dot"}
    ys = [curve.points[x].mean for x in xs]
    return _trace(curve) | {"x": xs, "y": ys, "mode": "lines", "line": line, "hoverinfo": "skip"}


def _line(curve: Curve, style: int, panel: Panel) -> Drawn:
    """A curve; the page adds its band, and what is said of a point, from low and high."""
    xs = sorted(curve.points)
    spreads = [curve.points[x] for x in xs]
    line: Drawn = {"color": f"var(--c{style})", "width": 2, "dash": DASHES[style]}
    if curve.is_before:
        line = {"color": f"var(--b{style})", "width": 8}
    mode = "markers" if panel.x.names else "lines" if curve.is_before else "lines+markers"
    ends = {"low": _short(s.low for s in spreads), "high": _short(s.high for s in spreads)}
    return _trace(curve) | {
        "x": xs,
        "y": _short(spread.mean for spread in spreads),
        "customdata": [curve.rows.get(x) for x in xs],
        "meta": ends | ({"band": f"var(--b{style})"} if panel.has_bands else {}),
        "mode": mode,
        "line": line,
        "marker": _markers(curve, xs, style),
        **(_ends(spreads) if panel.x.names and any(s.low < s.high for s in spreads) else {}),
        **(_noted(curve, xs) if curve.notes else {}),
    }


def _noted(curve: Curve, xs: list[float]) -> Drawn:
    """The notes of a curve, to the upper right of their points."""
    notes = [html.escape(curve.notes.get(x, "")).replace("\n", "<br>") for x in xs]
    style = {"textposition": "top right", "textfont": {"size": 11, "color": "var(--muted)"}}
    return {"mode": "lines+markers+text", "text": notes, "cliponaxis": False, **style}


def _short(values: Iterable[float]) -> list[float]:
    """Without digits that no picture shows."""
    return [float(f"{value:.7g}") for value in values]


def _markers(curve: Curve, xs: list[float], style: int) -> Drawn:
    """Markers, with a ring around those to be looked at."""
    colour = f"var(--{'b' if curve.is_before else 'c'}{style})"
    marker: Drawn = {"color": colour, "size": 8, "symbol": SYMBOLS[style], "opacity": 1}
    if curve.marked:
        marker["size"] = [12 if x in curve.marked else 8 for x in xs]
        widths = [2 if x in curve.marked else 0 for x in xs]
        marker["line"] = {"color": "var(--ink)", "width": widths}
    return marker


def _ends(spreads: Sequence[Spread]) -> Drawn:
    """Bars from low to high, where no band can be drawn."""
    up = _short(spread.high - spread.mean for spread in spreads)
    down = _short(spread.mean - spread.low for spread in spreads)
    bars = {"type": "data", "symmetric": False, "array": up, "arrayminus": down, "thickness": 1.2}
    return {"error_y": bars | {"visible": True}}


def _trace(curve: Curve) -> Drawn:
    return {"type": "scatter", "name": html.escape(curve.label), "legendgroup": curve.label}


def _stated(stated: Stated) -> Drawn:
    """What the paper's text states, behind the curves."""
    return {
        "type": "rect",
        "x0": stated.left,
        "x1": stated.right,
        "y0": stated.low,
        "y1": stated.high,
        "fillcolor": "var(--stated)",
        "line": {"color": "var(--stated-line)", "width": 1},
        "layer": "below",
    }


def _remark(stated: Stated, panel: Panel) -> Drawn:
    return {
        "x": placed(stated.right, panel.x),
        "y": placed(stated.high, panel.y),
        "text": html.escape(stated.label).replace("\n", "<br>"),
        "showarrow": False,
        "xanchor": "right",
        "yanchor": "bottom",
        "font": {"color": "var(--muted)"},
    }


def _level(value: float) -> Drawn:
    line = {"color": "var(--muted)", "width": 1}
    ends = {"xref": "paper", "x0": 0, "x1": 1, "y0": value, "y1": value}
    return {"type": "line", **ends, "line": line, "layer": "below"}


def _bars(bars: Bars) -> Drawn:
    axes = layout(bars.x, bars.y) | {"barmode": "stack", "bargap": 0.15}
    names = [html.escape(name) for name in bars.x.names]
    places = list(range(len(names)))
    axes["xaxis"] |= {"tickvals": places, "ticktext": names}
    traces = [
        {
            "type": "bar",
            "name": part,
            "legendgroup": part,
            "x": places,
            "y": _short(heights),
            "customdata": bars.rows,
            "marker": {"color": f"var(--p{PART_COLOURS[part]})", "line": {"width": 0}},
        }
        for part, heights in bars.parts.items()
    ]
    return {"data": traces, "layout": axes}


def _tiles(tiles: Tiles) -> Drawn:
    """Bars of height 1 that begin where their tile does."""
    axes = layout(tiles.x, tiles.y) | {"barmode": "overlay"}
    return {"data": [_layer(layer) for layer in tiles.layers], "layout": axes}


def _layer(layer: Layer) -> Drawn:
    marker: Drawn = {"color": f"var(--c{(layer.style or 0) % N_COLOURS})", "line": {"width": 0}}
    if layer.style is None:
        pattern = {"shape": "/", "size": 8, "solidity": 0.2, "fgcolor": "var(--muted)"}
        marker |= {"color": "var(--stated-line)", "pattern": pattern | {"bgcolor": "rgba(0,0,0,0)"}}
    return {
        "type": "bar",
        "name": html.escape(layer.label),
        "legendgroup": layer.label,
        "x": [tile.x for tile in layer.tiles],
        "y": [TILE] * len(layer.tiles),
        "base": [tile.y - TILE / 2 for tile in layer.tiles],
        "width": [TILE] * len(layer.tiles),
        "customdata": [tile.row for tile in layer.tiles],
        "text": [
            f"<b>{html.escape(layer.label)}</b><br>{html.escape(t.text)}" for t in layer.tiles
        ],
        "marker": marker,
    }
