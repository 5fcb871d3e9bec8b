"""Several folders, with names or without: what report and compare write, print and refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from sweep_rows import failed, row, sweep, written

from simmpp.cli import main
from simmpp.common.files import Row
from simmpp.common.folders import BENCH, claimed, held, note_call


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, times in (("a", 1), ("b", 2), ("c", 3)):
        written(Path(name), slower(times, fraction=[0.1, 0.5, 1.0]))


def slower(times: int, **axes: list[float]) -> list[Row]:
    return [r | {"makespan_ps": times * r["makespan_ps"]} for r in sweep(**axes)]


def run(*arguments: str) -> tuple[int, str]:
    done = CliRunner().invoke(main, arguments)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.output
    return done.exit_code, done.output


def data(page: str) -> dict[str, object]:
    text = Path(page).read_text(encoding="utf-8")
    found = text.split('<script type="application/json" id="data">')[1].split("</script>")[0]
    return json.loads(found)["figures"]


def test_a_page_of_three_says_which_line_is_of_which_folder() -> None:
    code, told = run("report", "a", "twice=b", "c", "--out", "three.html")
    assert (code, told.partition(":")[0]) == (0, "three.html")
    assert "108 rows" in told
    page = Path("three.html").read_text(encoding="utf-8")
    assert "<h1>a, twice and c</h1>" in page
    assert "a: a · twice: b · c: c" in page
    lines = json.dumps(data("three.html")["folders-makespan"])
    assert all(f'"{name}"' in lines for name in ("a", "twice", "c"))
    titles = [panel["title"] for plate in plates("folders-makespan") for panel in plate["panels"]]
    assert sorted(titles) == [
        "concurrent dataflow",
        "object dataflow",
        "ray dataflow",
        "replicated scene",
    ]
    side_by_side = [panel["title"] for plate in plates("makespan") for panel in plate["panels"]]
    assert side_by_side == ["folder a", "folder c", "folder twice"]
    assert not Path("a/report.html").exists()


def plates(figure: str) -> list[dict[str, list[dict[str, str]]]]:
    return data("three.html")[figure]["plates"]  # type: ignore[index, no-any-return]


def test_the_page_of_several_lies_here_and_its_figures_beside_it() -> None:
    assert run("report", "a", "b")[0] == 0
    assert Path("report.html").exists()
    Path("x").mkdir()
    stem = "folders-time-profit"
    assert run("report", "a", "b", "--out", "x/two.html", "--figures", stem)[0] == 0
    assert sorted(path.name for path in Path("x/figures").iterdir()) == [
        f"{stem}.png",
        f"{stem}.svg",
    ]
    assert 'href="figures/folders-time-profit.svg"' in Path("x/two.html").read_text("utf-8")


def test_one_folder_may_have_a_name_and_a_page_elsewhere() -> None:
    assert run("report", "mine=a", "--out", "one.html")[0] == 0
    page = Path("one.html").read_text(encoding="utf-8")
    assert "<h1>mine</h1>" in page
    assert "Folders over each other" not in page


def test_other_axes_are_put_beside_each_other() -> None:
    written(Path("wide"), [r | {"width": 3} for r in sweep(fraction=[0.1])], ("width",))
    code, told = run("report", "a", "wide")
    assert (code, "48 rows" in told) == (0, True)


@pytest.mark.parametrize("command", ["report", "compare"])
@pytest.mark.parametrize(
    ("folders", "problem"),
    [
        (("a", "b", "a"), "two folders are called 'a': expected NAME=DIR for each"),
        (("x=a", "x=b"), "two folders are called 'x': expected NAME=DIR for each"),
        (("a", "=b"), ": value '=b': expected a folder, or NAME=DIR"),
        (("a", "x="), ": value '': expected the name of a file or folder"),
        (("a", "x=gone"), ": value 'gone': expected a folder"),
    ],
)
def test_what_names_can_not_be(command: str, folders: tuple[str, ...], problem: str) -> None:
    code, told = run(command, *folders)
    assert (code, told.count("\n")) == (2, 1)
    assert problem in told


def test_ends_of_paths_that_are_alike_are_told_apart() -> None:
    for name in ("x/o", "y/o"):
        written(Path(name), sweep(fraction=[0.1]))
    run("report", "x/o", "y/o", "a")
    assert "<h1>x/o, y/o and a</h1>" in Path("report.html").read_text(encoding="utf-8")


def test_a_folder_with_an_equals_sign_is_taken_as_it_is() -> None:
    written(Path("x=1"), sweep(fraction=[0.1]))
    run("report", "x=1", "a")
    assert "<h1>x=1 and a</h1>" in Path("report.html").read_text(encoding="utf-8")


def test_a_sweep_is_followed_alone() -> None:
    for more in (("b",), ("--out", "p.html")):
        code, told = run("report", "--live", "a", *more)
        assert (code, "--live: expected one folder" in told) == (2, True)


def test_each_is_compared_with_the_first() -> None:
    code, told = run("compare", "a", "twice=b", "c", "--out", "page.html")
    assert code == 0
    moved = "12 points in both; 12 moved, 12 beyond the 95 % interval."
    lines = told.splitlines()
    assert lines[-2:] == [f"compare: a and {name}: {moved}" for name in ("twice", "c")]
    assert lines.index("a and twice:") < lines.index("a and c:")
    assert "+100 %" in told and "+200 %" in told
    page = Path("page.html").read_text(encoding="utf-8")
    assert "a and c: What moved" in page
    assert {"makespan", "makespan-2"} <= data("page.html").keys()


def test_two_with_names_are_called_by_them() -> None:
    written(Path("d"), slower(2, fraction=[0.1]))
    told = run("compare", "old=a", "new=d")[1]
    assert "only old: x = 50 %, object dataflow" in told
    assert told.splitlines()[-1].startswith("compare: 4 points in both, 8 only old; 4 moved")


def test_without_common_points_compare_says_so_and_why() -> None:
    written(Path("d"), sweep(fraction=[0.2], scene=["tetra:2", "tetra:3"]))
    code, told = run("compare", "a", "d", "--out", "page.html")
    assert code == 0
    nothing = "no point is in both, so there is nothing to compare"
    why = "scene is mountain:4 before, tetra:2 (and 1 more) after"
    assert told.splitlines()[-1] == f"compare: {nothing}: {why}."
    assert f"{nothing}: {why}." in Path("page.html").read_text(encoding="utf-8")
    assert "points in both" not in told
    mixed = written(Path("e"), [row(fraction=0.1, processors=9), row(fraction=0.7)])
    assert run("compare", "a", str(mixed))[1].splitlines()[-1] == f"compare: {nothing}."
    assert "no point is in two of these folders" in run("report", "a", "d")[1]


@pytest.mark.parametrize("command", ["report", "compare"])
def test_what_is_unfinished_or_failed_says_so_by_its_name(command: str) -> None:
    written(Path("d"), [row(fraction=0.1), failed("ray", fraction=0.1)])
    record = {"points": 9, "simulations": 9, "finished": 1, "failed": 1}
    Path("d/run.json").write_text(json.dumps(record))
    code, told = run(command, "a", "half=d", "--out", "page.html")
    assert code == 0
    missing = "half: interrupted: 2 of 9 simulations are in these tables; to go on: "
    assert f"simmpp: {missing}" in told
    assert "simmpp: half: 1 row failed: took too long\n" in told
    page = Path("page.html").read_text(encoding="utf-8")
    assert missing in page


def test_what_was_interrupted_before_there_were_rows_says_how_to_go_on() -> None:
    with claimed(Path("d"), BENCH):
        note_call(Path("d"), "simmpp bench c.yaml --out d")
        Path("d/points.jsonl").write_text("{}\n")
    code, told = run("report", "d")
    assert code == 2
    interrupted = "DIR: value 'd': interrupted, before there were rows"
    assert told == f"simmpp: error: {interrupted}; to go on: simmpp bench c.yaml --out d\n"
    with held(Path("d")):
        assert "there are no rows yet: the command that works here" in run("report", "d")[1]


def test_points_that_failed_are_not_said_to_be_equal() -> None:
    rows = sweep(("object", "ray"), fraction=[0.1])
    half = [
        failed(r["policy"], r["seed"], fraction=0.1) if r["policy"] == "ray" else r for r in rows
    ]
    written(Path("all"), rows)
    written(Path("half"), half)
    written(Path("none"), [failed(r["policy"], r["seed"], fraction=0.1) for r in rows])
    last = [run("compare", "all", other)[1].splitlines()[-1] for other in ("half", "none")]
    assert last == [
        "compare: 2 points in both (1 of them without a result in one or both); nothing moved.",
        "compare: 2 points in both (2 of them without a result in one or both): there is nothing "
        "to compare.",
    ]
