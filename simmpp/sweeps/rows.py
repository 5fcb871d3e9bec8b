"""``results.csv``: one row per policy, with the columns that every later step reads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from simmpp.engine.result import Result
from simmpp.sweeps.point import Point, PolicyRun
from simmpp.sweeps.tables import Row, sort_key, write_csv

KEYS = ("scene", "processors", "fraction", "effective_fraction", "policy", "seed")
NUMBERS = (
    "makespan_ps",
    "messages",
    "request_messages",
    "object_messages",
    "ray_messages",
    "load_messages",
    "bytes_sent",
    "rays",
    "tests",
    "rays_sent",
    "objects_fetched",
    "compute_ps",
    "communication_ps",
    "waiting_ps",
    "peak_rays",
    "peak_bytes",
    "events",
)
"""Integers of a result; times of PEs are sums over them."""
COLUMNS = (*KEYS, "method", "engine", *NUMBERS, "error")


def result_columns(further: Sequence[str] = ()) -> tuple[str, ...]:
    """The columns of ``results.csv`` with those of a sweep's further keys."""
    return (*KEYS, *further, *COLUMNS[len(KEYS) :])


def numbers(run: PolicyRun) -> dict[str, int]:
    """The integers of a run, by column."""
    return integers(run.result)


def integers(result: Result) -> dict[str, int]:
    """The integers of a result, by column."""
    values = {column: np.atleast_1d(getattr(result, column)) for column in NUMBERS}
    return {column: sum(value.tolist()) for column, value in values.items()}


def row(point: Point, run: PolicyRun) -> Row:
    """The row of one policy at one point; a memory given in bytes has no fraction."""
    memory = point.config.memory
    effective = 1.0 if run.all_resident else point.placement.effective_fraction
    return {
        "scene": point.workload.name,
        "processors": point.machine.processors,
        "fraction": "" if memory.bytes is not None else float(memory.fraction),
        "effective_fraction": effective,
        "policy": run.parameters.title,
        "seed": point.seed,
        "method": point.config.settings.method,
        "engine": run.result.engine,
        **numbers(run),
        "error": "",
    }


def in_order(rows: Iterable[Row], further: Sequence[str] = ()) -> list[Row]:
    """Rows sorted by their keys."""
    return sorted(rows, key=lambda row: sort_key(row, (*KEYS, *further, "method", "engine")))


def write_rows(rows: Iterable[Row], path: Path, further: Sequence[str] = ()) -> None:
    """Write ``results.csv``, sorted."""
    write_csv(in_order(rows, further), result_columns(further), path)
