"""Axes as plotly draws them: their ends, ticks and names."""

from __future__ import annotations

import html
import math
from dataclasses import replace
from typing import Any

from simmpp.plot.curves import LOG_MARGIN, Panel, Scale

LOG_STEPS, MOST_POWERS = (1, 2, 5), 4
Drawn = dict[str, Any]
"""A piece of a figure, as JSON data."""


def layout(x: Scale, y: Scale) -> Drawn:
    """What all panels have in common, with their axes."""
    return {"xaxis": _axis(x), "yaxis": _axis(y), "showlegend": False, "hovermode": "closest"}


def _axis(scale: Scale) -> Drawn:
    axis: Drawn = {
        "title": {"text": html.escape(scale.label)},
        "type": "log" if scale.is_log else "linear",
        "zeroline": False,
        "automargin": True,
        "rangemode": "normal" if scale.is_log else "tozero",
    }
    if ticks := scale.ticks or (_decades(*scale.limits) if scale.is_log and scale.limits else ()):
        texts = scale.names or [f"{tick:g}" for tick in ticks]
        axis |= {"tickvals": list(ticks), "ticktext": [html.escape(text) for text in texts]}
    if scale.ticks and scale.names:
        axis |= {"range": [-0.5, len(scale.names) - 0.5]}
    if scale.limits:
        axis |= {"range": [placed(end, scale) for end in scale.limits]}
    return axis


def _decades(low: float, high: float) -> list[float]:
    """1, 2 and 5 of each power of ten between the ends; only powers where these are many."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = LOG_STEPS if len(powers) <= MOST_POWERS else LOG_STEPS[:1]
    return [v for p in powers for step in steps if low <= (v := step * 10.0**p) <= high]


def limited(panel: Panel) -> Scale:
    """The vertical scale, with its ends where it is logarithmic: ticks are chosen by them."""
    spreads = [spread for curve in panel.curves for spread in curve.points.values()]
    if panel.y.limits or not panel.y.is_log or not spreads:
        return panel.y
    low, high = min(spread.low for spread in spreads), max(spread.high for spread in spreads)
    return replace(panel.y, limits=(low / LOG_MARGIN, high * LOG_MARGIN))


def placed(value: float, scale: Scale) -> float:
    """Where plotly places a remark: on a logarithmic axis by the logarithm."""
    return math.log10(value) if scale.is_log else value
