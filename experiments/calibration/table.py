"""The verdicts of every choice as a table of marks."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from simmpp.plot.matplotlib_panels import SETTINGS, save
from simmpp.studies.nebel98.verdict import DOES_NOT, HOLDS, IN_PART

MARKS: dict[str, dict[str, Any]] = {
    HOLDS: {"marker": "o", "color": "#0072b2", "s": 46},
    IN_PART: {"marker": "o", "facecolor": "#f0e442", "edgecolor": "0.3", "s": 46, "linewidth": 0.8},
    DOES_NOT: {"marker": "x", "color": "#d55e00", "s": 26, "linewidth": 1.3},
}
ROW_IN = 0.19
Row = Mapping[str, Any]


def draw(rows: Sequence[Row], claims: Sequence[str], stem: Path) -> None:
    """A line for every choice, a column for every claim; kinds of choices lie apart."""
    places: list[float] = []
    for before, row in zip([rows[0], *rows], rows, strict=False):
        step = 1.0 if row["kind"] == before["kind"] else 1.6
        places.append(places[-1] + step if places else 0.0)
    with matplotlib.rc_context(SETTINGS):
        height = ROW_IN * (places[-1] + 1) + 1.1
        figure = Figure(figsize=(10, height), layout="constrained")
        axes = figure.subplots()
        for word, style in MARKS.items():
            cells = [
                (n, place)
                for row, place in zip(rows, places, strict=True)
                for n, claim in enumerate(claims)
                if row[claim] == word
            ]
            axes.scatter(*zip(*cells, strict=True), label=word, **style)
        for row, place in zip(rows, places, strict=True):
            count = f"{row['n_holds']} + {row['n_in_part']}"
            axes.text(len(claims) - 0.3, place, count, fontsize=7.5, va="center")
        axes.text(len(claims) - 0.3, -1.5, "holds +\nin part", fontsize=7.5, va="center")
        axes.set_yticks(places, [short(row["choice"]) for row in rows], fontsize=7.5)
        axes.set_xticks(range(len(claims)), claims)
        axes.xaxis.tick_top()
        axes.set(xlim=(-0.6, len(claims) + 1.2), ylim=(places[-1] + 0.8, -0.8))
        axes.tick_params(length=0)
        axes.grid(axis="y", linewidth=0.3, color="0.85")
        axes.set_axisbelow(True)
        figure.legend(loc="outside lower center", ncols=3)
        save(figure, stem)


def short(name: str) -> str:
    """A choice without the sections of its keys, and the longest of them in fewer words."""
    name = re.sub(r"\b(machine|memory|picture|placement|policy)\.", "", name)
    name = re.sub(r"send_startup=(\d+) us; receive_startup=(\d+) us", r"startups \1 + \2 us", name)
    return name.replace("merge_requests=false; load_info=none", "unmerged, no load_info")
