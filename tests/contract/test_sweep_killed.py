"""``kill -9`` at any moment of a sweep, then the same command again: byte-identical tables.

``SIMMPP_KILLS=20`` kills at more random moments than CI has time for, ``SIMMPP_KILLS_SEED`` chooses
others.
"""

import os
import random
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from simmpp.cli import main
from simmpp.common.cache import cache_folder
from simmpp.config.config import load_config
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.sweeps.journal import FILE
from simmpp.sweeps.sweep import run_sweep

KILLS = int(os.environ.get("SIMMPP_KILLS", "3"))
SEED = int(os.environ.get("SIMMPP_KILLS_SEED", "0"))
TABLES = ("results.csv", "results.parquet", "profits.csv", "run.json")
PROGRAM = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background ignores it
from simmpp.__main__ import main
main()
"""
CONFIG = """
scene: mountain:4
picture: {resolution: 192}
seeds: [0, 1, 2, 3, 4, 5]
sweep:
  processors: [8, 32]
  memory.fraction: [0.1, 0.4, 1]
  policy: [object, ray, concurrent]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the configuration and a cache of workloads are; compiled code stays where it is."""
    folder = tmp_path_factory.mktemp("killed")
    (folder / "c.yaml").write_text(CONFIG)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
        patch.setenv("SIMMPP_CACHE", str(folder / "cache"))
        yield folder


def begin(folder: Path, out: Path, there: int = 0) -> subprocess.Popen[bytes]:
    """A sweep of two workers whose journal has its first outcome beyond those ``there``."""
    command = [sys.executable, "-c", PROGRAM, "sweep", "c.yaml"]
    command += ["--workers", "2", "--out", str(out)]
    with open(out.with_suffix(".log"), "wb") as log:
        sweep = subprocess.Popen(
            command, cwd=folder, stdout=log, stderr=log, start_new_session=True
        )
    while not (out / FILE).exists() or finished(out) <= there:
        assert sweep.poll() is None, out.with_suffix(".log").read_text()
        time.sleep(0.01)
    return sweep


def finished(out: Path) -> int:
    return (out / FILE).read_bytes().count(b'"numbers"')


def tables(folder: Path, out: Path) -> dict[str, bytes]:
    """The tables after the sweep has run to its end."""
    run_sweep(folder / "c.yaml", out=out)
    return {name: (out / name).read_bytes() for name in TABLES}


@pytest.fixture(scope="module")
def expected(folder: Path) -> dict[str, bytes]:
    return tables(folder, folder / "whole")


@pytest.fixture(scope="module")
def lasts_s(folder: Path, expected: dict[str, bytes]) -> float:
    """Seconds from the first outcome to the end."""
    sweep = begin(folder, folder / "timed")
    began_s = time.monotonic()
    assert sweep.wait() == 0
    assert tables(folder, folder / "timed") == expected
    return time.monotonic() - began_s


@pytest.mark.parametrize("number", range(KILLS))
def test_killed_and_continued(
    folder: Path, expected: dict[str, bytes], lasts_s: float, number: int
) -> None:
    out = folder / f"killed-{number}"
    sweep = begin(folder, out)
    time.sleep(random.Random(f"{SEED} {number}").uniform(0, lasts_s))
    sweep.kill()
    sweep.wait()
    for _ in range(200):
        if not running(sweep.pid):
            break
        time.sleep(0.05)
    assert not running(sweep.pid), "workers outlive the sweep"
    assert tables(folder, out) == expected


def test_killed_while_it_grows(folder: Path, expected: dict[str, bytes]) -> None:
    """Two of the seeds and one of the fractions are there; the rest comes to them."""
    out = folder / "grown"
    fewer = load_config(folder / "c.yaml", ["seeds=[1, 0]", "sweep.memory.fraction=[0.4]"])
    run_sweep(fewer, out=out)
    sweep = begin(folder, out, there=finished(out))
    sweep.kill()
    sweep.wait()
    told = CliRunner().invoke(main, ["report", str(out)]).output
    assert re.search(r"simmpp: interrupted: \d+ of 74 simulations are in these tables; ", told)
    assert f"to go on: cd {folder} && simmpp sweep c.yaml --workers 2 --out {out}\n" in told
    assert tables(folder, out) == expected


def running(session: int) -> bool:
    """Whether processes of the session are left."""
    found = subprocess.run(
        ["ps", "-s", str(session), "-o", "stat="], capture_output=True, text=True
    )
    return any(not line.startswith("Z") for line in found.stdout.split())


def test_ctrl_c_writes_what_is_finished(folder: Path, expected: dict[str, bytes]) -> None:
    out = folder / "interrupted"
    sweep = begin(folder, out)
    while (out / FILE).read_bytes().count(b"\n") < 4:
        time.sleep(0.01)
    os.killpg(sweep.pid, signal.SIGINT)
    assert sweep.wait() == 130
    log = out.with_suffix(".log").read_text()
    *_, told, last = log.splitlines()
    assert last == "simmpp: interrupted"
    call = f"simmpp sweep c.yaml --workers 2 --out {out}"
    assert re.fullmatch(rf"simmpp: \d+ of \d+ simulations done; to go on: {call}", told)
    assert "Interrupted: " in write_page(report_of(read_folder(out))).read_text(encoding="utf-8")
    assert "Traceback" not in log
    assert 3 < len((out / "results.csv").read_text().splitlines()) < 109
    assert tables(folder, out) == expected
