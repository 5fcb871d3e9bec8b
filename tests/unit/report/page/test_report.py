"""The page itself: whole, alone, and not to be broken by what it shows."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from sweep_rows import failed, row, sweep, written

from simmpp.common.files import write_csv
from simmpp.methods.columns import NUMBERS, result_columns
from simmpp.plot.plotly_panels import script
from simmpp.report.page.beside import beside
from simmpp.report.page.depth import depth_of
from simmpp.report.page.figures.paper import paper_figures
from simmpp.report.page.folder import Folder, read_folder
from simmpp.report.page.limits import PointLimits, limits_of_points
from simmpp.report.page.report import report_of, write_page
from simmpp.studies.bench.errors import bench_columns
from simmpp.studies.nebel98.figures import FIGURES
from simmpp.sweeps.profits import profit_columns, profit_rows
from simmpp.sweeps.winners.points import Points, points_of

NEBEL98 = Path(__file__).parents[4] / "experiments" / "nebel98" / "plain"
HOSTILE = '</script><script>document.title="broken"</script>" \' & {{ 7 * 7 }} <!--'


class Page(HTMLParser):
    """The elements and texts of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text, self.scripts, self._in = "", [""], ""
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._in = tag
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        self._in = ""

    def handle_data(self, data: str) -> None:
        if self._in == "script":
            self.scripts[-1] += data
        elif self._in != "style":
            self.text += data

    @property
    def data(self) -> Any:
        return json.loads(next(s for s in self.scripts if s.startswith('{"figures"')))


def page_of(folder: Path, **options: Any) -> Page:
    return Page(write_page(report_of(read_folder(folder)), **options))


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Page:
    rows = sweep(fraction=[0.1, 0.5, 1.0], processors=[8, 64])
    return page_of(written(tmp_path_factory.mktemp("plain"), [*rows, failed("late", 0)]))


def depth_in(points: Points) -> dict[str, Any]:
    return depth_of(points, PointLimits(points, {}))


def test_a_page_loads_nothing(plain: Page) -> None:
    """No element names a resource, and the browser is told to refuse any that a script wants."""
    loading = [(tag, a) for tag, a in plain.tags if tag in {"link", "iframe", "object", "base"}]
    assert loading == []
    assert all("src" not in a for _, a in plain.tags)
    links = [str(a["href"]) for tag, a in plain.tags if tag == "a"]
    assert all(re.match("(#|figures/)", link) for link in links)
    (policy,) = [a["content"] for tag, a in plain.tags if "http-equiv" in a]
    assert str(policy).startswith("default-src 'none'; script-src 'unsafe-inline';")


def test_each_section_that_is_named_is_there(plain: Page) -> None:
    ids = [a["id"] for _, a in plain.tags if "id" in a]
    assert len(set(ids)) == len(ids)
    assert {
        a["href"]
        for tag, a in plain.tags
        if tag == "a" and "href" in a and str(a["href"])[0] == "#"
    } <= {f"#{each}" for each in ids}


def test_failed_rows_are_told(plain: Page) -> None:
    assert "1 row failed: took too long" in plain.text


def test_all_figures_are_data_of_the_page(plain: Page) -> None:
    shown = {a["data-figure"] for _, a in plain.tags if "data-figure" in a}
    assert shown == set(plain.data["figures"])
    assert {"time-profit", "speedup", "accounts-by-policy"} <= shown


def test_labels_break_nothing(plain: Page, tmp_path: Path) -> None:
    rows = [
        row(policy, scene=scene, **{HOSTILE: value})
        for policy in ("object", HOSTILE)
        for scene in ("s", HOSTILE)
        for value in (1, HOSTILE)
    ]
    bad = page_of(written(tmp_path / "x", rows, (HOSTILE,)))
    assert len(bad.scripts) == len(plain.scripts)
    assert HOSTILE in bad.text
    assert HOSTILE in bad.data["depth"]["policies"]


def test_every_integer_of_every_row_is_in_the_page() -> None:
    rows = [*sweep(fraction=[0.1, 1.0]), failed("ray", 7)]
    points = points_of(rows, ())
    depth = depth_in(points)
    found = []
    for n, number in enumerate(depth["rows"]["point"]):
        title = points.profits[number]["policy"]
        cells = {name: int(depth["rows"][name][n]) for name in ("seed", *NUMBERS)}
        found.append((title, points.profits[number]["fraction"], cells))
    expected = [
        (r["policy"], r["fraction"], {name: r[name] for name in ("seed", *NUMBERS)})
        for r in rows
        if not r["error"]
    ]
    assert sorted(found, key=str) == sorted(expected, key=str)
    assert json.loads(json.dumps(depth, allow_nan=False)) == depth


def test_integers_beyond_those_of_javascript_keep_their_digits() -> None:
    depth = depth_in(points_of([row(makespan_ps=2**53 - 1, waiting_ps=2**53 + 1)], ()))
    assert depth["rows"]["makespan_ps"] == [9007199254740991]
    assert depth["rows"]["waiting_ps"] == ["9007199254740993"]


@pytest.mark.parametrize("rows", [[], [failed()]])
def test_a_page_without_results_says_so(tmp_path: Path, rows: list[Any]) -> None:
    page = page_of(written(tmp_path, rows))
    assert "No point has a result." in page.text
    assert page.data["figures"] == {}


def test_only_a_page_of_a_running_sweep_reloads_itself(tmp_path: Path) -> None:
    written(tmp_path, sweep(fraction=[0.1, 1.0]))
    (tmp_path / "run.json").write_text('{"points": 100}')
    running, done = page_of(tmp_path, is_running=True), page_of(tmp_path)
    assert "running: 24 of 100 rows done" in running.text
    assert any("location.reload" in text for text in running.scripts if text not in script())
    assert not any("location.reload" in text for text in done.scripts if text not in script())


def test_a_place_is_told_with_what_its_pes_hold() -> None:
    rows = [row(processors=n, fraction=0.2, effective_fraction=0.25) for n in (4, 8)]
    assert depth_in(points_of(rows, ()))["places"] == ["4 PEs (PEs hold 25 %)", "8 PEs"]


def test_rows_of_experiments_that_pack_lie_beside_rows_of_others() -> None:
    rows = [row(processors=2), row(processors=4) | {"request_parts": 5}]
    depth = depth_in(points_of(rows, ()))
    assert depth["rows"]["request_parts"] == ["", 5]


def test_figures_of_the_paper_are_there_where_the_rows_are_those_of_its_experiments() -> None:
    reproduced = read_folder(NEBEL98)
    figures = paper_figures(reproduced, points_of(reproduced.rows, ()))
    assert [figure.stem for figure in figures] == list(FIGURES)
    four = Folder(Path("x"), list(reproduced.experiments["figure4"]))
    points = points_of(four.rows, ())
    figure4, figure5 = paper_figures(four, points)
    assert (figure4.stem, figure5.stem) == ("figure4", "figure5")
    (panel,) = figure4.plates[""]
    assert len(panel.stated) == 2  # the paper's two ranges
    for curve in panel.curves:
        for x, number in curve.rows.items():
            assert points.profits[number]["time_profit"] == pytest.approx(curve.points[x].mean)
    part = Folder(Path("x"), [r for r in four.rows if r["scene"] != "tetra:6"])
    assert paper_figures(part, points_of(part.rows, ())) == []


def test_the_claims_of_a_reproduction_come_first(tmp_path: Path) -> None:
    rows = sweep(scene=["tetra:5"], processors=[8, 128], fraction=[0.1, 0.8, 1.0])
    write_csv(rows, result_columns(), tmp_path / "figure3.csv")
    (tmp_path / "claims.csv").write_text(
        "claim,paper,simulated,holds,by\nF3a,<b>,1 > 0,in part,x\n"
    )
    page = page_of(tmp_path)
    sections = [a["id"] for tag, a in page.tags if tag == "section"]
    assert sections[:3] == ["claims", "summary", "paper"]
    assert "Of 1 claims: 1 in part." in page.text
    assert "<b>" in page.text


def test_pictures_of_runs_are_in_the_page_and_those_of_reports_are_not(tmp_path: Path) -> None:
    figures = tmp_path / "figures"
    figures.mkdir()
    for name in ("gantt.svg", "time-profit-old.svg", "accounts-by-policy.png"):
        (figures / name).write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    (figures / "gantt.png").write_bytes(b"much longer " * 100)
    (tmp_path / "sensitivity-time.csv").write_text("factor,total\nlatency,0\n")
    sensitivity, runs = beside(tmp_path)
    assert [each.name for each in runs.pictures] == ["gantt"]
    assert runs.pictures[0].data.startswith("data:image/svg+xml;base64,")
    assert (sensitivity.name, sensitivity.tables[0].rows) == ("Sensitivity", [["latency", "0"]])


def test_only_stills_that_are_drawn_are_linked(tmp_path: Path) -> None:
    folder = written(tmp_path, sweep(fraction=[0.1, 0.5, 1.0], processors=[8, 64]))
    page = page_of(folder, stills=["speedup"])
    links = [attrs["href"] for tag, attrs in page.tags if tag == "a"]
    stills = [link for link in links if link and link.startswith("figures/")]
    assert stills == ["figures/speedup.svg", "figures/speedup.png"]
    assert "As a file: simmpp report --figures efficiency" in page.text
    assert "simmpp report --figures speedup" not in page.text
    assert "As a file" not in page_of(folder, is_running=True).text


def test_machines_of_a_sweep_are_curves_and_a_table(tmp_path: Path) -> None:
    key, machines = "machine.preset", ("t3e", "cluster")
    rows = [
        row(policy, seed, processors=nb, **{key: name})
        for policy in ("object", "ray")
        for seed in (0, 1)
        for nb in (4, 8)
        for name in machines
    ]
    page = page_of(written(tmp_path, rows, (key,)))
    assert {"machines"} <= {attrs.get("id") for tag, attrs in page.tags if tag == "section"}
    (plate,) = page.data["figures"]["machines-node-seconds"]["plates"]
    curves = [of["name"] for of in plate["panels"][0]["data"] if of.get("customdata")]
    assert curves == [f"{name}: object dataflow" for name in sorted(machines)]
    assert page.text.count("fewest node-seconds") == 1
    assert "Machines" not in page_of(written(tmp_path / "one", sweep(processors=[4, 8]))).text


def test_a_bench_is_a_figure(tmp_path: Path) -> None:
    keys = ("scene", "processors", "fraction")
    rows = [
        dict.fromkeys(bench_columns(keys), 0.1 / seeds)
        | {"scene": "tetra:5", "processors": 64, "fraction": x, "policy": policy}
        | {"method": "simulate", "seeds": seeds, "groups": 2, "reference_seeds": 32 - seeds}
        | {"cpu_s": 0.5 * seeds, "trace_s": ""}
        for seeds in (1, 2, 4)
        for x in (0.1, 0.5)
        for policy in ("object", "concurrent")
    ]
    write_csv(rows, bench_columns(keys), tmp_path / "bench.csv")
    (panel, _) = page_of(tmp_path).data["figures"]["run-time-against-error"]["plates"][0]["panels"]
    (trace,) = panel["data"]
    assert trace["x"] == [1.0, 2.0, 4.0]  # seconds of both policies at one of two points
    assert trace["y"] == pytest.approx([0.1, 0.05, 0.025])
    assert trace["text"] == ["1", "2", "4"]


def test_intervals_are_those_of_profits_csv_where_it_is_of_the_same_seeds(tmp_path: Path) -> None:
    rows = sweep(["object", "ray"], fraction=[0.1, 1.0])
    profits = profit_rows(rows)
    for row_ in profits:
        row_ |= {"time_profit_low": 0.25, "n": row_["n"] + (row_["fraction"] == 1.0)}
    write_csv(profits, profit_columns(), written(tmp_path, rows) / "profits.csv")
    found = read_folder(tmp_path)
    lows = {r["fraction"]: r["time_profit_low"] for r in points_of(rows, (), found.profits).profits}
    assert lows[0.1] == 0.25
    assert lows[1.0] != 0.25


def test_what_a_method_does_not_know_is_left_out() -> None:
    """The analytical model knows neither communication nor waiting."""
    rows = [r | {"method": "simulate"} for r in sweep(["object", "ray"], fraction=[0.1, 1.0])]
    model = {"method": "analytical", "communication_ps": "", "waiting_ps": "", "load_messages": ""}
    rows += [r | model for r in rows]
    points = points_of(rows, ("method",))
    assert points.axes["method"] == ["analytical", "simulate"]
    limits = limits_of_points(Folder(Path(), rows), points)
    for number, profit in enumerate(points.profits):
        assert bool(limits.shares(number)) == (profit["method"] == "simulate")
        assert bool(points.messages(number)) == (profit["method"] == "simulate")
    json.dumps(depth_in(points), allow_nan=False)
