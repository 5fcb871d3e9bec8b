"""What commands print on terminals of 60 to 120 columns, in pipes and where only ASCII goes."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import pytest
from calls import begin_in, simmpp

from simmpp.commands.parts import terminal

CONFIG = """
scene: tetra:2
picture: {resolution: 12}
processors: 4
policy: [ray, concurrent]
"""
SWEEP = CONFIG + "sweep: {memory.fraction: [0.3, 0.5], ready_order: [depth-first, breadth-first]}"
TABLES = [
    "run c.yaml",
    "sweep s.yaml --workers 1",
    "sweep s.yaml --workers 1 --set seeds='[0, 1]' --set tolerance=50% --out t",
    "compare a b",
    "check s.yaml --workers 1 --baseline base --set machine.send_startup='12 us'",
    "model c.yaml",
    "scene tetra:2",
    "workload tetra:2 --set picture.resolution=12",
    "machine",
    "machine t3e",
    "reading",
    "reading mixed",
    "keys",
    "keys machine.send_startup",
]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)
    Path("s.yaml").write_text(SWEEP)


def prepared(call: str) -> None:
    """What a command needs to be there."""
    if call.startswith("compare"):
        for out, startup in (("a", "10 us"), ("b", "12 us")):
            startups = f"machine.send_startup={startup}"
            simmpp("sweep", "s.yaml", "--workers", "1", "--out", out, "--set", startups)
    if call.startswith("check"):
        simmpp("check", "s.yaml", "--workers", "1", "--baseline", "base", "--update")


@pytest.mark.parametrize("call", TABLES)
def test_nothing_is_cut_on_a_terminal(call: str, monkeypatch: pytest.MonkeyPatch) -> None:
    prepared(call)
    monkeypatch.setattr(terminal, "_is_terminal", lambda stream: stream is sys.stdout)
    numbers: dict[int, list[str]] = {}
    for width in (60, 80, 120):
        monkeypatch.setenv("COLUMNS", str(width))
        done = simmpp(*shlex.split(call))
        assert done.exit_code in (0, 1), done.output
        lines = [line for line in done.stdout.splitlines() if not line.startswith("next: ")]
        assert max(map(len, lines)) <= width
        assert "…" not in done.stdout
        numbers[width] = sorted(set(re.findall(r"\d+\.\d{3,}", done.stdout)))
    assert numbers[60] == numbers[80] == numbers[120]


IN_ASCII = {"LANG": "C", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


def in_a_pipe(call: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """As a process of its own, whose output no terminal shows."""
    command = [sys.executable, "-m", "simmpp", *shlex.split(call)]
    return subprocess.run(command, capture_output=True, check=True, env=os.environ | environment)


@pytest.mark.parametrize(
    ("environment", "ascii_only"),
    [({"LC_ALL": "C"}, True), ({"LANG": "POSIX"}, True), ({"LANG": "en_GB.UTF-8"}, False)],
)
def test_bars_are_drawn_with_what_the_terminal_has(
    environment: dict[str, str], ascii_only: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("LC_ALL", "LANG"):
        monkeypatch.setenv(name, environment.get(name, ""))
    assert terminal.errors().options.ascii_only == ascii_only


def test_in_a_pipe_lines_of_text_stay_whole() -> None:
    lines = in_a_pipe("run c.yaml --out o").stdout.decode().splitlines()
    assert lines[1].endswith("seed 0")
    assert any(line.startswith("best classical") and line.count(";") == 2 for line in lines)
    assert lines[-2:] == ["wrote o/run.json, o/results.csv", "next: simmpp report o"]


@pytest.mark.parametrize("environment", [IN_ASCII, {"PYTHONIOENCODING": "ascii"}])
def test_where_only_ascii_can_be_shown_there_is_nothing_else(environment: dict[str, str]) -> None:
    Path("t\xfc.nff").write_text(simmpp_nff())
    for call in ("run c.yaml", "scene t\xfc.nff"):
        done = in_a_pipe(call, COLUMNS="60", **environment)
        assert done.stdout.isascii() and done.stderr.isascii(), call


def simmpp_nff() -> str:
    """A scene's file."""
    simmpp("scene", "tetra:2", "--nff", "t.nff")
    return Path("t.nff").read_text()


@pytest.mark.parametrize(
    ("call", "told"),
    [
        ("run c.yaml --picture p.png", ["drawing the picture"]),
        ("run c.yaml --verify", [f"verifying {p}" for p in ("object", "ray", "concurrent")]),
        ("model c.yaml", ["evaluating the model"]),
        ("scene tetra:2", ["reading tetra:2"]),
        ("workload c.yaml --export w.npz", ["writing w.npz"]),
    ],
)
def test_what_takes_seconds_says_that_it_is_at_work(
    call: str, told: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[str] = []

    class Bars:
        def add_task(self, what: str, total: None) -> None:
            begun.append(what)

    monkeypatch.setattr(terminal, "progress_bars", lambda: nullcontext(Bars()))
    assert simmpp(*shlex.split(call)).exit_code == 0
    assert [what for what in begun if what in told] == told
