"""Where a process meets the rest: folders of others, full disks, any names and terminals."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp
from sweep_rows import row, written

from simmpp.common.files import write_csv
from simmpp.common.folders import BENCH, MARK, RUN, SWEEP, held
from simmpp.report.run_figures.recorder import FiguresRecorder

resource = pytest.importorskip("resource")  # no such limits on Windows

CONFIG = """
scene: tetra:2
picture: {resolution: 12}
processors: 4
policy: [object, ray]
"""
SMALL_BYTES = 100
"""Less than any file that a command writes."""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)
    Path("miss.nff").write_text(NFF)


NFF = """v
from 0 0 5
at 0 0 9
up 0 1 0
angle 40
hither 1
resolution 64 64
l 5 5 5
f 1 0 0 1 0 1 0 0
s 0 0 0 1
"""
"""Looks away: nothing is hit."""
INTO_A_FOLDER = [
    ("run", "c.yaml", "--out"),
    ("sweep", "c.yaml", "--workers", "1", "--out"),
    ("bench", "c.yaml", "--workers", "1", "--seeds", "4", "--out"),
    ("reproduce", "--workers", "1", "--resolution", "8", "--seeds", "1", "--out"),
    ("check", "c.yaml", "--workers", "1", "--baseline", "b/profits.csv", "--out"),
    ("model", "c.yaml", "--out"),
]


def content(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("command", INTO_A_FOLDER, ids=lambda command: command[0])
@pytest.mark.parametrize("is_marked", [True, False])
def test_no_command_writes_over_what_another_has_written(
    command: tuple[str, ...], is_marked: bool
) -> None:
    if command[0] == "check":
        assert simmpp(*command[:-1], "--update").exit_code == 0
    folder, other = Path("o"), RUN if command[0] in ("sweep", "bench") else SWEEP
    folder.mkdir()
    (folder / "results.csv").write_text("theirs")
    (folder / "run.json").write_text('{"policies": []}' if other == RUN else '{"points": 3}')
    if is_marked:
        (folder / MARK).write_text(f"{other}\n")
    before = content(folder)
    assert refused(*command, "o").startswith(f"o: holds the files of a {other}: expected those of")
    assert content(folder) == before


@pytest.mark.parametrize(
    "command", [*INTO_A_FOLDER, ("report", "--figures", "all")], ids=lambda command: command[0]
)
def test_two_at_once_are_refused(command: tuple[str, ...]) -> None:
    if command[0] == "check":
        assert simmpp(*command[:-1], "--update").exit_code == 0
    folder = written(Path("o"), [row(), row("ray")]) if command[0] == "report" else Path("o")
    with held(folder / "figures" if command[0] == "report" else folder):
        before = content(folder)
        assert "another simmpp is at work here" in refused(*command, "o")
        assert content(folder) == before


def test_a_run_does_not_end_up_in_a_sweep_nor_a_sweep_in_a_run() -> None:
    assert simmpp("sweep", "c.yaml", "--workers", "1", "--out", "s").exit_code == 0
    assert simmpp("run", "c.yaml", "--out", "r").exit_code == 0
    before = content(Path())
    assert "holds the files of a sweep" in refused("run", "c.yaml", "--out", "s")
    assert "holds the files of a run" in refused("sweep", "c.yaml", "--out", "r", "--workers", "1")
    assert "holds the files of a sweep" in refused(
        "check", "c.yaml", "--baseline", "s/profits.csv", "--update", "--workers", "1"
    )
    assert content(Path()) == before
    assert simmpp("sweep", "c.yaml", "--workers", "1", "--out", "s").exit_code == 0
    assert simmpp("run", "c.yaml", "--out", "r").exit_code == 0
    for folder in ("s", "r"):
        assert not list(Path(folder).glob("*.lock")) and not list(Path(folder).glob(".*.lock"))


def test_pictures_may_lie_beside_the_rows_of_the_same_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FiguresRecorder, "end", lambda *_: None)  # drawing takes its time
    for out in ("o", "p"):
        assert simmpp("run", "c.yaml", "--out", "o", "--figures", out).exit_code == 0


@contextmanager
def files_of_at_most(size_bytes: int) -> Iterator[None]:
    """A disk that is full, to whoever writes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize(
    ("command", "file"),
    [
        (("run", "c.yaml", "--out", "o"), "o/run.json"),
        (("run", "c.yaml", "--picture", "p.png"), "p.png"),
        (("run", "c.yaml", "--timeline", "t.json"), "t.json"),
        (("run", "c.yaml", "--timeline", "t.parquet"), "t.parquet"),
        (("run", "c.yaml", "--figures", "f"), "f/object-activity.png"),
        (("sweep", "c.yaml", "--workers", "1", "--out", "o"), "o/points.jsonl"),
        (("bench", "c.yaml", "--workers", "1", "--seeds", "4", "--out", "o"), "o/points.jsonl"),
        (("model", "c.yaml", "--out", "o"), "o/figure2.csv"),
        (("scene", "tetra:2", "--nff", "s.nff"), "s.nff"),
        (("scene", "tetra:2", "--preview", "p.png"), "p.png"),
        (("workload", "c.yaml", "--export", "w.npz"), "w.npz"),
        (("workload", "c.yaml", "--export", "w.parquet"), "w.objects.parquet"),
        (("report", "r"), "r/report.html"),
        (("compare", "r", "r", "--out", "c.html"), "c.html"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_full_disk_is_told_with_the_file_and_leaves_no_part(
    command: tuple[str, ...], file: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # figures are drawn right here: other processes would not have this one's limit
    monkeypatch.setattr("simmpp.commands.parts.options.available_cores", lambda: 1)
    simmpp("workload", "c.yaml")  # into the cache: of that another test speaks
    simmpp("scene", "tetra:2", "--preview", "p.png")
    written(Path("r"), [row(), row("ray")])
    before = content(Path())
    with files_of_at_most(SMALL_BYTES):
        done = simmpp(*command)
    assert done.exit_code == 2, done.output
    assert done.stderr.splitlines()[-1] == f"simmpp: error: {file}: File too large"
    after = {name: text for name, text in content(Path()).items() if MARK not in name}
    after.pop("o/points.jsonl", None)  # a journal, whose torn line is dropped
    assert after == before


def test_a_full_cache_costs_time_alone() -> None:
    with files_of_at_most(SMALL_BYTES):
        done = simmpp("run", "c.yaml")
    assert done.exit_code == 0
    cache = Path("cache").resolve()
    assert done.stderr == f"simmpp: {cache}: the workload is not cached: File too large\n"


NAMES = [os.fsdecode(b"n\xfc"), "Würfel 立方体"]


def process(*arguments: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """As a user's own terminal starts it."""
    command = [sys.executable, "-m", "simmpp", *arguments]
    return subprocess.run(command, capture_output=True, env=os.environ | environment)


@pytest.mark.parametrize("encoding", ["utf-8", "ascii", "latin-1"])
@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_what_a_terminal_can_not_show_is_replaced(name: str, encoding: str) -> None:
    Path(f"{name}.nff").write_text(NFF)
    done = process("scene", f"{name}.nff", PYTHONIOENCODING=encoding)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout.startswith(name.encode(encoding, "replace") + b": 1 object")
    missing = process("scene", f"{name}.obj", PYTHONIOENCODING=encoding)
    assert (missing.returncode, missing.stderr.count(b"\n")) == (2, 1)


def test_a_name_that_is_no_text_is_one_of_a_file() -> None:
    """As input and as output, on the command line, in a --set and beside a configuration."""
    name = "".join(NAMES)
    folder = Path(name)
    folder.mkdir()
    (folder / f"{name}.nff").write_text(NFF)
    (folder / f"{name}.yaml").write_text(CONFIG)
    config = str(folder / f"{name}.yaml")
    scene = ("--set", f"scene={folder / name}.nff")
    out = str(folder / "o")
    commands = [
        ("run", config, *scene, "--out", out, "--timeline", f"{folder}/t.parquet"),
        ("report", out),
        ("sweep", config, *scene, "--workers", "1", "--out", f"{folder}/s"),
        ("sweep", config, *scene, "--workers", "1", "--out", f"{folder}/s"),
        ("compare", f"{folder}/s", f"{folder}/s", "--out", f"{folder}/c.html"),
        ("check", config, "--workers", "1", "--baseline", f"{folder}/b/profits.csv", "--update"),
        (
            "check",
            config,
            "--workers",
            "1",
            "--baseline",
            f"{folder}/b/profits.csv",
            "--out",
            f"{folder}/m",
        ),
        ("workload", f"{folder / name}.nff", "--export", f"{folder}/{name}.parquet"),
        ("workload", f"{folder}/{name}.parquet"),
    ]
    for command in commands:
        done = process(*command)  # whose terminal is no other than a user's
        assert done.returncode == 0, (command, done.stderr)
    rows = (folder / "s" / "results.csv").read_text("utf-8")
    assert f"\nn?{NAMES[1]}," in rows
    (folder / "o" / "report.html").read_text("utf-8")


def test_no_figure_of_nothing_warns() -> None:
    """Neither where nothing is hit nor where a method knows no messages."""
    for out, further in (("hit", ()), ("model", ("--set", "method=analytical"))):
        miss = ("--set", "scene=miss.nff", "--set", "sweep.processors=[2, 4]", *further)
        command = ("sweep", "c.yaml", *miss, "--workers", "1", "--out", out)
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            assert simmpp(*command).exit_code == 0
            done = simmpp("report", out)
        assert (done.exit_code, done.stderr) == (0, ""), done.exception


def test_warnings_of_libraries_are_not_for_users(tmp_path: Path) -> None:
    code = """
import logging, sys, warnings
from simmpp import __main__ as process
from simmpp.common.errors import CacheWarning
import simmpp.cli
def warn():
    warnings.warn("of a library")
    logging.getLogger("library").warning("of a library")
    warnings.warn("of the cache", CacheWarning)
simmpp.cli.main = warn
process.main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "simmpp: of the cache\n")
    asked = subprocess.run([sys.executable, "-W", "always", "-c", code], capture_output=True)
    assert b"UserWarning: of a library" in asked.stderr


def test_a_table_of_ones_own_is_not_replaced() -> None:
    Path("mine").mkdir()
    write_csv([{"a": 1}], ("a",), Path("mine/results.csv"))
    assert "holds the files of a table of others" in refused("run", "c.yaml", "--out", "mine")


def test_kinds_that_commands_leave_behind() -> None:
    assert simmpp("bench", "c.yaml", "--workers", "1", "--seeds", "4", "--out", "b").exit_code == 0
    kind, where, call = Path("b", MARK).read_text().splitlines()
    assert (kind, where) == (BENCH, str(Path.cwd()))
    assert call == "simmpp bench c.yaml --workers 1 --seeds 4 --out b"
    assert "holds the files of a bench" in refused("run", "c.yaml", "--out", "b")
    assert simmpp("report", "b").exit_code == 0
