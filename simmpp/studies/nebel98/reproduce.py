"""The experiments of Nebel 1998 run again: rows, figures and the verdict on each claim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from importlib.resources import as_file, files
from pathlib import Path

from simmpp.common.files import Row, write_csv, write_text
from simmpp.common.folders import REPRODUCTION, claimed
from simmpp.config.config import Config, load_config
from simmpp.plot.matplotlib_panels import draw
from simmpp.run.inputs import workload_of
from simmpp.run.provenance import all_versions, result_versions
from simmpp.run.record import write_record
from simmpp.run.rows import RECORD
from simmpp.studies.nebel98.claims import judge
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.figure2 import reproduce_figure2
from simmpp.studies.nebel98.figures import FIGURES
from simmpp.studies.nebel98.verdict import CLAIM_COLUMNS, Verdict
from simmpp.sweeps.journal import Journal
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import Watcher, run_plans

EXPERIMENTS = ("figure3", "figure4", "figure6", "figure6-1024", "rings7")
"""Stems of configurations, of the rows they give and of the figures that show them."""
MODEL = "figure2"
"""Likewise, of the analytical model."""
CLAIMS = "claims.csv"
_FOLDER = files("simmpp") / "studies" / "nebel98"


@dataclass(frozen=True)
class Reproduction:
    """What came out."""

    verdicts: list[Verdict]
    failed: list[str]
    """The error of each row that has one."""


def configuration(name: str) -> str:
    """The YAML text of an experiment."""
    return (_FOLDER / f"{name}.yaml").read_text(encoding="utf-8")


def reproduce(
    out: Path,
    *,
    seeds: int | None = None,
    resolution: int | None = None,
    workers: int = 1,
    watcher: Watcher | None = None,
) -> Reproduction:
    """Simulate what isn't simulated yet in the folder ``out``; write everything there.

    ``seeds`` (their number) and ``resolution`` (pixels along each side) take the place of those of
    the experiments. A point that several experiments have is simulated once, and kept in ``out``
    whatever the seeds and the resolution of the next call are.
    Raises ConfigError if the folder holds results of other versions.
    """
    overrides = _overrides(seeds, resolution)
    plans = {name: plan_of(load_experiment(name, overrides)) for name in EXPERIMENTS}
    with claimed(out, REPRODUCTION):
        with closing(Journal(out, {"versions": result_versions()})) as journal:
            run_plans(plans.values(), journal, workers, watcher)
            rows = {name: plan.rows(journal.outcomes) for name, plan in plans.items()}
            model = load_experiment(MODEL, overrides)
            verdicts = reproduce_figure2(model, workload_of(model), out)
            columns = {name: plan.result_columns for name, plan in plans.items()}
        return _report(rows, columns, verdicts, overrides, out)


def _overrides(seeds: int | None, resolution: int | None) -> tuple[str, ...]:
    keys = [] if seeds is None else [f"seeds={list(range(seeds))}"]
    keys += [] if resolution is None else [f"picture.resolution={resolution}"]
    return tuple(keys)


def load_experiment(name: str, overrides: Sequence[str] = ()) -> Config:
    """The configuration of an experiment."""
    with as_file(_FOLDER / f"{name}.yaml") as path:
        return load_config(path, overrides)


def _report(
    rows: Mapping[str, list[Row]],
    columns: Mapping[str, Sequence[str]],
    verdicts: list[Verdict],
    overrides: Sequence[str],
    out: Path,
) -> Reproduction:
    """Write configurations, rows, figures, claims and the record; ``verdicts`` are the model's."""
    for name in (MODEL, *rows):
        write_text(_said(overrides) + configuration(name), out / f"{name}.yaml")
    for name, table in rows.items():
        write_csv(table, columns[name], out / f"{name}.csv")
    measured = {name: RowIndex(table) for name, table in rows.items()}
    for figure, (name, panels) in FIGURES.items():
        draw(panels(measured[name]), out / figure)
    verdicts += judge(Evidence(measured["figure3"], measured["figure4"], measured["figure6"]))
    write_csv([asdict(verdict) for verdict in verdicts], CLAIM_COLUMNS, out / CLAIMS)
    write_record({"set": list(overrides), "versions": all_versions()}, out / RECORD)
    errors = [row["error"] for table in rows.values() for row in table if row["error"]]
    return Reproduction(verdicts, errors)


def _said(overrides: Sequence[str]) -> str:
    """A comment on top of a configuration that was not run as it is."""
    return f"# Run with {' '.join(f'--set {key!r}' for key in overrides)}\n" if overrides else ""
