"""The whole of it: a configuration's question, the race of its candidates, and the advice."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from math import inf
from pathlib import Path
from types import NoneType

from simmpp.common.errors import ConfigError
from simmpp.common.validate import require_kind, require_whole
from simmpp.config.advice import AdviseSettings
from simmpp.config.config import Config, config_from_mapping, load_config
from simmpp.run.inputs import cache_workload, workload_of
from simmpp.run.point import refuse_models
from simmpp.studies.advise.advice import Advice, weight_of
from simmpp.studies.advise.answer import sentences_of, settings_of
from simmpp.studies.advise.bounds import bound_of
from simmpp.studies.advise.candidates import Candidate, candidates_of, capacity_of, sizes_of
from simmpp.studies.advise.constants import constants_of
from simmpp.studies.advise.least import least_nodes
from simmpp.studies.advise.memory_map import memory_map
from simmpp.studies.advise.part import held_workload
from simmpp.studies.advise.racing import Ask, Contender, Race
from simmpp.studies.advise.running import OutOfTime, Run, Watcher
from simmpp.studies.advise.sensitivity import (
    Remeasure,
    Study,
    Values,
    machines_drawn,
    rivals_of,
)
from simmpp.studies.advise.table import rows_of
from simmpp.studies.advise.verdict import Contest
from simmpp.sweeps.executors import pool_for
from simmpp.sweeps.worker import keep_workload, run_task


def contest_of(config: Config, fitting: list[Candidate], bounds: list[int], run: Run) -> Contest:
    """The race of candidates for the goal of the question."""
    asked = config.settings.advise or AdviseSettings()
    weights = [weight_of(asked, candidate) for candidate in fitting]

    def measure(asks: Sequence[Ask]) -> Iterator[tuple[Ask, float]]:
        tasks = {(n, seed): fitting[n].task(seed) for n, seed in asks}
        by_key = {task.key: ask for ask, task in tasks.items()}
        for task, makespan in run.one_by_one(list(tasks.values())):
            n, seed = by_key[task.key]
            yield (n, seed), makespan * weights[n]

    contenders = [
        Contender(float(bound * weight), candidate.is_drawn)
        for candidate, bound, weight in zip(fitting, bounds, weights, strict=True)
    ]
    limit = float(asked.goal) if isinstance(asked.goal, int) else inf
    race = Race(contenders, measure, float(asked.indifference))
    return Contest(race, [candidate.order for candidate in fitting], limit)


def advise(
    config: Config | Mapping[str, object] | str | Path,
    *,
    workers: int = 1,
    cluster: str | None = None,
    seconds: float | None = None,
    maps: bool = False,
    watcher: Watcher | None = None,
) -> Advice:
    """Say which policy on how many nodes: the question is a configuration's key ``advise``.

    Candidates are simulated in this process, in ``workers`` processes or on the Dask ``cluster`` of
    that address; what comes out is the same. After ``seconds``, if given, or Ctrl-C while it
    simulates, the advice is what was best until then, with less confidence or none. With ``maps``
    it is also found what would win with less and with more memory.
    Raises InputError if the configuration is wrong.
    """
    require_kind("config", config, Mapping, Config, str, Path)
    require_whole("workers", workers, 1)
    require_kind("cluster", cluster, str, NoneType)
    require_kind("seconds", seconds, float, int, NoneType)
    if seconds is not None and not 0 < seconds < inf:
        raise ConfigError(f"seconds: value {seconds}: expected seconds above 0")
    if isinstance(config, str | Path):
        config = load_config(config)
    elif not isinstance(config, Config):
        config = config_from_mapping(config)
    deadline_s = inf if seconds is None else time.monotonic() + seconds
    watcher = watcher or Watcher()
    advice = asked_of(config, watcher)
    if advice.fitting:
        with closing(pool_for(workers, cluster, run_task)) as pool:
            _find(advice, Run(pool, deadline_s, watcher), maps=maps)
    advice.sentences, advice.settings = sentences_of(advice), settings_of(advice)
    advice.rows = rows_of(advice)
    return advice


def asked_of(config: Config, watcher: Watcher) -> Advice:
    """The question, with its candidates, before anything is simulated."""
    refuse_models(config)
    capacity_of(config)
    config, workload, left_out = held_workload(config, watcher)
    cache_workload(config, workload.digest)
    keep_workload(workload)
    candidates = candidates_of(config, workload)
    fitting = [candidate for candidate in candidates if candidate.fits]
    bounds = [bound_of(candidate, workload) for candidate in fitting]
    contest = contest_of(config, fitting, bounds, Run.never())
    advice = Advice(config, workload.name, candidates, bounds, contest, contest.verdict())
    advice.left_out = left_out
    if not fitting:
        advice.least_nodes = least_nodes(config, workload, max(sizes_of(config)))
    return advice


def _find(advice: Advice, run: Run, *, maps: bool) -> None:
    """Race, and see what the winner hangs on; whatever ends it, what is known is kept."""
    contest = contest_of(advice.config, advice.fitting, advice.bounds, run)
    advice.contest, study = contest, None
    try:
        contest.run()
        advice.runs = run.count
        advice.verdict = contest.verdict()
        if advice.chosen is not None and advice.chosen.has_credits:
            advice.beyond_bytes = run.exceeds_bytes(advice.chosen.task_without_credits())
        study = study_of(advice, run)
        if study is not None:
            constants = constants_of(advice.config)
            study.draw(machines_drawn(constants))
            study.vary(constants)
        if maps:
            _map(advice, run)
    except OutOfTime:
        advice.broken_off = "the time was over"
    except KeyboardInterrupt as interrupt:
        advice.broken_off, advice.interrupt = "interrupted", interrupt
    if study is None:
        advice.runs, advice.verdict = run.count, contest.verdict()
    else:
        advice.sensitivity = study.result()
        advice.further_runs = run.count - advice.runs


def _map(advice: Advice, run: Run) -> None:
    """What would win with other memory."""
    workload = workload_of(advice.config)
    for place in memory_map(advice.config, workload, _promising(advice), run):
        advice.places.append(place)


def _promising(advice: Advice) -> dict[int, list[str]]:
    """For each number of nodes the names of setups: what has not fit, what was best, the others."""
    race, fitting = advice.contest.race, advice.fitting
    ended = [(n, fitting[n]) for n in sorted(race.costs, key=lambda n: (race.mean(n), n))]
    found = {}
    for size in sorted({each.processors for each in advice.candidates}):
        unfit = [e.setup.name for e in advice.candidates if e.processors == size and not e.fits]
        here = [each.setup.name for _, each in ended if each.processors == size]
        elsewhere = [each.setup.name for _, each in ended if each.processors != size]
        found[size] = list(dict.fromkeys([*unfit, *here, *elsewhere]))
    return found


def study_of(advice: Advice, run: Run) -> Study | None:
    """What is to be done about the constants; None if nothing is advised."""
    chosen, asked = advice.verdict.chosen, advice.asked
    if chosen is None:
        return None
    others = [] if isinstance(asked.goal, int) else advice.others()
    rivals = rivals_of(chosen, others, [candidate.kind for candidate in advice.fitting])
    indifference, limit = float(asked.indifference), advice.contest.limit
    return Study(chosen, rivals, _remeasured(advice, run), indifference, limit)


def _remeasured(advice: Advice, run: Run) -> Remeasure:
    """Simulates candidates on changed machines; what can't be there has no end."""

    def measure(machines: Sequence[Values], numbers: Sequence[int]) -> list[list[float]]:
        asked = [
            (advice.fitting[n].changed_task(machine), weight_of(advice.asked, advice.fitting[n]))
            for machine in machines
            for n in numbers
        ]
        makespans = iter(run([task for task, _ in asked if task is not None]))
        costs = [inf if task is None else next(makespans) * weight for task, weight in asked]
        return [costs[at : at + len(numbers)] for at in range(0, len(costs), len(numbers))]

    return measure
