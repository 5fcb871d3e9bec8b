"""A sweep on a real Dask cluster, one of whose two workers is killed in the middle."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from simmpp.common.cache import cache_folder
from simmpp.common.errors import ConfigError
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.sweep import Watcher, run_sweep

CONFIG = {
    "scene": "mountain:4",
    "picture": {"resolution": 64},
    "seeds": [0],
    "tolerance": "3%",
    "max_seeds": 12,
    "policy": ["ray", "concurrent"],
    "sweep": {"processors": [8, 32], "memory.fraction": [0.1, 0.4]},
}
TABLES = ("results.csv", "results.parquet", "profits.csv", "run.json")


class Cluster:
    """A scheduler and two workers on the loopback interface; each worker has its own disk."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.started = folder, ExitStack()
        file = folder / "scheduler.json"
        self.start("dask_scheduler", "--port", "0", "--scheduler-file", str(file))
        while not file.exists():
            time.sleep(0.05)
        self.address = json.loads(file.read_text())["address"]
        self.workers = [
            self.start("dask_worker", self.address, "--nthreads", "1", "--no-nanny", cache=f"w{n}")
            for n in range(2)
        ]

    def start(self, program: str, *arguments: str, cache: str = "s") -> subprocess.Popen[bytes]:
        environment = {
            **os.environ,
            "SIMMPP_CACHE": str(self.folder / cache),
            "DASK_TEMPORARY_DIRECTORY": str(self.folder),
        }
        command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments]
        command += ["--host", "127.0.0.1", "--no-dashboard"]
        with open(self.folder / f"{cache}.log", "wb") as log:
            process = subprocess.Popen(command, stdout=log, stderr=log, env=environment)
        self.started.callback(process.wait)
        self.started.callback(process.kill)
        return process


@pytest.fixture
def cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Cluster]:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
    monkeypatch.setenv("SIMMPP_CACHE", str(tmp_path / "cache"))
    made = Cluster(tmp_path)
    with made.started:
        yield made


class Killer(Watcher):
    """Kills a worker when some points are finished."""

    def __init__(self, worker: subprocess.Popen[bytes]) -> None:
        self.worker, self.finished = worker, 0

    def simulated(self, outcome: Outcome) -> None:
        self.finished += 1
        if self.finished == 12:
            self.worker.kill()


def test_a_killed_worker_changes_nothing(cluster: Cluster, tmp_path: Path) -> None:
    run_sweep(CONFIG, out=tmp_path / "alone")
    killer = Killer(cluster.workers[0])
    run_sweep(CONFIG, out=tmp_path / "together", cluster=cluster.address, watcher=killer)
    assert cluster.workers[0].poll() is not None, "no worker was killed"
    assert killer.finished > 2 * 2 * 3 * 8, "no point asked for more than its first seeds"
    for name in TABLES:
        alone, together = tmp_path / "alone" / name, tmp_path / "together" / name
        assert alone.read_bytes() == together.read_bytes()


def test_no_cluster_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("simmpp.sweeps.executors.CONNECT_S", 1)
    for address in ("tcp://127.0.0.1:9", "nonsense://x", ""):
        with pytest.raises(ConfigError, match="--cluster: value ") as error:
            run_sweep(CONFIG, cluster=address)
        assert len(str(error.value).splitlines()) == 1
