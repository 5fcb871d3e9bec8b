"""``run.json``: what the results in a folder are of, so that they can be repeated and not mixed up.

Every folder says versions, configuration, digests of workloads, number of points and machines;
sweeps and runs add their own. ``reproduce``, which has a configuration for each table, has versions
and what was set.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from simmpp.common.files import write_text
from simmpp.config.config import Config, described
from simmpp.machine.machine import THREAD, Machine
from simmpp.methods.simulation import cells
from simmpp.policy.parameters import PolicyParameters
from simmpp.run.machines import MACHINE_OF, machines_told
from simmpp.run.point import Point, PolicyRun, ceiling_of, reference_of
from simmpp.run.profit import ratio
from simmpp.run.provenance import all_versions
from simmpp.run.rows import row
from simmpp.run.summary import imbalance, utilisation

SIMULATIONS, FINISHED, FAILED = "simulations", "finished", "failed"
"""Keys of a sweep's: how many simulations are asked for, and what became of them so far."""


def recorded(config: Config) -> dict[str, Any]:
    """The configuration with all its defaults, without the one key that decides no row."""
    return {
        key: value for key, value in described(config).items() if key not in ("check", "advise")
    }


def record(
    config: Config,
    workloads: Mapping[str, Sequence[str]],
    machines: Iterable[Machine],
    points: int,
    further: Mapping[str, Any],
    cells: Iterable[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """The content of a ``run.json``; nothing in it depends on when, where or how fast it ran.

    ``workloads`` are the digests of each scene's, by its name; equal machines are there once.
    ``cells`` are what rows of each of the machines have in the columns of swept keys.
    """
    all_constants = [*map(asdict, machines)]
    constants = {json.dumps(values): values for values in all_constants}
    numbers = {text: number for number, text in enumerate(constants)}
    told = [numbers[json.dumps(values)] for values in all_constants]
    which = machines_told(list(constants.values()), zip(cells, told, strict=False))
    return {
        "versions": all_versions(),
        "config": recorded(config),
        "workloads": dict(workloads),
        "points": points,
        **further,
        "machines": list(constants.values()),
        **({MACHINE_OF: which} if which else {}),
    }


def record_of_run(point: Point, runs: Sequence[PolicyRun]) -> dict[str, Any]:
    """That of a run, with the workload's size and every number of every policy."""
    workload = point.workload
    further = {
        "seed": point.seed,
        "workload": {
            "picture": list(workload.picture),
            "rays": workload.n_rays,
            "tests": workload.n_tests,
            "objects": workload.n_objects,
        },
        "effective_fraction": point.placement.effective_fraction,
        "bound_ps": point.bound_ps,
        "policies": [_policy(point, run, runs) for run in runs],
    }
    workloads = {workload.name: [workload.digest]}
    return record(point.config, workloads, [point.machine], len(runs), further)


def _parameters(policy: PolicyParameters) -> dict[str, Any]:
    """What was set of a policy; of one's own, its file's digest as well."""
    said = {field.name: getattr(policy, field.name) for field in fields(policy)}
    del said["file"], said["set"]
    return said | {"min_load": str(policy.min_load)} | policy.own


def _policy(point: Point, run: PolicyRun, runs: Sequence[PolicyRun]) -> dict[str, Any]:
    result, base, ceiling = run.result, reference_of(runs).result, ceiling_of(runs)
    parameters = _parameters(run.parameters)
    share = utilisation(run)
    of_threads = point.machine.service == THREAD
    return {
        "policy": run.parameters.title,
        "parameters": parameters,
        "named": run.named,
        "time_profit": _finite(ratio(base.makespan_ps, result.makespan_ps)),
        "time_profit_against_replicated": ceiling
        and _finite(ratio(ceiling.result.makespan_ps, result.makespan_ps)),
        "message_profit": _finite(ratio(base.messages, result.messages)),
        **cells(result),
        "effective_fraction": row(point, run)["effective_fraction"],
        "messages_received": result.messages_received,
        "utilisation": {"min": share.min(), "mean": share.mean(), "max": share.max()},
        "imbalance": imbalance(run),
        "rules_never_fired": list(result.rules_never_fired),
        "wall_s": run.wall_s,
        "pes": {
            "compute_ps": result.compute_ps.tolist(),
            "communication_ps": result.communication_ps.tolist(),
            "waiting_ps": result.waiting_ps.tolist(),
            **({"service_ps": result.service_ps.tolist()} if of_threads else {}),
        },
    }


def _finite(value: float) -> float | str:
    """JSON has no infinity."""
    return value if math.isfinite(value) else "inf"


def write_record(content: Mapping[str, Any], path: Path) -> None:
    """Write ``run.json``."""
    write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", path)


def read_record(path: Path) -> dict[str, Any]:
    """Read it; raises OSError, or ValueError if it is no JSON object."""
    content = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(content, dict):
        raise ValueError(f"{path.name}: expected a JSON object")
    if "machine" in content:  # as `run --out` once wrote it
        content["machines"] = [content.pop("machine")]
    return content
