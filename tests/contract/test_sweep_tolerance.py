"""A sweep with a tolerance asks for the same points whoever runs it, and however often it stops."""

import json
import random
from collections.abc import Iterator
from concurrent.futures import Future
from fractions import Fraction
from pathlib import Path

import pandas
import pytest
from click.testing import CliRunner

from simmpp.cli import main
from simmpp.common.cache import cache_folder
from simmpp.common.errors import ModelError
from simmpp.engine.simulate import simulate
from simmpp.methods import simulation as simulating
from simmpp.sweeps import scheduler, sweep
from simmpp.sweeps.executors import Pool, SerialExecutor
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.stopping import FEWEST
from simmpp.sweeps.sweep import run_sweep
from simmpp.sweeps.task import Task
from simmpp.sweeps.worker import run_task

TOLERANCE, MOST = Fraction(6, 100), 24
CONFIG = {
    "scene": "tetra:3",
    "reading": "plain",
    "picture": {"resolution": 16},
    "policy": ["ray", "concurrent"],
    "seeds": [7],
    "tolerance": "6%",
    "max_seeds": MOST,
    "refine": True,
    "sweep": {"processors": [3, 8], "memory.fraction": [0.3, 0.5, 0.9, 1]},
}
TABLES = ("results.csv", "results.parquet", "profits.csv", "run.json")
MEASURES = {"time_profit": "makespan_ps", "message_profit": "messages"}


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
        folder = tmp_path_factory.mktemp("cache")
        patch.setenv("SIMMPP_CACHE", str(folder))
        yield folder


def tables(out: Path, **options: object) -> dict[str, bytes]:
    run_sweep(CONFIG, out=out, **options)  # type: ignore[arg-type]
    return {name: (out / name).read_bytes() for name in TABLES}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Path:
    out = tmp_path_factory.mktemp("whole")
    tables(out)
    return out


@pytest.fixture(scope="module")
def expected(whole: Path) -> dict[str, bytes]:
    return {name: (whole / name).read_bytes() for name in TABLES}


def test_each_point_has_the_seeds_that_the_rule_gives_it(whole: Path) -> None:
    """Recomputed from rows of all the seeds there may be, with pandas' own statistics."""
    from scipy import stats

    profits = pandas.read_csv(whole / "profits.csv")
    fractions = sorted(profits["fraction"].unique().tolist())
    everything = {**CONFIG, "seeds": list(range(7, 7 + MOST)), "sweep": {
        "processors": [3, 8], "memory.fraction": fractions,
    }}  # fmt: skip
    for key in ("tolerance", "max_seeds", "refine"):
        del everything[key]
    rows = run_sweep(everything).rows
    counts = set()
    for (nb, x), of_point in profits.groupby(["processors", "fraction"]):
        pool = rows[(rows["processors"] == nb) & (rows["fraction"] == x)]
        n = FEWEST
        while True:
            widest = 0.0
            for column in MEASURES.values():
                wide = pool[pool["seed"] < 7 + n].pivot(
                    index="seed", columns="policy", values=column
                )
                for policy in ("ray", "concurrent"):
                    ratio = wide["object"].astype(float) / wide[policy].astype(float)
                    half = stats.t.ppf(0.9875, n - 1) * ratio.fillna(1).sem()
                    widest = max(widest, half / ratio.fillna(1).mean())
            if widest <= TOLERANCE or n == MOST:
                break
            n = min(MOST, max(n + 1, -int(-n * min(2, (widest / float(TOLERANCE)) ** 2) // 1)))
        assert set(of_point["n"]) == {n}
        counts.add(n)
    assert {FEWEST, MOST} < counts, "some points are easy, some hard, some neither"


def test_policies_share_their_seeds_which_follow_those_given(whole: Path) -> None:
    rows = pandas.read_csv(whole / "results.csv")
    for _, of_point in rows.groupby(["processors", "fraction"]):
        seeds = of_point.groupby("policy")["seed"].apply(list)
        assert len(set(map(tuple, seeds))) == 1
        assert seeds.iloc[0] == list(range(7, 7 + len(seeds.iloc[0])))


def test_nothing_drawn_is_simulated_once_and_known_exactly(whole: Path) -> None:
    profits = pandas.read_csv(whole / "profits.csv")
    everything = profits[profits["fraction"] == 1]
    assert set(everything["n"]) == {FEWEST}
    for measure in MEASURES:
        exactly_one = (everything[measure + end] == 1 for end in ("", "_low", "_high"))
        assert all(map(all, exactly_one))
    record = json.loads((whole / "run.json").read_text())
    assert record["simulations"] < record["points"]
    still = {**CONFIG, "memory": {"residents": "nearest"}, "sweep": {"processors": [8]}}
    del still["refine"]
    ran: list[str] = []
    counting = Pool(SerialExecutor(), 1, lambda task: ran.append(task.key) or run_task(task))  # type: ignore[func-returns-value]
    rows, profits = run_sweep(still, pool=counting)
    assert (len(rows), len(ran)) == (3 * FEWEST, 3)
    assert (profits["time_profit_low"] == profits["time_profit_high"]).all()


def test_points_were_added(whole: Path) -> None:
    profits = pandas.read_csv(whole / "profits.csv")
    lines = profits.groupby("processors")["fraction"].apply(set)
    assert all(line >= {0.3, 0.5, 0.9, 1} for line in lines)
    assert any(line > {0.3, 0.5, 0.9, 1} for line in lines)


def test_any_number_of_workers_writes_the_same(expected: dict[str, bytes], tmp_path: Path) -> None:
    assert tables(tmp_path, workers=2) == expected


def test_both_engines_write_the_same(expected: dict[str, bytes], tmp_path: Path) -> None:
    assert tables(tmp_path, engine="simpy")["profits.csv"] == expected["profits.csv"]


class Shuffled(Pool):
    """Ends tasks in any order, several in flight."""

    def __init__(self, seed: int) -> None:
        super().__init__(SerialExecutor(), 7, run_task)
        self.random, self.flying = random.Random(seed), []  # type: ignore[var-annotated]

    def submit(self, task: Task) -> Future[Outcome]:
        future: Future[Outcome] = Future()
        self.flying.append((future, task))
        self.random.shuffle(self.flying)
        if len(self.flying) > self.random.randrange(7):
            self.end_one()
        return future

    def end_one(self) -> None:
        future, task = self.flying.pop()
        future.set_result(self.run(task))


@pytest.mark.parametrize("seed", range(2))
def test_the_order_of_outcomes_is_irrelevant(
    expected: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    pool = Shuffled(seed)
    real = scheduler.wait

    def wait(flying, **options):  # type: ignore[no-untyped-def]
        while not any(future.done() for future in flying):
            pool.end_one()
        return real(flying, **options)

    monkeypatch.setattr(scheduler, "wait", wait)
    assert tables(tmp_path, pool=pool) == expected


def test_it_continues_from_any_part_of_its_journal(
    whole: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    journal = (whole / "points.jsonl").read_bytes()
    for part in (0.1, 0.6, 1.0):
        (tmp_path / "points.jsonl").write_bytes(journal[: int(part * len(journal))])
        assert tables(tmp_path) == expected


def test_an_interrupted_sweep_has_its_tables_and_goes_on(
    expected: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Impatient(sweep.Watcher):
        left = 40

        def simulated(self, outcome: object) -> None:
            self.left -= 1
            if self.left == 0:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tables(tmp_path, watcher=Impatient())
    assert 0 < len(pandas.read_csv(tmp_path / "results.csv")) < 80
    assert tables(tmp_path) == expected


def test_a_failed_seed_stops_its_point_until_it_is_run_again(
    expected: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def starving(workload, machine, placement, policy, **options):  # type: ignore[no-untyped-def]
        if policy.name == "ray" and machine.processors == 8 and placement.effective_fraction < 0.4:
            raise ModelError("ray 3 waits for ever")
        return simulate(workload, machine, placement, policy, **options)

    with monkeypatch.context() as patch:
        patch.setattr(simulating, "simulate", starving)
        tables(tmp_path)
    rows = pandas.read_csv(tmp_path / "results.csv")
    failed = rows[rows["error"].notna()]
    assert set(failed["seed"]) == set(range(7, 7 + FEWEST))
    assert tables(tmp_path) == expected


def test_the_command_names_what_it_did_not_reach(tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text(json.dumps({**CONFIG, "tolerance": "1%", "refine": False}))
    done = CliRunner().invoke(
        main, ["sweep", str(path), "--workers", "1", "--out", str(tmp_path / "o")]
    )
    assert done.exit_code == 0, done.output
    assert "3 of 8 points have both profits within 0.01, with 8 to 24 seeds" in done.stdout
    lines = [line for line in done.stdout.splitlines() if line.startswith("not with max_seeds 24")]
    assert len(lines) == 5
    assert lines[0].startswith("not with max_seeds 24: scene tetra:3, processors 3, fraction 0.5: ")
    assert "ray message profit +- " in lines[0]


def test_a_number_of_seeds_that_all_points_have_is_said_once(tmp_path: Path) -> None:
    everything = {**CONFIG, "refine": False, "sweep": {"memory.fraction": [1]}}
    path = tmp_path / "c.yaml"
    path.write_text(json.dumps(everything))
    done = CliRunner().invoke(
        main, ["sweep", str(path), "--workers", "1", "--out", str(tmp_path / "o")]
    )
    assert "1 of 1 points have both profits within 0.06, with 8 seeds" in done.stdout


def test_check_with_a_tolerance(tmp_path: Path) -> None:
    path, baseline = tmp_path / "c.yaml", tmp_path / "baseline" / "profits.csv"
    path.write_text(json.dumps(CONFIG))
    arguments = ["check", str(path), "--baseline", str(baseline), "--workers", "1"]
    assert CliRunner().invoke(main, [*arguments, "--update"]).exit_code == 0
    done = CliRunner().invoke(main, arguments)
    assert (done.exit_code, "nothing moved" in done.output) == (0, True), done.output
