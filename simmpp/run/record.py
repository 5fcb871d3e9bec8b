"""``run.json``: everything about a run, so that it can be repeated and never mixed up."""

from __future__ import annotations

import json
import math
import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from simmpp.config.config import described
from simmpp.run.point import Point, PolicyRun, ceiling_of, reference_of
from simmpp.run.profit import ratio
from simmpp.run.rows import numbers, row
from simmpp.run.summary import imbalance, utilisation

LIBRARIES = ("simmpp", "numpy", "numba", "simpy", "embreex", "trimesh")


def record(point: Point, runs: Sequence[PolicyRun]) -> dict[str, Any]:
    """The configuration with all its defaults, versions, and every number of every policy."""
    workload = point.workload
    return {
        "versions": {"python": platform.python_version()} | {n: version(n) for n in LIBRARIES},
        "config": described(point.config),
        "machine": asdict(point.machine),
        "seed": point.seed,
        "workload": {
            "name": workload.name,
            "digest": workload.digest,
            "picture": list(workload.picture),
            "rays": workload.n_rays,
            "tests": workload.n_tests,
            "objects": workload.n_objects,
        },
        "effective_fraction": point.placement.effective_fraction,
        "bound_ps": point.bound_ps,
        "policies": [_policy(point, run, list(runs)) for run in runs],
    }


def _policy(point: Point, run: PolicyRun, runs: list[PolicyRun]) -> dict[str, Any]:
    result, base, ceiling = run.result, reference_of(runs).result, ceiling_of(runs)
    parameters = asdict(run.parameters)
    parameters["min_load"] = str(parameters["min_load"])
    share = utilisation(run)
    return {
        "policy": run.parameters.title,
        "parameters": parameters,
        "named": run.named,
        "time_profit": _finite(ratio(base.makespan_ps, result.makespan_ps)),
        "time_profit_against_replicated": ceiling
        and _finite(ratio(ceiling.result.makespan_ps, result.makespan_ps)),
        "message_profit": _finite(ratio(base.messages, result.messages)),
        **numbers(run),
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
        },
    }


def _finite(value: float) -> float | str:
    """JSON has no infinity."""
    return value if math.isfinite(value) else "inf"


def write_record(content: dict[str, Any], path: Path) -> None:
    """Write ``run.json``."""
    text = json.dumps(content, indent=1, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8", newline="\n")
