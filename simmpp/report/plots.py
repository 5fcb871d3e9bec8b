"""Profit curves as pictures: the only import of matplotlib."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from simmpp.report.compare import DERIVED, NOT_KEYS

Row = Mapping[str, str]

MEASURES = {"time_profit": "time profit", "message_profit": "message profit"}
ABSCISSAS = ("fraction", "processors")
"""Preferred first, among the axes with most values."""
MOST_PANELS = 24
"""Rows of panels in one picture."""
COLOURS = 10
"""Colours of matplotlib's cycle."""


def overlay(baseline: Sequence[Row], now: Sequence[Row], path: Path) -> None:
    """Draw profit curves of now (lines) over those of the baseline (dashed, wide) as PNG."""
    abscissa = _abscissa([*baseline, *now])
    panels = list(dict.fromkeys(_panel(row, abscissa) for row in [*baseline, *now]))[:MOST_PANELS]
    figure = Figure(figsize=(11, 3.2 * max(1, len(panels))), layout="constrained")
    grid = figure.subplots(max(1, len(panels)), 2, squeeze=False)
    policies = list(dict.fromkeys(row["policy"] for row in [*baseline, *now]))
    for panel, pair in zip(panels, grid, strict=False):
        for axes, (measure, title) in zip(pair, MEASURES.items(), strict=True):
            for number, policy in enumerate(policies):
                for rows, style in ((baseline, _BASELINE), (now, _NOW)):
                    chosen = [
                        row
                        for row in rows
                        if row["policy"] == policy and _panel(row, abscissa) == panel
                    ]
                    _curve(axes, chosen, abscissa, measure, f"C{number % COLOURS}", style)
            _dress(axes, abscissa, title, panel)
    for number, policy in enumerate(policies):
        grid[0][1].plot([], [], color=f"C{number % COLOURS}", label=policy)
    grid[0][1].plot([], [], color="grey", label="baseline", **_BASELINE)
    grid[0][1].legend(fontsize="small")
    figure.savefig(path, format="png", dpi=110)


_BASELINE = {"linestyle": "--", "linewidth": 4.0, "alpha": 0.35}
_NOW = {"linestyle": "-", "linewidth": 1.3, "marker": "o", "markersize": 3.5}


def _abscissa(rows: Sequence[Row]) -> str:
    """The axis with most numeric values."""
    candidates = [name for name in (rows[0] if rows else {}) if name not in NOT_KEYS]
    candidates.sort(key=lambda name: ABSCISSAS.index(name) if name in ABSCISSAS else len(ABSCISSAS))
    numeric = [
        name for name in candidates if all(_number(row[name]) is not None for row in rows)
    ] or ["fraction"]
    return max(numeric, key=lambda name: len({row[name] for row in rows if name in row}))


def _panel(row: Row, abscissa: str) -> str:
    """What curves of one panel have in common."""
    keys = (name for name in row if name not in (*NOT_KEYS, *DERIVED, abscissa, "policy"))
    return ", ".join(row[name] if name == "scene" else f"{name} {row[name]}" for name in keys)


def _curve(
    axes: Axes,
    rows: Sequence[Row],
    abscissa: str,
    measure: str,
    colour: str,
    style: Mapping[str, object],
) -> None:
    points = sorted(
        (x, y)
        for x, y in ((_number(row[abscissa]), _number(row[measure])) for row in rows)
        if x is not None and y is not None and y > 0
    )
    if points:
        axes.plot(*zip(*points, strict=True), color=colour, **style)  # type: ignore[arg-type]


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _dress(axes: Axes, abscissa: str, title: str, panel: str) -> None:
    axes.set_yscale("log")
    axes.set_xscale("log")
    axes.axhline(1.0, color="black", linewidth=0.6)
    axes.set_xlabel(abscissa)
    axes.set_ylabel(title)
    axes.set_title(panel, fontsize="medium")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
