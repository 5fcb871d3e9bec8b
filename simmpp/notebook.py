"""How results show themselves: a table, a picture, and where the page of their folder is."""

from __future__ import annotations

import html as markup
from base64 import b64encode
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.common.units import counted, format_bytes, format_ps
from simmpp.engine.result import Result
from simmpp.plot.curves import PERCENT, Bars, Drawable, Panel, Scale
from simmpp.plot.matplotlib_panels import Drawing, drawing
from simmpp.policy.parameters import REFERENCE
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.figures.stills import titled
from simmpp.report.page.folder import further_of
from simmpp.report.page.report import PAGE
from simmpp.run import words
from simmpp.sweeps.profits import MEASURES
from simmpp.sweeps.sweep import SweepResult
from simmpp.sweeps.winners.points import ACCOUNTS, KINDS, points_of

MOST_BARS, MOST_NAMES = 64, 8
"""Bars of a result, each of as many PEs as it takes, and how many of them have their names."""
MOST_ROWS = 40
"""Of a sweep's table."""
EXACT = "{:,}".format
WIDTH = "max-width: 100%"


def plot(shown: Result | SweepResult) -> Drawing:
    """A figure of what is shown; ConfigError if there is nothing in it."""
    panels = _panels(shown)
    if not panels:
        raise ConfigError("nothing to plot: expected at least one point that did not fail")
    return drawing(panels)


def html(shown: Result | SweepResult) -> str:
    """A piece of a page that needs nothing else."""
    parts = [_table(shown) if isinstance(shown, Result) else _profits(shown)]
    if panels := _panels(shown):
        png = b64encode(drawing(panels)._repr_png_()).decode()
        alt = markup.escape("; ".join(panel.title.split("\n")[0] for panel in panels))
        parts.append(f'<img alt="{alt}" style="{WIDTH}" src="data:image/png;base64,{png}">')
    return "\n".join([*parts, *_links(shown)])


def _panels(shown: Result | SweepResult) -> Sequence[Drawable]:
    return [_accounts(shown)] if isinstance(shown, Result) else list(_curves(shown))


def _links(shown: Result | SweepResult) -> Iterator[str]:
    """To the page of the folder, or how to make it."""
    if isinstance(shown, SweepResult) and shown.folder is not None:
        page = markup.escape(str(shown.folder / PAGE))
        if (shown.folder / PAGE).is_file():
            yield f'<p><a href="{page}">{page}</a></p>'
        else:
            command = markup.escape(f"simmpp report {shown.folder}")
            yield f"<p><code>{command}</code> makes {page}</p>"


# --- a result: what its PEs spend their time with ---


def _table(result: Result) -> str:
    busy = (result.compute_ps + result.communication_ps) / max(result.makespan_ps, 1)
    cells = {
        "makespan": format_ps(result.makespan_ps),
        "messages": EXACT(result.messages),
        **{f"of {kind}": EXACT(getattr(result, column)) for kind, column in KINDS.items()},
        "bytes sent": format_bytes(result.bytes_sent),
        "rays": EXACT(result.rays),
        "rays sent": EXACT(result.rays_sent),
        "tests": EXACT(result.tests),
        "utilisation, least": f"{busy.min():.1%}",
        "utilisation, mean": f"{busy.mean():.1%}",
        "utilisation, most": f"{busy.max():.1%}",
        "most rays on a PE": EXACT(result.peak_rays),
        "most bytes on a PE": format_bytes(result.peak_bytes),
    }
    return str(pandas.Series(cells).to_frame(result.policy).to_html())


def _accounts(result: Result) -> Bars:
    """A bar for each PE, or for neighbours together where there are too many."""
    nb = len(result.compute_ps)
    each = -(-nb // MOST_BARS)
    starts = np.arange(0, nb, each)
    named_every = -(-len(starts) // MOST_NAMES)
    names = tuple(str(pe) if n % named_every == 0 else "" for n, pe in enumerate(starts))
    label = "PE" if each == 1 else f"first of {each} neighbouring PEs, whose mean is shown"
    shares = {
        name: _means(getattr(result, column), starts) * PERCENT / max(result.makespan_ps, 1)
        for name, column in ACCOUNTS.items()
    }
    return Bars(
        f"{words.policy(result.policy)}: {format_ps(result.makespan_ps)}",
        Scale(label, names=names),
        Scale("share of the makespan (%)", limits=(0, PERCENT)),
        {name: heights.tolist() for name, heights in shares.items()},
    )


def _means(of_pes: NDArray[np.int64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Means of neighbours, from each start to the next."""
    counts = np.diff(starts, append=len(of_pes))
    return np.asarray(np.add.reduceat(of_pes, starts) / counts, np.float64)


# --- a sweep: its profits ---


def _profits(result: SweepResult) -> str:
    """The keys that differ, and the mean profits with their intervals; the reference has none."""
    profits = [row for row in _rows(result.profits) if row["policy"] != REFERENCE]
    columns = list(result.profits.columns)
    keys = [key for key in columns[: columns.index("n")] if _tells(key, profits)]
    shown = pandas.DataFrame(
        [
            [
                *(words.value(key, row[key]) for key in keys),
                row["n"],
                *map(_interval, [row] * 2, MEASURES),
            ]
            for row in profits[:MOST_ROWS]
        ],
        columns=[*keys, "seeds", *(measure.replace("_", " ") for measure in MEASURES)],
    )
    failed = int(result.rows["error"].notna().sum())
    more = [f"{len(profits) - MOST_ROWS} more profits"] if len(profits) > MOST_ROWS else []
    text = ", ".join([counted(len(result.rows), "row"), f"{failed} failed", *more])
    return f"{shown.to_html(index=False)}\n<p>{text}</p>"


def _tells(key: str, profits: Sequence[Row]) -> bool:
    several = len({row[key] for row in profits}) > 1
    return key == "policy" or (several and key != "effective_fraction")


def _interval(row: Row, measure: str) -> str:
    """A mean, with its 95 % interval where there is one."""
    mean, low, high = (row[measure + end] for end in ("", "_low", "_high"))
    if not words.is_finite(mean):
        return str(mean)
    return f"{mean:.3f} ({low:.3f} to {high:.3f})" if words.is_finite(low) else f"{mean:.3f}"


def _curves(result: SweepResult) -> Iterator[Drawable]:
    """Both profits along the best axis; the plate that shows most."""
    rows = _rows(result.rows)
    points = points_of(rows, further_of(rows), _rows(result.profits))
    figures = [*profit_figures(ProfitData(points))]
    first = {figure.stem.split("-over-")[0]: figure for figure in reversed(figures)}
    there = (first.get(measure.replace("_", "-")) for measure in MEASURES)
    for figure in filter(None, there):
        plate = list(figure.plates)[figure.first] if figure.plates else ""
        for panel in figure.plates.get(plate, ()):
            if isinstance(panel, Panel) and panel.curves:
                yield titled(replace(panel, note=figure.note), figure, plate)


def _rows(table: pandas.DataFrame) -> list[dict[Any, Any]]:
    """A table's rows, as files have them: what is not there is empty."""
    return table.astype(object).where(table.notna(), "").to_dict("records")
