"""``advise.html``: the sentences, three pictures with one sentence each, all candidates."""

from __future__ import annotations

from pathlib import Path

from simmpp.common.files import Row, write_text
from simmpp.common.units import format_bytes, format_ps
from simmpp.report.advice.figures import advice_figures
from simmpp.report.page.figures.figure import figure_data
from simmpp.report.page.template import rendered
from simmpp.studies.advise.advice import Advice
from simmpp.studies.advise.candidates import capacity_of
from simmpp.studies.advise.memory_map import Place
from simmpp.studies.advise.table import CANNOT_WIN
from simmpp.studies.advise.told import rounded_time

PAGE = "advise.html"


def write_advice_page(advice: Advice, places: list[Place], folder: Path) -> Path:
    """Write the page; it opens in any browser and loads nothing."""
    figures = list(advice_figures(advice, places))
    config = advice.config
    values = {
        "title": f"Advice for {advice.scene}",
        "facts": [
            f"machine {config.preset}",
            f"{format_bytes(capacity_of(config))} a node",
            f"goal {_goal(advice)}",
        ],
        "live": "",
        "sections": [
            ("summary", "Advice"),
            *((figure.stem, figure.title) for _, figure in figures),
            ("candidates", "All candidates"),
        ],
        "sentences": advice.sentences,
        "settings": advice.settings,
        "figures": figures,
        "candidates": [_line(row) for row in advice.rows],
        "made": "Made by simmpp advise; nothing is loaded from anywhere.",
        "data": {"figures": {figure.stem: figure_data(figure) for _, figure in figures}},
    }
    path = folder / PAGE
    write_text(rendered("advise.html", values), path)
    return path


def _goal(advice: Advice) -> str:
    goal = advice.asked.goal
    return goal if isinstance(goal, str) else f"least nodes within {format_ps(goal)}"


def _fate(row: Row) -> str:
    """With the reason, where none would be seen."""
    at_least = f": takes at least {rounded_time(row['bound_ps'])}" if row["bound_ps"] != "" else ""
    return f"{row['fate']}{at_least if row['fate'] == CANNOT_WIN else ''}"


def _line(row: Row) -> dict[str, str]:
    """A candidate for people."""
    time = row["makespan_ps"]
    good = row["as_good"]
    return {
        "candidate": f"{row['candidate']}{' (advised)' if row['advised'] else ''}",
        "nodes": str(row["processors"]),
        "makespan": rounded_time(time) if time != "" else "",
        "seeds": str(row["seeds"]),
        "what became of it": _fate(row),
        "as good as the best": f"{good:.0%}" if good != "" else "",
        "least memory": format_bytes(row["least_bytes"]),
        "lacks": format_bytes(row["lacking_bytes"]) if row["lacking_bytes"] else "",
    }
