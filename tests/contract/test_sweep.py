"""A sweep gives the same rows whoever runs it, in whatever order, however often it was stopped."""

import json
import random
from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

import pandas
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from simmpp.cli import main
from simmpp.common.cache import cache_folder
from simmpp.common.errors import ConfigError, ModelError
from simmpp.config.config import config_from_mapping, with_key
from simmpp.engine.simulate import simulate
from simmpp.methods import simulation as simulating
from simmpp.methods.case import Case
from simmpp.methods.columns import result_columns
from simmpp.methods.simulation import integers
from simmpp.methods.table import METHODS, SIMULATE, Method
from simmpp.policy.parameters import POLICIES, PolicyParameters
from simmpp.run.inputs import workload_of
from simmpp.run.point import make_point, run_point
from simmpp.run.rows import in_order, row
from simmpp.sweeps import plan as planning
from simmpp.sweeps.executors import Pool, SerialExecutor
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.plan import Plan, plan_of
from simmpp.sweeps.scheduler import outcomes
from simmpp.sweeps.sweep import run_sweep
from simmpp.sweeps.task import Task, canonical
from simmpp.sweeps.worker import run_task

CONFIG = {
    "scene": "tetra:2",
    "picture": {"resolution": 12},
    "seeds": [0, 1],
    "policy": ["ray", "concurrent"],
    "sweep": {"processors": [1, 4], "memory.fraction": [0.3, 1]},
}
TABLES = ("results.csv", "results.parquet", "profits.csv", "run.json")


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A fresh cache of workloads; compiled code stays where it is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
        folder = tmp_path_factory.mktemp("cache")
        patch.setenv("SIMMPP_CACHE", str(folder))
        yield folder


@pytest.fixture(scope="module")
def made(cache: Path) -> Plan:
    return plan_of(config_from_mapping(CONFIG))


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> dict[str, bytes]:
    """The tables as one process writes them."""
    return tables(tmp_path_factory.mktemp("expected"))


def tables(out: Path, **options: object) -> dict[str, bytes]:
    run_sweep(CONFIG, out=out, **options)  # type: ignore[arg-type]
    return {name: (out / name).read_bytes() for name in TABLES}


def test_columns_and_order(expected: dict[str, bytes], tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_bytes(expected["results.csv"])
    rows = pandas.read_csv(tmp_path / "r.csv")
    assert tuple(rows.columns) == result_columns(uses=["packs"])
    assert len(rows) == 2 * 2 * 3 * 2
    keys = ["scene", "processors", "fraction", "effective_fraction", "policy", "seed"]
    assert rows[keys].equals(rows[keys].sort_values(keys, ignore_index=True))
    assert set(rows["engine"]) == {"compiled"}


def test_rows_are_those_of_single_runs(made: Plan, expected: dict[str, bytes]) -> None:
    """The way of ``simmpp run``, point by point."""
    config = config_from_mapping(CONFIG)
    rows = []
    for nb, fraction, seed in product((1, 4), (0.3, 1), (0, 1)):
        point = with_key(config, "processors", nb)
        point = with_key(with_key(point, "memory.fraction", fraction), "engine", "compiled")
        placed = make_point(point, workload_of(point), seed)
        runs = [run for run in run_point(placed) if run.parameters.title != "replicated"]
        rows += [row(placed, run) for run in runs]
    header, *written = expected["results.csv"].decode().splitlines()
    names = header.split(",")  # what a point makes no use of has no columns
    assert [",".join(str(each[name]) for name in names) for each in in_order(rows)] == written


@pytest.mark.parametrize("name", POLICIES)
def test_parameters_that_are_left_out_of_the_key_change_nothing(name: str) -> None:
    config = config_from_mapping(CONFIG)
    placed = make_point(with_key(config, "processors", 4), workload_of(config))
    odd = PolicyParameters(name, "odd", 1, 3, 5, "none", merge_requests=False)
    results = [
        simulate(placed.workload, placed.machine, placed.placement, policy, engine="compiled")
        for policy in (odd, canonical(odd))
    ]
    assert integers(results[0]) == integers(results[1])


def test_any_number_of_workers_writes_the_same(expected: dict[str, bytes], tmp_path: Path) -> None:
    assert tables(tmp_path, workers=2) == expected


def test_both_engines_write_the_same(expected: dict[str, bytes], tmp_path: Path) -> None:
    found = tables(tmp_path, engine="simpy")
    assert found["profits.csv"] == expected["profits.csv"]
    other = expected["results.csv"].replace(b",simulate,compiled,", b",simulate,simpy,")
    assert found["results.csv"] == other != expected["results.csv"]


@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.randoms(use_true_random=False))
def test_the_order_of_tasks_is_irrelevant(made: Plan, shuffled: random.Random) -> None:
    tasks = made.tasks
    in_order = by_key(tasks, Pool(ThreadPoolExecutor(1), 1, run_task))
    shuffled.shuffle(tasks)
    in_disorder = by_key(tasks, Pool(ThreadPoolExecutor(3), 5, run_task))
    assert made.rows(in_disorder) == made.rows(in_order)


def by_key(tasks: list[Task], pool: Pool) -> dict[str, Outcome]:
    return {outcome.key: outcome for outcome in outcomes(deque(tasks), pool)}


def test_python_gets_the_tables(expected: dict[str, bytes], tmp_path: Path) -> None:
    result = run_sweep(CONFIG)
    (tmp_path / "r.parquet").write_bytes(expected["results.parquet"])
    assert result.rows.equals(pandas.read_parquet(tmp_path / "r.parquet"))
    (tmp_path / "p.csv").write_bytes(expected["profits.csv"])
    pandas.testing.assert_frame_equal(
        result.profits, pandas.read_csv(tmp_path / "p.csv"), check_dtype=False
    )


def test_speedup_is_against_one_pe_with_everything() -> None:
    """T(1) is known without simulating: it is what one replicated PE takes."""
    one = {**CONFIG, "policy": "replicated", "seeds": [0], "sweep": {"processors": [1, 4]}}
    rows, profits = run_sweep(one)
    alone = rows[(rows["policy"] == "replicated") & (rows["processors"] == 1)]
    t1_ps = alone["makespan_ps"].item()
    for profit in profits.to_dict("records"):
        run = rows[
            (rows["policy"] == profit["policy"]) & (rows["processors"] == profit["processors"])
        ]
        assert profit["speedup"] == t1_ps / run["makespan_ps"].item()
        assert profit["efficiency"] == profit["speedup"] / profit["processors"]


def test_it_continues_from_any_part_of_its_journal(
    expected: dict[str, bytes], tmp_path: Path
) -> None:
    tables(tmp_path)
    journal = (tmp_path / "points.jsonl").read_bytes()
    ran: list[str] = []
    counting = Pool(SerialExecutor(), 1, lambda task: ran.append(task.key) or run_task(task))  # type: ignore[func-returns-value]
    for length in (0, 10, len(journal) // 2, len(journal) - 1, len(journal)):
        (tmp_path / "points.jsonl").write_bytes(journal[:length])
        ran.clear()
        assert tables(tmp_path, pool=counting) == expected
        finished = max(0, journal[:length].count(b'"numbers"') - (length < len(journal)))
        assert len(ran) <= json.loads(expected["run.json"])["simulations"] - finished
    assert ran == []


def test_other_settings_are_refused(tmp_path: Path) -> None:
    tables(tmp_path)
    config = {**CONFIG, "machine": {"latency": "1 ms"}}
    with pytest.raises(ConfigError, match=r"config\.machine\.latency is not given there, 1 ms now"):
        run_sweep(config, out=tmp_path)
    with pytest.raises(ConfigError, match=r"config\.engine is compiled there, simpy now"):
        run_sweep(CONFIG, out=tmp_path, engine="simpy")


def test_other_versions_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tables(tmp_path)
    other = {**planning.result_versions(), "numpy": "1.0"}
    monkeypatch.setattr(planning, "result_versions", lambda: other)
    with pytest.raises(ConfigError, match=r"versions.numpy is .* there, 1.0 now"):
        run_sweep(CONFIG, out=tmp_path)


def test_a_failed_point_is_a_row_and_is_run_again(
    expected: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def starving(workload, machine, placement, policy, **options):  # type: ignore[no-untyped-def]
        if policy.name == "ray" and machine.processors == 4:
            raise ModelError("ray 3 waits\nfor ever")
        return simulate(workload, machine, placement, policy, **options)

    Path(tmp_path / "c.yaml").write_text(json.dumps(CONFIG))
    arguments = ["sweep", str(tmp_path / "c.yaml"), "--workers", "1", "--out", str(tmp_path / "o")]
    monkeypatch.setattr(simulating, "simulate", starving)
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 1
    assert "24 rows, 2 failed" in done.stdout
    assert "2 failed: ray 3 waits for ever" in done.stderr
    rows = pandas.read_csv(tmp_path / "o" / "results.csv")
    failed = rows[rows["error"].notna()]
    assert len(rows) == 24
    assert set(failed["error"]) == {"ray 3 waits for ever"}
    assert failed["makespan_ps"].isna().all()
    profits = pandas.read_csv(tmp_path / "o" / "profits.csv")
    assert set(profits[profits["n"] == 0]["policy"]) == {"ray"}
    monkeypatch.undo()
    assert CliRunner().invoke(main, arguments).exit_code == 0
    assert (tmp_path / "o" / "results.csv").read_bytes() == expected["results.csv"]


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (MemoryError(), "out of memory"),
        (RuntimeError("a\nb"), "RuntimeError: a b"),
        (ModelError("x"), "x"),
    ],
)
def test_whatever_goes_wrong_is_one_line(
    made: Plan, monkeypatch: pytest.MonkeyPatch, error: Exception, line: str
) -> None:
    def fails(case: Case) -> dict[str, int]:
        raise error

    monkeypatch.setitem(METHODS, SIMULATE, Method(fails))
    assert run_task(made.tasks[0]).error == line


def test_a_point_that_takes_too_long_fails() -> None:
    rows, _ = run_sweep(CONFIG, timeout_s=1e-9)
    assert set(rows["error"]) == {"timeout: not finished after 1e-09 s"}


def test_a_worker_with_other_versions_is_refused(made: Plan) -> None:
    outcome = run_task(made.tasks[0], versions={**planning.result_versions(), "numpy": "1.0"})
    assert outcome.error.startswith("the worker has other versions: numpy is 1.0 for the sweep, ")
