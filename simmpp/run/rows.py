"""Rows of ``results.csv`` from runs, and their order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from simmpp.common.files import Row, sort_key, write_csv
from simmpp.methods.columns import KEYS, METHOD, result_columns
from simmpp.methods.simulation import integers
from simmpp.run.point import Point, PolicyRun


def numbers(run: PolicyRun) -> dict[str, int]:
    """The integers of a run, by column."""
    return integers(run.result)


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
    return sorted(rows, key=lambda row: sort_key(row, (*KEYS, *further, METHOD, "engine")))


def write_rows(rows: Iterable[Row], path: Path, further: Sequence[str] = ()) -> None:
    """Write ``results.csv``, sorted."""
    write_csv(in_order(rows, further), result_columns(further), path)
