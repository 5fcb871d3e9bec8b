"""What the makespan consists of and what PEs send, for each point of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from simmpp.plot.curves import PERCENT, Bars, Scale
from simmpp.report.page import scales
from simmpp.report.page.arrangement import abscissas, arrange, plates
from simmpp.report.page.figures.figure import Figure, styles_of
from simmpp.report.page.limits import PointLimits
from simmpp.run import words
from simmpp.sweeps.winners.points import Points

STEMS = ACCOUNTS_STEM, MESSAGES_STEM = ("accounts-by-policy", "messages-by-kind")
BAR_HEADROOM = 1.02
"""Of a panel above its highest bar, as a factor."""


def bar_figures(limits: PointLimits) -> Iterator[Figure]:
    """Parts of the makespan and messages along the best axis, one panel for each policy."""
    points = limits.points
    yield bar_figure(
        points,
        ACCOUNTS_STEM,
        "What the makespan consists of",
        "means over PEs and seeds; compute is the bound, which no dataflow changes",
        "share of the makespan (%)",
        lambda number: {k: v * PERCENT for k, v in limits.shares(number).items()},
    )
    yield bar_figure(
        points,
        MESSAGES_STEM,
        "Messages by kind",
        "means over seeds; the same scale for all policies",
        "messages",
        points.messages,
    )


def bar_figure(
    points: Points,
    stem: str,
    title: str,
    note: str,
    label: str,
    heights_of: Callable[[int], dict[str, float]],
    along: str = "",
) -> Figure:
    """Stacked bars along an axis, the best if none is given; a point without heights has none."""
    along = along or abscissas(points.axes)[0]
    facet = None if along == "policy" else "policy"
    arrangement = arrange(points.profits, points.axes, along, facet)
    x = scales.abscissa(along, list(arrangement.values))[0]
    styles = {words.policy(title): n for title, n in styles_of(points.profits).items()}
    bars_of: dict[str, list[Bars]] = {}
    for plate, panels in plates(points.profits, arrangement).items():
        drawn = {
            panel: {
                n: heights
                for n, _ in numbered
                if n not in points.repeated and (heights := heights_of(n))
            }
            for panel, numbered in panels.items()
        }
        sums = [sum(heights.values()) for bars in drawn.values() for heights in bars.values()]
        y = Scale(label, limits=(0, (max(sums, default=0) or 1) * BAR_HEADROOM))
        bars_of[plate] = []
        for panel in sorted(panels, key=lambda panel: styles.get(panel, 0)):
            numbers = list(drawn[panel])
            names = tuple(scales.label(along, points.at(n, along)) for n in numbers)
            parts = _parts(list(drawn[panel].values()))
            bars_of[plate].append(Bars(panel, Scale(x.label, names=names), y, parts, numbers))
    return Figure(stem, title, note, bars_of)


def _parts(bars: list[dict[str, float]]) -> dict[str, list[float]]:
    """Heights by part, from those of each bar; a bar may lack parts that others have."""
    names = dict.fromkeys(part for bar in sorted(bars, key=len, reverse=True) for part in bar)
    return {part: [bar.get(part, 0.0) for bar in bars] for part in names}
