"""Results show themselves: numbers of the table, heights of the bars, the curves, the link."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import simmpp
from simmpp import notebook
from simmpp.common.code.source import closure
from simmpp.common.errors import ConfigError
from simmpp.common.modules import METHODS
from simmpp.plot.curves import Panel
from simmpp.sweeps.sweep import SweepResult

HOSTILE = '<script>alert("1")</script>'
CONFIG = {
    "scene": "tetra:3",
    "picture": {"resolution": 8},
    "seeds": [0, 1],
    "sweep": {"memory.fraction": ["20%", "60%"], "processors": [2, 4]},
}


def result(nb: int, policy: str = "ray") -> simmpp.Result:
    """PE k of nb computes for k ps and communicates for 1 ps of 2 nb."""
    compute_ps, ones = np.arange(nb, dtype=np.int64), np.ones(nb, np.int64)
    return simmpp.Result(
        policy=policy, engine="compiled", makespan_ps=2 * nb, messages_by_kind=(1, 20, 300, 4000),
        parts_by_kind=(1, 20, 300, 4000), messages_received=4321, bytes_sent=64_000, rays=7,
        tests=12_345, rays_sent=6, compute_ps=compute_ps, communication_ps=ones,
        waiting_ps=2 * nb - compute_ps - ones, service_ps=0 * ones,
        pe_peak_rays=compute_ps, pe_peak_bytes=compute_ps,
        pe_peak_object_bytes=compute_ps, events=9,
    )  # fmt: skip


def cells(html: str) -> list[str]:
    return [unescape(cell) for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", html)]


@pytest.fixture(scope="module")
def swept() -> SweepResult:
    return simmpp.sweep(CONFIG)


def test_the_table_of_a_result() -> None:
    html = result(4)._repr_html_()
    assert cells(html) == [
        *("", "ray", "makespan", "8 ps", "messages", "4,321"),
        *("of requests", "1", "of objects", "20", "of rays", "300", "of loads", "4,000"),
        *("bytes sent", "64 kB", "rays", "7", "rays sent", "6", "tests", "12,345"),
        *(
            "utilisation, least",
            "12.5%",
            "utilisation, mean",
            "31.2%",
            "utilisation, most",
            "50.0%",
        ),
        *("most rays on a PE", "3", "most bytes on a PE", "3 B"),
    ]
    assert html.count("<img") == 1 and 'alt="ray dataflow: 8 ps"' in html


def test_a_bar_for_each_pe() -> None:
    bars = notebook._accounts(result(4))
    assert bars.parts == {
        "compute": [0.0, 12.5, 25.0, 37.5],
        "communication": [12.5] * 4,
        "waiting": [87.5, 75.0, 62.5, 50.0],
    }
    assert bars.x.names == ("0", "1", "2", "3") and bars.x.label == "PE"


@pytest.mark.parametrize(("nb", "each", "bars"), [(64, 1, 64), (65, 2, 33), (1000, 16, 63)])
def test_bars_of_neighbours_where_there_are_many(nb: int, each: int, bars: int) -> None:
    panel = notebook._accounts(result(nb))
    expected = [np.mean(range(n, min(n + each, nb))) * 100 / (2 * nb) for n in range(0, nb, each)]
    assert panel.parts["compute"] == pytest.approx(expected, rel=1e-14)
    assert len(expected) == len(panel.x.names) == bars
    assert np.sum(list(panel.parts.values()), axis=0) == pytest.approx([100.0] * bars)
    named = [int(name) for name in panel.x.names if name]
    assert named == list(range(0, nb, named[1])) and named[1] % each == 0 and len(named) <= 8


def test_a_plot_is_a_figure_that_notebooks_show(tmp_path: Path) -> None:
    figure = result(3).plot()
    assert isinstance(figure, Figure)
    assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]
    figure.savefig(tmp_path / "bars.svg")


def test_names_are_text(tmp_path: Path, swept: SweepResult) -> None:
    folder = tmp_path / "<b>"
    named = replace(swept, folder=folder, profits=swept.profits.replace("concurrent", HOSTILE))
    for html in (result(2, HOSTILE)._repr_html_(), named._repr_html_()):
        assert "<script" not in html and "<b>" not in html


def test_the_curves_of_a_sweep_are_its_profits(swept: SweepResult) -> None:
    panels = [panel for panel in notebook._curves(swept) if isinstance(panel, Panel)]
    titles = [f"{kind} profit: {nb} PEs" for kind in ("Time", "Message") for nb in (2, 4)]
    assert [panel.title for panel in panels] == titles
    rows = swept.rows.set_index(["processors", "policy", "effective_fraction", "seed"]).sort_index()
    for panel, (column, nb) in zip(
        panels, [(m, nb) for m in ("makespan_ps", "messages") for nb in (2, 4)], strict=True
    ):
        for curve in panel.curves:
            of_policy = rows[column].loc[nb, curve.label.removesuffix(" dataflow")]
            ratios = np.log(rows[column].loc[nb, "object"] / of_policy)
            expected = np.exp(ratios.groupby("effective_fraction").mean())
            shown = {x: spread.mean for x, spread in curve.points.items()}
            assert shown == pytest.approx({x * 100: mean for x, mean in expected.items()})
        assert {curve.label for curve in panel.curves} >= {"object dataflow", "concurrent dataflow"}
        assert "geometric means of 2 seeds, bands are 95 % intervals" in panel.note
    assert len(swept.plot().axes) == 4


def test_the_table_of_a_sweep(swept: SweepResult) -> None:
    html = swept._repr_html_()
    table = cells(html)
    assert table[:6] == [
        "processors",
        "fraction",
        "policy",
        "seeds",
        "time profit",
        "message profit",
    ]
    others = swept.profits[swept.profits["policy"] != "object"]
    assert len(table) == 6 * (1 + len(others))
    first = others.iloc[0]
    ends = f"({first.time_profit_low:.3f} to {first.time_profit_high:.3f})"
    assert table[6:11] == ["2", "20 %", first.policy, "2", f"{first.time_profit:.3f} {ends}"]
    assert f"<p>{len(swept.rows)} rows, 0 failed</p>" in html


def test_the_page_of_the_folder(tmp_path: Path, swept: SweepResult) -> None:
    kept = replace(swept, folder=tmp_path)
    page = tmp_path / "report.html"
    (how,) = notebook._links(kept)
    assert f"<code>simmpp report {tmp_path}</code>" in how
    page.write_text("", encoding="utf-8")
    assert list(notebook._links(kept)) == [f'<p><a href="{page}">{page}</a></p>']
    assert list(notebook._links(swept)) == []


def test_a_sweep_of_which_all_failed() -> None:
    failed = simmpp.sweep({**CONFIG, "sweep": {}}, timeout_s=1e-9)
    assert f"{len(failed.rows)} failed" in failed._repr_html_()
    assert "<img" not in failed._repr_html_()
    with pytest.raises(ConfigError, match="nothing to plot: expected at least one point"):
        failed.plot()


def test_what_draws_results_does_not_decide_them() -> None:
    deciding = closure(METHODS)
    assert "simmpp.engine.result" in deciding
    assert not [name for name in deciding if name.startswith(("simmpp.notebook", "simmpp.plot"))]
