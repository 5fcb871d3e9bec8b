"""``simmpp bench``: its table and figure, what it continues and what it refuses."""

import csv
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from simmpp.cli import main
from simmpp.common.errors import ModelError
from simmpp.config.config import load_config
from simmpp.methods import table as methods
from simmpp.studies.bench.bench import bench
from simmpp.sweeps import sweep as sweeping
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.task import Task
from simmpp.sweeps.worker import run_task

CONFIG = """
scene: tetra:2
picture: {resolution: 12}
processors: 4
policy: [ray, concurrent]
sweep: {memory.fraction: [0.3, 0.6]}
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("c.yaml").write_text(CONFIG)


def simmpp(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["bench", "c.yaml", "--workers", "1", "--out", "o", *arguments])


def rows() -> list[dict[str, str]]:
    with open("o/bench.csv", newline="") as file:
        return list(csv.DictReader(file))


def test_every_rung_at_every_point() -> None:
    done = simmpp("--seeds", "8")
    assert done.exit_code == 0, done.output
    found = {(row["fraction"], row["policy"], row["method"], row["seeds"]) for row in rows()}
    expected = {
        (x, policy, *rung)
        for x in ("0.3", "0.6")
        for policy in ("object", "ray", "concurrent")
        for rung in (("simulate", "1"), ("simulate", "2"), *MODELS)
        if policy != "concurrent" or rung not in MODELS
    }
    assert found == expected
    for row in rows():
        assert float(row["cpu_s"]) > 0 and float(row["trace_s"]) > 0
        assert (row["time_profit_error"] == "") == (row["policy"] == "object")
    assert Path("o/bench.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in Path("o/bench.svg").read_text()
    assert [line.split()[1:3] for line in done.stdout.splitlines()[1:5]] == [
        ["simulate", "1"], ["simulate", "2"], *map(list, MODELS),
    ]  # fmt: skip


MODELS = (("analytical", "1"), ("analytical-measured", "1"))


def test_it_continues_and_then_says_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def stops(task: Task) -> Outcome:
        ran.append(task.key)
        if len(ran) == 20:
            raise KeyboardInterrupt
        return run_task(task)

    monkeypatch.setattr(sweeping, "run_task", stops)
    assert simmpp("--seeds", "8").exit_code == 130
    assert simmpp("--seeds", "8").exit_code == 0
    whole, text = len(ran), Path("o/bench.csv").read_bytes()
    assert simmpp("--seeds", "8").exit_code == 0
    assert (len(ran), Path("o/bench.csv").read_bytes()) == (whole, text)
    assert len(set(ran)) == whole - 1


def test_what_failed_is_left_out_and_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(case: object) -> dict[str, int]:
        raise ModelError("x")

    monkeypatch.setitem(methods.METHODS, "analytical", methods.Method(fails, ("object", "ray")))
    done = simmpp("--seeds", "4")
    assert done.exit_code == 1
    assert "failed: x" in done.stderr
    assert {row["method"] for row in rows()} == {"simulate", "analytical-measured"}


def test_a_further_method_is_a_line_in_the_table(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that says twice the makespan of the simulation, with as many seeds as that."""

    def doubled(case):  # type: ignore[no-untyped-def]
        numbers = methods.METHODS["simulate"].numbers(case)
        return numbers | {"makespan_ps": 2 * numbers["makespan_ps"]}

    name = "analytical"  # names are fixed when the settings are read
    monkeypatch.setitem(methods.METHODS, name, methods.Method(doubled, most_seeds=4))
    found = bench(load_config("c.yaml"), seeds=16, out=Path("p"))
    of_method = {each.seeds: each for each in found.rungs if each.method == name}
    assert list(of_method) == [1, 2, 4]
    assert of_method[4].error["makespan"] == pytest.approx(1, abs=0.2)
    assert of_method[4].error["time_profit"] < 0.2


@pytest.mark.parametrize(
    ("setting", "problem"),
    [
        ("sweep.policy=[ray]", "sweep: policy: expected no such axis"),
        ("sweep.method=[simulate]", "sweep: method: expected no such axis"),
        ("tolerance=2%", "tolerance: expected none"),
    ],
)
def test_what_it_sets_itself_is_refused(setting: str, problem: str) -> None:
    done = simmpp("--set", setting)
    assert (done.exit_code, len(done.stderr.splitlines())) == (2, 1)
    assert problem in done.stderr


def test_more_seeds_add_to_what_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []
    counting = lambda task: ran.append(task.key) or run_task(task)  # type: ignore[func-returns-value]  # noqa: E731
    monkeypatch.setattr(sweeping, "run_task", counting)
    assert simmpp("--seeds", "4").exit_code == 0
    few = len(ran)
    assert simmpp("--seeds", "5").exit_code == 0
    assert len(ran) - few == 2 * 3
    assert {row["reference_seeds"] for row in rows()} == {"4"}
