"""Policies of one's own: files that run, sweep and check execute, and every mistake in one line."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp

HALF = """\
from simmpp.policy import Policy, hook


@hook
def send(v):
    if v.load <= v.min_load or v.load <= v.known_load:
        return 0
    return (v.load - v.known_load) // v.part


@hook
def ask(v):
    return v.nothing_else or v.unasked >= 3


POLICY = Policy("half", send=send, ask=ask, batch=4, parameters={"part": 2})
"""
CONFIG = """\
scene: tetra:3
picture: {resolution: 12}
processors: 4
memory: {fraction: 0.3}
policy: [object, {file: mine.py, label: mine, set: {part: 3}}]
seeds: [0]
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("mine.py").write_text(HALF)
    Path("c.yaml").write_text(CONFIG)


def rows(folder: str) -> dict[str, dict[str, str]]:
    with open(f"{folder}/results.csv", newline="") as file:
        return {row["policy"]: row for row in csv.DictReader(file)}


def test_a_run_says_what_it_executes_and_records_what_it_was() -> None:
    done = simmpp("run", "c.yaml", "--out", "o", "--verify")
    assert done.exit_code == 0, done.output
    policy = json.loads(Path("o/run.json").read_text())["config"]["policy"][1]
    assert f"policy: runs mine.py (sha256 {policy['digest'][:12]})" in done.stderr
    assert (policy["name"], policy["file"], policy["set"]) == ("half", "mine.py", {"part": 3})
    assert "verify mine: the picture of its tests is the same" in done.stdout
    row = rows("o")["mine"]
    assert int(row["rays_sent"]) > 0
    assert int(row["objects_fetched"]) > 0
    again = simmpp("run", "c.yaml", "--out", "again", "--engine", "simpy")
    assert again.exit_code == 0
    assert rows("again")["mine"] == row | {"engine": "simpy"}


def test_workers_run_the_text_that_was_read() -> None:
    Path("sub").mkdir()
    Path("sub/c.yaml").write_text(CONFIG.replace("seeds: [0]", "sweep: {policy.set.part: [1, 3]}"))
    Path("sub/mine.py").write_text(HALF)
    alone = simmpp("sweep", "sub/c.yaml", "--workers", "1", "--out", "alone")
    assert alone.exit_code == 0, alone.output
    assert "policy: runs sub/mine.py" in alone.stderr
    beside = simmpp("sweep", "sub/c.yaml", "--workers", "2", "--out", "beside")
    assert beside.exit_code == 0, beside.output
    assert Path("alone/results.csv").read_bytes() == Path("beside/results.csv").read_bytes()
    with open("alone/results.csv", newline="") as file:
        sent = {
            row["policy.set.part"]: row["rays_sent"]
            for row in csv.DictReader(file)
            if row["policy"] == "mine"
        }
    assert sent["1"] != sent["3"]


def test_two_versions_of_a_file_are_two_policies() -> None:
    assert simmpp("sweep", "c.yaml", "--workers", "1", "--out", "o").exit_code == 0
    before = rows("o")["mine"]
    assert simmpp("check", "c.yaml", "--baseline", "b/profits.csv", "--update").exit_code == 0
    Path("mine.py").write_text(HALF.replace("v.unasked >= 3", "v.unasked >= 2"))
    other = simmpp("sweep", "c.yaml", "--out", "o")
    assert other.exit_code == 2
    assert "holds results of another sweep" in other.stderr
    assert simmpp("sweep", "c.yaml", "--workers", "1", "--out", "n").exit_code == 0
    assert rows("n")["mine"] != before
    checked = simmpp("check", "c.yaml", "--baseline", "b/profits.csv", "--workers", "1")
    assert checked.exit_code == 2
    assert "digest" in checked.stderr


READERS = (
    *("run c.yaml", "sweep c.yaml", "check c.yaml --baseline b", "bench c.yaml"),
    *("model c.yaml", "machine c.yaml", "scene c.yaml", "workload c.yaml"),
)
"""Every command that reads a configuration."""


@pytest.mark.parametrize("command", [of for of in READERS if of.startswith(("ma", "sc", "wo"))])
def test_who_only_looks_says_what_it_executes(command: str) -> None:
    assert "policy: runs mine.py" in simmpp(*command.split()).stderr


def test_a_reading_is_no_code() -> None:
    Path("evil.py").write_text("open('ran', 'w')")
    named = "{value: evil.py, source: s}"
    text = f"description: r\nbased_on: mixed\npolicy:\n  ray:\n    file: {named}\n"
    Path("r.yaml").write_text(text)
    said = refused("run", "c.yaml", "--set", "reading=r.yaml", "--no-code", "--set", "policy=ray")
    assert said == "r.yaml:5: policy.ray.file: expected none: readings do not set it"
    assert not Path("ran").exists()


LIMIT = """\
import os
from simmpp.policy import Policy, hook

LIMIT = int(os.environ["LIMIT"])


@hook
def send(v):
    return v.waiting if v.load > LIMIT else 0


@hook
def ask(v):
    return 1


POLICY = Policy("limit", send=send, ask=ask)
"""


def test_what_a_hook_takes_from_around_it_is_part_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """One text, two values: neither compiled code nor rows of one are taken for the other's."""
    Path("mine.py").write_text(LIMIT)
    Path("c.yaml").write_text(CONFIG.replace(", set: {part: 3}", ""))
    found = {}
    for limit in ("1", "1000000", "1"):
        monkeypatch.setenv("LIMIT", limit)
        done = subprocess.run(
            [sys.executable, "-m", "simmpp", "run", "c.yaml", "--out", f"o{limit}"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        row = rows(f"o{limit}")["mine"]
        assert found.setdefault(limit, row) == row
    assert int(found["1"]["rays_sent"]) > 0
    assert int(found["1000000"]["rays_sent"]) == 0


def test_code_is_refused_where_it_is_not_wanted() -> None:
    Path("mine.py").write_text("open('ran', 'w')")
    for command in READERS:
        said = refused(*command.split(), "--no-code")
        assert said == (
            "c.yaml:5: policy[1].file: value 'mine.py': expected none: with --no-code no file "
            "is run"
        )
    assert not Path("ran").exists()


MISTAKES = [
    ("return (v.load - v.known_load) // v.part", "return v.lod", "mine.py:8: send: the view has "),
    ("v.part\n", "(v.part - 3)\n", "mine.py:8: send: ZeroDivisionError: integer division"),
    (
        "return v.nothing_else",
        "v.memory[9] = 1\n    return v.load",
        "mine.py:13: ask: IndexError: li",
    ),
    ("return (v.load", "while True: v.memory[0] += 1\n    return (v.load", "mine.py:8: send: Ru"),
    ("return (v.load - v.known_load) // v.part", "return 'all'", "mine.py:8: send can't be comp"),
    ("def send(v)", "def send(v, w)", "mine.py:4: hook: value send: expected a function of one"),
    ("def send(v):", "def send(v)", "mine.py:5: expected ':'"),
    ('"half"', '"object"', "c.yaml:5: policy[1].file: its policy is called 'object': expected no"),
    ('"part"', '"share"', "mine.py:8: send: the view has no 'part': "),
    ("POLICY =", "policy =", "mine.py: expected POLICY = Policy(...)"),
    ("batch=4", "batch='few'", "mine.py:16: policy 'half': batch: value 'few': expected a count"),
    ("import", "imports", "mine.py:1: invalid syntax"),
    ("POLICY =", "raise SystemExit(0)\nPOLICY =", "mine.py:16: SystemExit: 0"),
    ("batch=4", "like='half'", "mine.py:16: policy 'half': like: value 'half': expected object, "),
    ('"half"', '"a/b"', "mine.py:16: policy: name: value 'a/b': expected a letter, then letters"),
    ("def ask(v):\n", "def ask(v):\n    import nix\n", "mine.py:13: ask can't be compiled"),
]


@pytest.mark.parametrize(("right", "wrong", "said"), MISTAKES)
def test_mistakes_in_files_are_one_line(right: str, wrong: str, said: str) -> None:
    assert right in HALF
    Path("mine.py").write_text(HALF.replace(right, wrong, 1))
    done = simmpp("run", "c.yaml")
    assert done.exit_code == 2, done.output
    assert done.stderr.splitlines()[-1].startswith(f"simmpp: error: {said}"), done.stderr


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        ("{file: mine.py, set: {pert: 1}}", "policy.set: unknown key 'pert': did you mean 'part'?"),
        ("{file: mine.py, set: {part: x}}", "policy.set: part: value 'x': expected a whole"),
        ("{name: object, set: {part: 1}}", "policy.set: object has no numbers of its own"),
        ("{file: mine.py, name: ray}", "policy.file: its policy is called 'half': expected no ot"),
        ("{file: nix.py}", "policy.file: value 'nix.py': expected the Python file of a policy: N"),
        ("[{file: mine.py}, {file: other.py}]", "policy: two are called 'half': expected a label"),
        ("{file: mine.py, label: ray}", "policy: label 'ray' is the name of another policy"),
        ("{file: asks.py, packing: all}", "policy.file: value 'all': expected none or requests f"),
    ],
)
def test_mistakes_beside_files_are_one_line(policy: str, said: str) -> None:
    Path("other.py").write_text(HALF)
    Path("asks.py").write_text(HALF.replace("send=send, ", ""))
    Path("c.yaml").write_text(CONFIG.replace(CONFIG.splitlines()[4], f"policy: {policy}"))
    assert refused("run", "c.yaml").startswith(f"c.yaml:5: {said}")


def test_a_row_of_a_sweep_says_what_went_wrong() -> None:
    Path("mine.py").write_text(HALF.replace("// v.part", "// (v.part - 3)"))
    done = simmpp("sweep", "c.yaml", "--workers", "1", "--out", "o")
    assert done.exit_code == 1
    assert rows("o")["mine"]["error"].startswith("mine.py:8: send: ZeroDivisionError")


FOR_YEARS = """\
import numba
from simmpp.policy import Policy


@numba.njit
def nearly_all_turns_that_it_may_take(v):
    for _ in range(9_999_999):
        v.memory[0] = (v.memory[0] * 1103515245 + 12345) % 2147483648


def ask(v):
    for _ in range(9_999_999):
        nearly_all_turns_that_it_may_take(v)
    return 1


POLICY = Policy("years", ask=ask)
"""


def test_a_hook_that_does_not_return_meets_the_timeout() -> None:
    """What no turn of one loop betrays: the worker is ended."""
    Path("mine.py").write_text(FOR_YEARS)
    Path("c.yaml").write_text(CONFIG.replace(", set: {part: 3}", ""))
    done = simmpp("sweep", "c.yaml", "--workers", "2", "--timeout", "0.5", "--out", "o")
    assert done.exit_code == 1, done.output
    assert rows("o")["mine"]["error"].startswith("timeout: heard nothing after 0.5 s and was ended")


SLOW = FOR_YEARS.replace("9_999_999):\n        near", "30):\n        near")


def test_slow_hooks_meet_the_timeout_in_this_process_too() -> None:
    Path("mine.py").write_text(SLOW)
    Path("c.yaml").write_text(CONFIG.replace(", set: {part: 3}", ""))
    done = simmpp("sweep", "c.yaml", "--workers", "1", "--timeout", "0.5", "--out", "o")
    assert done.exit_code == 1, done.output
    assert rows("o")["mine"]["error"] == "timeout: not finished after 0.5 s"
