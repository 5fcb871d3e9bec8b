"""``simmpp check`` as continuous integration meets it: verdict, table, artefacts, refusals."""

from __future__ import annotations

import csv
import dataclasses
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp
from click.testing import Result

from simmpp.common.errors import SimmppError
from simmpp.config.settings import DEFAULT_READING
from simmpp.machine import presets
from simmpp.policy.parameters import POLICIES
from simmpp.policy.view import View
from simmpp.studies.check import baseline

REPOSITORY = Path(__file__).parents[2]
CI = ("check", str(REPOSITORY / "configs" / "ci.yaml"), "--workers", "1", "--baseline")
COMMITTED = REPOSITORY / "experiments" / "baselines" / "ci"
CONFIG = """
scene: tetra:2
picture: {resolution: 12}
processors: 4
memory: {fraction: 0.3}
policy: [ray, concurrent]
sweep: {memory.fraction: [0.3, 0.6]}
"""
FILE = "b/profits.csv"


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)


def check(*arguments: str) -> Result:
    return simmpp("check", "c.yaml", "--workers", "1", "--baseline", FILE, *arguments)


def check_refused(*arguments: str) -> str:
    return refused("check", "c.yaml", "--workers", "1", "--baseline", FILE, *arguments)


def moved(out: str) -> list[dict[str, str]]:
    return read(Path(out, "moved.csv"))


def read(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def differing_cells(out: str) -> set[tuple[str, ...]]:
    """Key, column, baseline and present value of every integer that isn't the committed one."""
    pairs = zip(read(COMMITTED / "results.csv"), read(Path(out, "results.csv")), strict=True)
    keys = ("scene", "processors", "fraction", "policy", "seed", "method")
    return {
        (*(before[key] for key in keys), column, before[column], now[column])
        for before, now in pairs
        for column in before
        if before[column] != now[column]
    }


def slowest(out: str) -> str:
    """The longest makespan."""
    return str(max(int(row["makespan_ps"]) for row in read(Path(out, "results.csv"))))


def slow_network(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a latency of the preset, which no reading has, 5 % longer."""
    preset = presets.load_preset("t3e")
    latency_ps = preset.constants.flat()["latency"]
    assert isinstance(latency_ps, int)
    constants = preset.constants.model_copy(update={"latency": latency_ps * 105 // 100})
    changed = dataclasses.replace(preset, constants=constants)
    monkeypatch.setattr(presets, "load_preset", lambda name: changed)


def to_the_more_loaded(v: View) -> int:
    return v.waiting if v.load <= v.min_load or v.load <= v.known_load else 0


def invert_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the concurrent policy send where it would not, and the other way round."""
    inverted = dataclasses.replace(POLICIES["concurrent"], send=to_the_more_loaded)
    monkeypatch.setitem(POLICIES, "concurrent", inverted)


def test_the_committed_baseline_holds() -> None:
    Path("o").mkdir()
    Path("o/profits.png").write_bytes(b"of a check when something had moved")
    done = simmpp(*CI, str(COMMITTED / "profits.csv"), "--out", "o")
    assert done.exit_code == 0, done.output
    files = {name for name in os.listdir("o") if not name.startswith(".")}
    assert files == {"moved.csv", "profits.csv", "results.csv", "run.json"}
    assert done.stdout == "check: 128 rows, 64 points: nothing moved\n"
    assert moved("o") == []
    assert Path("o/results.csv").read_bytes() == (COMMITTED / "results.csv").read_bytes()


def test_a_slower_network_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    slow_network(monkeypatch)
    done = simmpp(*CI, str(COMMITTED), "--out", "o")
    assert done.exit_code == 1, done.output
    rows = moved("o")
    assert {(*row.values(),)[:-2] for row in rows if row["seed"]} == differing_cells("o")
    worst = next(r for r in rows if r["measure"] == "makespan_ps" and r["now"] == slowest("o"))
    change = int(worst["now"]) / int(worst["baseline"]) - 1
    assert worst["change"] == f"{100 * change:+.3g} %"
    asked = simmpp(*CI, str(COMMITTED), "--out", "asked", "--set", "machine.latency=2.1 us")
    assert asked.exit_code == 1
    assert moved("asked") == rows
    # what sends nothing is as it was, but for the profit over what does
    assert {r["measure"] for r in rows if r["policy"] == "replicated"} == {"time_profit"}
    assert {r["fraction"] for r in rows} == {"0.05", "0.2", "0.5"}
    assert "latency_ps is 2000000 in the baseline, 2100000 now" in done.stdout
    assert done.stdout.splitlines()[0].split() == ["measure", "rows", "from", "to"]
    assert Path("o/profits.png").read_bytes().startswith(b"\x89PNG")


def test_an_inverted_rule_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    invert_rule(monkeypatch)
    done = simmpp(*CI, str(COMMITTED), "--out", "o")
    assert done.exit_code == 1, done.output
    rows = moved("o")
    assert {row["policy"] for row in rows} == {"concurrent"}
    assert {"makespan_ps", "time_profit", "rays_sent"} <= {row["measure"] for row in rows}


def test_a_baseline_of_ones_own() -> None:
    assert check_refused() == (
        "--baseline: value 'b/profits.csv': there is no such folder: run with --update to make one"
    )
    done = check("--update")
    assert (done.exit_code, done.stdout.splitlines()) == (
        0,
        [
            "check: baseline of 6 rows in b",
            "next: simmpp check c.yaml --baseline b/profits.csv",
        ],
    )
    assert check().exit_code == 0
    assert check("--engine", "simpy").exit_code == 0
    again = check("--update")
    assert again.stdout.splitlines()[0] == "check: no values of the baseline moved"


def test_a_baseline_is_named_by_its_folder_before_there_is_one() -> None:
    for further in (("--update",), ()):
        done = simmpp("check", "c.yaml", "--baseline", "new", *further)
        assert done.exit_code == 0, done.output
    assert Path("new/profits.csv").is_file()
    assert refused("check", "c.yaml", "--baseline", "new.csv", "--update") == (
        "--baseline: value 'new.csv': expected a file profits.csv "
        "(with results.csv and run.json beside it)"
    )


def test_update_says_what_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("c.yaml").write_text(CONFIG + "reading: plain\n")  # another has startups of its own
    with monkeypatch.context() as patch:
        slow_network(patch)
        check("--update")
    done = check("--update")
    assert done.exit_code == 0
    assert "latency_ps is 2100000 in the baseline, 2000000 now" in done.stdout
    assert "values of the baseline moved" in done.stdout
    assert check().exit_code == 0


def test_tolerances_of_the_configuration() -> None:
    check("--update")
    trial = ("--set", "machine.send_startup=10.1 us")
    assert check(*trial).exit_code == 1
    Path("c.yaml").write_text(CONFIG + "check: {time_profit: 99%, message_profit: 99%}\n")
    assert check(*trial).exit_code == 0  # of the same baseline
    Path("c.yaml").write_text(CONFIG + "check: {time_profit: 0.0001%}\n")
    done = check(*trial)
    assert done.exit_code == 1
    lines = [line.split() for line in done.stdout.splitlines()]
    assert [line[0] for line in lines[1:2]] == ["time_profit"]
    assert all(line[-2:] == ["0.0001", "%"] for line in lines if line[:1] == ["tetra:2"])


def test_a_baseline_of_other_settings_is_refused() -> None:
    check("--update")
    Path("c.yaml").write_text(CONFIG.replace("12}", "13}"))
    assert check_refused() == (
        "--baseline: value 'b/profits.csv': it is of other settings (picture.resolution is 12 in "
        "the baseline, 13 now): run with --update to make one"
    )
    done = check("--update")
    assert done.exit_code == 0
    assert "not compared" in done.stderr
    assert check().exit_code == 0


def test_a_baseline_from_before_a_key_was_known() -> None:
    check("--update")
    record = json.loads(Path("b/run.json").read_text())
    del record["config"]["ready_order"], record["config"]["memory"]["transient"]
    Path("b/run.json").write_text(json.dumps(record))
    assert check().exit_code == 0
    Path("c.yaml").write_text(CONFIG + "ready_order: breadth-first\n")
    assert "ready_order is depth-first in the baseline, breadth-first now" in check_refused()


def gone(name: str) -> Callable[[], object]:
    return lambda: Path("b", name).unlink()


def written(name: str, text: str) -> Callable[[], object]:
    return lambda: Path("b", name).write_text(text)


def merged() -> None:
    """A line of results.csv changed by hand."""
    path = Path("b/results.csv")
    path.write_text(path.read_text().replace(",simulate,", ",simulated,", 1))


@pytest.mark.parametrize(
    ("damage", "problem"),
    [
        (gone("run.json"), "there is no run.json"),
        (gone("results.csv"), "there is no results.csv"),
        (gone("profits.csv"), "there is no profits.csv"),
        (written("run.json", "{"), "it is no baseline (Expecting"),
        (written("run.json", "[]"), "it is no baseline (run.json: expected a JSON object)"),
        (written("run.json", '{"config": {}}'), "it is of other settings"),
        (written("run.json", '{"config": {"memory": 3}, "sha256": 4}'), "it is no baseline"),
        (written("results.csv", "a,b\n"), "it is no baseline (results.csv is not the file that"),
        (merged, "it is no baseline (results.csv is not the file that run.json was written with)"),
    ],
)
def test_a_foreign_baseline_is_refused(damage: Callable[[], object], problem: str) -> None:
    check("--update")
    damage()
    line = check_refused()
    assert line.startswith(f"--baseline: value 'b/profits.csv': {problem}"), line
    assert line.endswith(": run with --update to make one")


def test_a_sweeps_folder_is_a_baseline() -> None:
    assert simmpp("sweep", "c.yaml", "--workers", "1", "--out", "b").exit_code == 0
    assert check().exit_code == 0
    path = Path("b/profits.csv")
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:-1], lines[-1].rpartition(",")[0]]))
    assert "profits.csv:7 has 17 cells, not 18" in check_refused()
    path.write_text("\n".join(lines[:-1]))
    done = check()
    assert done.exit_code == 1
    assert "missing" in done.stdout and "new" in done.stdout


def test_half_a_sweep_is_no_baseline() -> None:
    simmpp("sweep", "c.yaml", "--workers", "1", "--out", "b")
    record = Path("b/run.json")
    record.write_text(record.read_text().replace('"finished": 6', '"finished": 4'))
    line = check_refused()
    call = "simmpp sweep c.yaml --workers 1 --out b"
    assert f"it is unfinished (4 of 6 simulations; to go on: {call}): run with --update" in line


def test_an_update_that_is_interrupted_leaves_a_baseline_that_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    check("--update")

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(baseline, "write_record", interrupted)
        Path("c.yaml").write_text(CONFIG.replace("12}", "11}"))
        assert check("--update").exit_code == 130
    Path("c.yaml").write_text(CONFIG)
    assert "is not the file that run.json was written with" in check_refused()
    assert check("--update").exit_code == 0
    assert check().exit_code == 0


def test_failed_points_fail_the_check_and_are_no_baseline(monkeypatch: pytest.MonkeyPatch) -> None:
    check("--update")
    before = {path.name: path.read_bytes() for path in Path("b").iterdir()}

    def simulate(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr("simmpp.methods.simulation.simulate", simulate)
    done = check()
    assert done.exit_code == 1
    assert "out of memory" in done.stdout
    assert "simmpp: 6 rows failed: out of memory\n" in done.stderr
    assert check("--update").exit_code == 1
    assert {path.name: path.read_bytes() for path in Path("b").iterdir()} == before


@pytest.mark.parametrize("error", ["a.b failed", "1.5", "nan.", "no"])
def test_an_error_may_hold_anything(monkeypatch: pytest.MonkeyPatch, error: str) -> None:
    check("--update")

    def simulate(*_: object, **__: object) -> None:
        raise SimmppError(error)

    monkeypatch.setattr("simmpp.methods.simulation.simulate", simulate)
    done = check("--out", "o")
    assert (done.exit_code, done.exception.__class__) == (1, SystemExit)
    assert error in done.stdout
    assert {line["now"] for line in moved("o") if line["measure"] == "error"} == {error}


def test_tolerances_that_cannot_be() -> None:
    Path("c.yaml").write_text(CONFIG + "check: {makespan: 2%}\n")
    assert check_refused() == (
        "c.yaml:8: check: unknown key 'makespan': expected one of efficiency, message_profit, "
        "speedup, time_profit"
    )
    Path("c.yaml").write_text(CONFIG + "check: {time_profit: 200%}\n")
    share = "expected none, or a share above 0% and below 100%, such as 2%"
    assert check_refused() == f"c.yaml:8: check.time_profit: value '200%': {share}"


def test_what_the_repository_checks_is_what_it_has() -> None:
    assert sorted(path.name for path in COMMITTED.iterdir()) == [
        "profits.csv", "results.csv", "run.json",
    ]  # fmt: skip
    shutil.copytree(COMMITTED, "b")
    assert baseline.read_sweep(Path("b")).results


# --- a default reading that changed ---


def other_default(monkeypatch: pytest.MonkeyPatch) -> tuple[str, str]:
    """Make the other reading of the package the default; its name, and that of the default."""
    (other,) = {"plain", "mixed"} - {DEFAULT_READING}
    monkeypatch.setattr("simmpp.config.beside.DEFAULT_READING", other)
    return other, DEFAULT_READING


def test_a_baseline_of_other_defaults_is_compared_and_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    check("--update")
    new, old = other_default(monkeypatch)
    done = check()
    assert done.exit_code == 1
    line = (
        f"the defaults changed: the baseline is of reading {old}, the default is {new} now; "
        f"`reading: {old}` in the configuration is the old one"
    )
    assert line in done.stdout.splitlines()
    Path("c.yaml").write_text(CONFIG + f"reading: {old}\n")
    done = check()
    assert done.exit_code == 0
    assert done.stdout.endswith("nothing moved\n")


def test_a_baseline_that_names_no_reading_is_of_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("c.yaml").write_text(CONFIG + "reading: plain\n")
    check("--update")
    record = json.loads(Path("b/run.json").read_text())
    del record["config"]["reading"], record["config"]["policy"][0]["packing"]
    Path("b/run.json").write_text(json.dumps(record))
    assert check().exit_code == 0
    monkeypatch.setattr("simmpp.config.beside.DEFAULT_READING", "mixed")
    Path("c.yaml").write_text(CONFIG)
    assert "the defaults changed: the baseline is of reading plain" in check().stdout


def test_a_file_was_never_the_default_reading() -> None:
    Path("own.yaml").write_text("description: own\nbased_on: plain\n")
    Path("c.yaml").write_text(CONFIG + "reading: own.yaml\n")
    check("--update")
    Path("c.yaml").write_text(CONFIG)
    assert "reading is own.yaml in the baseline" in check_refused()


def test_a_reading_that_the_configuration_names_is_another_setting() -> None:
    (other,) = {"plain", "mixed"} - {DEFAULT_READING}
    check("--update")
    Path("c.yaml").write_text(CONFIG + f"reading: {other}\n")
    assert f"reading is {DEFAULT_READING} in the baseline, {other} now" in check_refused()


def test_other_settings_are_told_from_other_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    check("--update")
    other_default(monkeypatch)
    Path("c.yaml").write_text(CONFIG + "ready_order: breadth-first\n")
    problem = "ready_order is depth-first in the baseline, breadth-first now"
    assert f"it is of other settings ({problem})" in check_refused()


def test_a_reading_of_ones_own_lies_beside_the_configuration() -> None:
    Path("sub").mkdir()
    Path("sub/own.yaml").write_text(
        "description: one\nbased_on: mixed\nplacement: {pixels: {value: tiles, source: own}}\n"
    )
    Path("sub/c.yaml").write_text(CONFIG + "reading: own.yaml\n")
    arguments = ("check", "sub/c.yaml", "--workers", "1", "--baseline", FILE)
    assert simmpp(*arguments, "--update").exit_code == 0
    assert simmpp(*arguments).exit_code == 0
