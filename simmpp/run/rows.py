"""Rows of ``results.csv``: how one is made, in which order they are written, how they are found.

Rows are known by their *place* (all that names a point but its policy), their policy and their
seed. Profits compare two policies of one place seed by seed, for policies share a seed's draws.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from pathlib import Path

from simmpp.common.files import Row, sort_key, write_csv
from simmpp.config.config import Config
from simmpp.engine.filling import effective_fraction
from simmpp.methods.columns import BOUNDED, FURTHER, KEYS, METHOD, NUMBERS, result_columns, told_by
from simmpp.methods.simulation import cells, unfit_cells
from simmpp.methods.table import METHODS
from simmpp.policy.parameters import PolicyParameters
from simmpp.run.fitting import Fitting, fittings
from simmpp.run.point import Point, PolicyRun

RESULTS, PARQUET = "results.csv", "results.parquet"
PROFITS, TIMINGS, RECORD = "profits.csv", "timings.csv", "run.json"
KNEES = "knees.csv"
"""Files of a folder of results."""

Seeds = dict[int, Row]
"""The rows of one policy at one place."""
Places = dict[tuple[Hashable, ...], dict[str, Seeds]]
"""Rows by place and policy."""


def point_row(
    config: Config,
    scene: str,
    policy: str,
    seed: int,
    numbers: Mapping[str, int | str],
    effective_fraction: float,
    error: str = "",
) -> Row:
    """The row of a point; a memory given in bytes has no fraction, a failed point no numbers."""
    settings, memory = config.settings, config.memory
    return {
        "scene": scene,
        "processors": config.processors,
        "fraction": "" if memory.bytes is not None or memory.fills else float(memory.share),
        "effective_fraction": "" if error else effective_fraction,
        "policy": policy,
        "seed": seed,
        "method": settings.method,
        "engine": settings.engine if METHODS[settings.method].uses_engine else "",
        **dict.fromkeys((*NUMBERS, *FURTHER), ""),
        **numbers,
        "error": error,
    }


def row(point: Point, run: PolicyRun) -> Row:
    """The row of one policy that was run at one point."""
    effective = _effective_fraction(point, run.parameters)
    scene, numbers = point.workload.name, cells(run.result)
    return point_row(point.config, scene, run.parameters.title, point.seed, numbers, effective)


def unfit_row(point: Point, policy: Fitting) -> Row:
    """The row of a policy that does not fit: no more than that, and what it lacks."""
    scene_bytes = int(point.workload.object_bytes.sum())
    numbers = unfit_cells(policy.needs, point.placement, scene_bytes)
    effective = _effective_fraction(point, policy.parameters)
    title, scene = policy.parameters.title, point.workload.name
    return point_row(point.config, scene, title, point.seed, numbers, effective)


def _effective_fraction(point: Point, policy: PolicyParameters) -> float:
    return effective_fraction(point.workload, point.machine, point.placement, policy)


def in_order(rows: Iterable[Row], further: Sequence[str] = ()) -> list[Row]:
    """Rows sorted by their keys."""
    return sorted(rows, key=lambda row: sort_key(row, (*KEYS, *further, METHOD, "engine")))


def write_rows(runs: Sequence[PolicyRun], point: Point, path: Path) -> None:
    """Write ``results.csv`` of the policies that were run at one point."""
    uses = {use for run in runs for use in run.parameters.uses} | {*point.machine.uses}
    if point.config.memory.capacity is not None:
        uses.add(BOUNDED)
    rows = [row(point, run) for run in runs]
    columns = result_columns(uses=uses | told_by(rows))
    if point.placement.capacity is not None:
        rows += [unfit_row(point, each) for each in fittings(point) if not each.fits]
    write_csv(in_order(rows), columns, path)


def by_place(rows: Iterable[Row], names: Sequence[str]) -> Places:
    """Rows by the columns ``names`` of their place, by policy and seed; of equal ones the last."""
    places: Places = {}
    for row in rows:
        policies = places.setdefault(tuple(row[name] for name in names), {})
        policies.setdefault(row["policy"], {})[row["seed"]] = row
    return places


def finished(seeds: Seeds) -> Seeds:
    """Those that came to their end."""
    return {seed: row for seed, row in seeds.items() if has_ended(row)}


def has_ended(row: Row) -> bool:
    """Whether it is of a run that came to its end; others failed, did not fit or were stuck."""
    return not row["error"] and row.get("makespan_ps") != ""


def is_unfit(row: Row) -> bool:
    """Whether a policy did not fit into the memory of the PEs, or came to no end in it."""
    return not (row["error"] or has_ended(row)) and (
        row.get("fits") == 0 or row.get("infeasible") == 1
    )


def pairs(above: Seeds, below: Seeds) -> list[tuple[Row, Row]]:
    """The two rows of each seed that both have finished, seeds rising."""
    upper, lower = finished(above), finished(below)
    return [(upper[seed], lower[seed]) for seed in sorted(upper.keys() & lower.keys())]
