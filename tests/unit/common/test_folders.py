"""A folder is of one kind, and of one process at a time; whoever is refused changes nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError
from simmpp.common.folders import (
    BASELINE,
    BENCH,
    CHECK,
    LOCK,
    MARK,
    MODEL,
    REPRODUCTION,
    RUN,
    SWEEP,
    claimed,
    held,
    is_at_work,
    kind_of,
)

KINDS = (RUN, SWEEP, BENCH, REPRODUCTION, CHECK, BASELINE, MODEL)
HOLDER = """
import sys
from pathlib import Path
from simmpp.common.folders import held
with held(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("first", KINDS)
def test_only_its_own_kind_may_go_on(tmp_path: Path, first: str) -> None:
    with claimed(tmp_path, first):
        (tmp_path / "some.csv").write_text("x")
    before = content(tmp_path)
    for kind in KINDS:
        if kind == first:
            with claimed(tmp_path, kind):
                pass
            continue
        with (
            pytest.raises(ConfigError, match=f"holds the files of a {first}: expected .* a {kind}"),
            claimed(tmp_path, kind),
        ):
            pass
        assert content(tmp_path) == before


@pytest.mark.parametrize(
    ("files", "kind"),
    [
        ({"results.csv": "", "run.json": '{"policies": [], "points": 3}'}, RUN),
        ({"results.csv": "", "profits.csv": "", "run.json": '{"points": 3}'}, SWEEP),
        ({"results.csv": "", "timings.csv": ""}, SWEEP),
        (
            {"results.csv": "", "profits.csv": "", "run.json": '{"points": 3, "sha256": {}}'},
            BASELINE,
        ),
        ({"results.csv": "", "moved.csv": "", "run.json": '{"points": 3}'}, CHECK),
        ({"figure2.csv": "", "claims.csv": "", "run.json": '{"set": []}'}, REPRODUCTION),
        ({"figure2.csv": ""}, MODEL),
        ({"bench.csv": ""}, BENCH),
        ({"results.csv": "mine", "run.json": "[]"}, "table of others"),
        ({"notes.txt": "", "points.jsonl": ""}, None),
        ({}, None),
    ],
)
def test_folders_that_nobody_marked(tmp_path: Path, files: dict[str, str], kind: str) -> None:
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert kind_of(tmp_path) == kind


def test_what_came_to_nothing_leaves_no_kind(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), claimed(tmp_path / "o", RUN):
        raise ZeroDivisionError
    with claimed(tmp_path / "o", SWEEP):
        assert (tmp_path / "o" / MARK).read_text() == "sweep\n"


def test_two_at_once_are_refused_and_the_lock_does_not_stay(tmp_path: Path) -> None:
    assert not is_at_work(tmp_path)
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None and process.stdout.readline() == "held\n"
    assert is_at_work(tmp_path)
    with pytest.raises(ConfigError, match="another simmpp is at work here"), held(tmp_path):
        pass
    assert is_at_work(tmp_path)
    process.communicate()
    assert os.listdir(tmp_path) == []
    assert not is_at_work(tmp_path)


def test_a_killed_process_holds_nothing(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout is not None and process.stdout.readline()
    process.kill()
    process.communicate()
    assert os.listdir(tmp_path) == [LOCK]
    assert not is_at_work(tmp_path)
    with claimed(tmp_path, RUN):
        assert is_at_work(tmp_path)
    assert os.listdir(tmp_path) == [MARK]


def test_one_of_many_at_a_time(tmp_path: Path) -> None:
    """Each adds one to a number in a file, while it holds the folder; none is lost."""
    adding = """
import sys
from pathlib import Path
from simmpp.common import folders
folders.PATIENCE_S = 60
for _ in range(50):
    with folders.held(Path(sys.argv[1])):
        number = Path(sys.argv[1], "number")
        number.write_text(str(int(number.read_text()) + 1))
"""
    (tmp_path / "number").write_text("0")
    command = [sys.executable, "-c", adding, str(tmp_path)]
    processes = [subprocess.Popen(command) for _ in range(4)]
    assert [process.wait() for process in processes] == [0] * 4
    assert (tmp_path / "number").read_text() == "200"
    assert os.listdir(tmp_path) == ["number"]
