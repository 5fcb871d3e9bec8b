"""Simulate all candidates of all pairs: what the advisor's answers are judged by.

``python experiments/advise/truth.py PARTS`` writes a file for each pair into the folder PARTS, goes
on from those that are there, and in the end writes ``truth.parquet`` and ``candidates.parquet``.
Seeds 0 to 7 are the advisor's, 8 to 15 the truth. Candidates that are within NEAR of the best on as
many nodes are simulated on machines with other constants, too: the advisor's, and as the truth
others that are drawn likewise.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from pairs import Pair, config_of, developed, judged

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row, write_parquet, write_text
from simmpp.config.config import Config
from simmpp.engine.simulate import simulate
from simmpp.machine.machine import POLLED, TORUS, Machine
from simmpp.machine.torus import default_shape
from simmpp.model.analytical import analytical, rays_of
from simmpp.model.costs import costs_of
from simmpp.placement.place import place
from simmpp.run.inputs import workload_of
from simmpp.studies.advise.bounds import bound_of
from simmpp.studies.advise.candidates import Candidate, candidates_of, capacity_of
from simmpp.studies.advise.constants import constants_of, drawn, with_constants
from simmpp.studies.advise.sensitivity import Values, machines_drawn
from simmpp.workload.workload import Workload

HERE = Path(__file__).parent
AS_IN_1998: dict[str, Any] = {
    "topology": TORUS,
    "levels": (),
    "service": POLLED,
    "compute_startup_ps": 0,
    "least_tests": 0,
    "noise": "0",
}
"""What the paper's formulas know: of other machines they get the startups and the bandwidths."""
SEEDS, TRUE_SEEDS = 8, 8
TRUE_DRAWS = 4
NEAR = 1.4
RUNS = ("pair", "number", "draw", "seed", "makespan_ps", "held_bytes")
CANDIDATES = (
    "pair",
    "number",
    "setup",
    "policy",
    "processors",
    "is_drawn",
    "fits",
    "least_bytes",
    "lacking_bytes",
    "capacity_bytes",
    "bound_ps",
    "model_ps",
    "cpu_s",
)
"""``draw``: -1 is the machine as it is; ``makespan_ps`` is empty where a run came to no end."""


@dataclass(frozen=True, eq=False)
class Bench:
    """What all runs of a pair share."""

    config: Config
    workload: Workload
    candidates: list[Candidate]
    machines: list[Values]
    """The advisor's draws of constants, then those of the truth."""
    _made: dict[tuple[int, int], Machine] = field(default_factory=dict)

    def machine(self, candidate: Candidate, draw: int) -> Machine:
        """With the constants of a draw; -1: as it is."""
        key = candidate.processors, draw
        if key not in self._made:
            values = self.machines[draw] if draw >= 0 else {}
            changed = with_constants(candidate.config, values)
            self._made[key] = changed.machine_for(candidate.processors)
        return self._made[key]

    def run(self, candidate: Candidate, machine: Machine, seed: int) -> tuple[int | str, int | str]:
        """Makespan and bytes held; empty where it came to no end, or nothing bounds them."""
        config = candidate.config
        placement = place(
            self.workload, candidate.processors, config.memory, config.settings.placement, seed
        )
        try:
            result = simulate(self.workload, machine, placement, candidate.policy, seed=seed)
        except ConfigError:  # with larger rays it does not fit any more
            return "", ""
        use = result.memory
        if use is None:
            return result.makespan_ps, ""
        held = use.peak_resident + use.peak_fetched + use.peak_ray_queue + use.peak_receive
        return ("", held) if use.infeasible else (result.makespan_ps, held)


def bench_of(pair: Pair, folder: Path) -> Bench:
    """Trace the scene, and work out the candidates."""
    config = config_of(pair, folder)
    workload = workload_of(config)
    constants = constants_of(config)
    machines = [*machines_drawn(constants), *drawn(constants, TRUE_DRAWS, "truth")]
    return Bench(config, workload, candidates_of(config, workload), machines)


def record(pair: Pair, folder: Path) -> dict[str, Any]:
    """All runs of a pair."""
    began_s, bench = time.process_time(), bench_of(pair, folder)
    fitting = [candidate for candidate in bench.candidates if candidate.fits]
    runs = [row for n, candidate in enumerate(fitting) for row in _seeds(bench, candidate, n)]
    near = _near(fitting, runs)
    runs += [row for n in near for row in _draws(bench, fitting[n], n)]
    cpu_s = round(time.process_time() - began_s, 1)
    known = [_about(bench, candidate) | {"cpu_s": cpu_s} for candidate in bench.candidates]
    return {"runs": runs, "candidates": known}


def _seeds(bench: Bench, candidate: Candidate, number: int) -> Iterator[Row]:
    machine = bench.machine(candidate, -1)
    for seed in range(SEEDS + TRUE_SEEDS if candidate.is_drawn else 1):
        makespan, held = bench.run(candidate, machine, seed)
        yield _row(number, -1, seed, makespan, held)


def _draws(bench: Bench, candidate: Candidate, number: int) -> Iterator[Row]:
    for draw in range(len(bench.machines)):
        makespan, held = bench.run(candidate, bench.machine(candidate, draw), 0)
        yield _row(number, draw, 0, makespan, held)


def _row(number: int, draw: int, seed: int, makespan: int | str, held: int | str) -> Row:
    return dict(zip(RUNS[1:], (number, draw, seed, makespan, held), strict=True))


def _near(fitting: list[Candidate], runs: list[Row]) -> list[int]:
    """Candidates that may win on some machine."""
    first = {row["number"]: row["makespan_ps"] for row in runs if row["seed"] == 0}
    best: dict[int, float] = {}
    for n, makespan in first.items():
        if makespan != "":
            size = fitting[n].processors
            best[size] = min(best.get(size, math.inf), makespan)
    return [
        n
        for n, makespan in first.items()
        if makespan != "" and makespan <= NEAR * best[fitting[n].processors]
    ]


def _about(bench: Bench, candidate: Candidate) -> Row:
    number = [each for each in bench.candidates if each.fits]
    return {
        "number": number.index(candidate) if candidate.fits else -1,
        "setup": candidate.setup.name,
        "policy": candidate.policy.name,
        "processors": candidate.processors,
        "is_drawn": int(candidate.is_drawn),
        "fits": int(candidate.fits),
        "least_bytes": candidate.least_bytes,
        "lacking_bytes": candidate.lacking_bytes,
        "capacity_bytes": capacity_of(bench.config),
        "bound_ps": bound_of(candidate, bench.workload) if candidate.fits else "",
        "model_ps": _model(bench, candidate) if candidate.fits else "",
    }


def _model(bench: Bench, candidate: Candidate) -> int | str:
    """The makespan by the paper's formulas, of the dataflows that it knows."""
    if candidate.policy.name not in ("object", "ray"):
        return ""
    held = np.minimum(1.0, capacity_of(bench.config) / bench.workload.object_bytes.sum())
    plain = replace(candidate.machine, shape=default_shape(candidate.processors), **AS_IN_1998)
    costs, rays = costs_of(plain, bench.workload), rays_of(bench.workload)
    times = analytical(costs, [candidate.processors], [float(held)], rays)
    makespan = times.object if candidate.policy.name == "object" else times.ray
    return round(float(makespan[0, 0]))


def main(folder: Path) -> None:
    """Record what is not there yet, and put all of it together."""
    folder.mkdir(parents=True, exist_ok=True)
    runs: list[Row] = []
    candidates: list[Row] = []
    for pair in (*developed(), *judged()):
        part = folder / f"{pair.name.replace('/', '_')}.json"
        if not part.exists():
            write_text(json.dumps(record(pair, folder)), part)
            print(part.name, flush=True)
        found: dict[str, list[Row]] = json.loads(part.read_text(encoding="utf-8"))
        runs += [{"pair": pair.name, **row} for row in found["runs"]]
        candidates += [{"pair": pair.name, **row} for row in found["candidates"]]
    write_parquet(runs, RUNS, HERE / "truth.parquet")
    write_parquet(candidates, CANDIDATES, HERE / "candidates.parquet")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
