"""What PEs spend their time with and what they send, for each point of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from simmpp.plot.curves import PERCENT, Bars, Scale
from simmpp.report.page import words
from simmpp.report.page.arrangement import abscissas, arrange, plates
from simmpp.report.page.figure import Figure, styles_of
from simmpp.report.page.points import Points

STEMS = ACCOUNTS_STEM, MESSAGES_STEM = ("accounts-by-policy", "messages-by-kind")
MARGIN = 1.02


def bar_figures(points: Points) -> Iterator[Figure]:
    """Accounts and messages along the best axis, one panel for each policy."""
    yield _figure(
        points,
        ACCOUNTS_STEM,
        "What PEs spend their time with",
        "shares of the time of all PEs, all seeds together",
        Scale("share of time (%)"),
        lambda number: {k: v * PERCENT for k, v in points.shares(number).items()},
    )
    yield _figure(
        points,
        MESSAGES_STEM,
        "Messages by kind",
        "means over seeds; the same scale for all policies",
        Scale("messages"),
        points.messages,
    )


def _figure(
    points: Points,
    stem: str,
    title: str,
    note: str,
    y: Scale,
    heights: Callable[[int], dict[str, float]],
) -> Figure:
    along = abscissas(points.axes)[0]
    facet = None if along == "policy" else "policy"
    arrangement = arrange(points.profits, points.axes, along, facet)
    label = words.abscissa(along, list(arrangement.values))[0].label
    bars_of: dict[str, list[Bars]] = {}
    for plate, panels in plates(points.profits, arrangement).items():
        numbers_of = {panel: [n for n, _ in panels[panel] if heights(n)] for panel in panels}
        most = max((sum(heights(n).values()) for ns in numbers_of.values() for n in ns), default=1)
        for panel in sorted(panels, key=_colour_order(points)):
            names = tuple(words.label(along, points.profits[n][along]) for n in numbers_of[panel])
            parts = _parts([heights(number) for number in numbers_of[panel]])
            scale = replace(y, limits=(0, most * MARGIN))
            bars = Bars(panel, Scale(label, names=names), scale, parts, numbers_of[panel])
            bars_of.setdefault(plate, []).append(bars)
    return Figure(stem, title, note, bars_of)


def _colour_order(points: Points) -> Callable[[str], int]:
    """Panels of policies come in the order of their colours."""
    styles = {words.policy(title): n for title, n in styles_of(points.profits).items()}
    return lambda panel: styles.get(panel, 0)


def _parts(bars: list[dict[str, float]]) -> dict[str, list[float]]:
    """Heights by part, from those of each bar."""
    return {part: [bar[part] for bar in bars] for part in (bars[0] if bars else ())}
