"""The experiments of Nebel 1998 run again: rows, figures and the verdict on each claim."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass, replace
from importlib.resources import as_file, files
from itertools import chain, count
from pathlib import Path

from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv, write_text
from simmpp.common.folders import REPRODUCTION, claimed, note_call
from simmpp.config.config import Config, load_config
from simmpp.config.defaults import READING
from simmpp.config.reading import reading_names
from simmpp.config.settings import DEFAULT_READING
from simmpp.plot.curves import Panel
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
from simmpp.sweeps.plan import Plan, plan_of
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import Watcher, run_plans

EXPERIMENTS = ("figure3", "figure4", "figure6", "figure6-1024", "rings7")
"""Stems of configurations, of the rows they give and of the figures that show them."""
MODEL = "figure2"
"""Likewise, of the analytical model."""
CLAIMS = "claims.csv"
TEXT_ALONE = "plain"
"""The reading whose figures do not name it."""
_FOLDER = files("simmpp") / "studies" / "nebel98"


@dataclass(frozen=True)
class Reproduction:
    """What came out with one reading."""

    reading: str
    """Its name; of a file's, without the folder and the suffix."""
    verdicts: list[Verdict]
    failed: list[str]
    """The error of each row that has one."""


def configuration(name: str) -> str:
    """The YAML text of an experiment."""
    return (_FOLDER / f"{name}.yaml").read_text(encoding="utf-8")


def reproduce(
    out: Path,
    *,
    readings: Sequence[str] = (),
    seeds: int | None = None,
    resolution: int | None = None,
    workers: int = 1,
    watcher: Watcher | None = None,
    call: str = "",
) -> list[Reproduction]:
    """Simulate what isn't simulated yet in the folder ``out``; write everything there.

    With several ``readings`` each has a folder in it, and the claims of all are in ``out``; without
    any it is the default one. ``seeds`` (their number) and ``resolution`` (pixels along each side)
    take the place of those of the experiments. A point that several experiments have is simulated
    once, and kept in ``out`` whatever the seeds and the resolution of the next call are. ``call``
    is the command that goes on if this is interrupted.
    Raises ConfigError if the folder holds results of other versions.
    """
    common = _overrides(seeds, resolution)
    overrides = {name: (*common, f"{READING}={said}") for name, said in named(readings).items()}
    overrides = overrides or {DEFAULT_READING: common}
    plans = {
        name: {experiment: plan_of(load_experiment(experiment, own)) for experiment in EXPERIMENTS}
        for name, own in overrides.items()
    }
    folders = {name: out / name if len(plans) > 1 else out for name in plans}
    with ExitStack() as claims:
        for folder in dict.fromkeys([out, *folders.values()]):
            claims.enter_context(claimed(folder, REPRODUCTION))
        with closing(Journal(out, {"versions": result_versions()})) as journal:
            note_call(out, call)
            run_plans(chain(*(of.values() for of in plans.values())), journal, workers, watcher)
            drawn = _counted(watcher or Watcher(), len(plans) * (len(FIGURES) + 1))
            done = [
                _report(name, plans[name], journal, own, folders[name], drawn)
                for name, own in overrides.items()
            ]
        for one in done:
            _write_claims([one], folders[one.reading], with_reading=bool(readings))
        if len(done) > 1:
            _write_claims(done, out, with_reading=True)
    return done


def named(readings: Sequence[str]) -> dict[str, str]:
    """Readings by the names that their folders have, and they in tables.

    Raises ConfigError for two of one name, or a file that has the name of one of the package.
    """
    names = [Path(reading).stem for reading in readings]
    for name, reading in zip(names, readings, strict=True):
        if names.count(name) > 1 or (name != reading and name in reading_names()):
            raise ConfigError(f"two readings are called {name!r}: expected different names")
    return dict(zip(names, readings, strict=True))


def _overrides(seeds: int | None, resolution: int | None) -> tuple[str, ...]:
    keys = [] if seeds is None else [f"seeds={list(range(seeds))}"]
    keys += [] if resolution is None else [f"picture.resolution={resolution}"]
    return tuple(keys)


def load_experiment(name: str, overrides: Sequence[str] = ()) -> Config:
    """The configuration of an experiment."""
    with as_file(_FOLDER / f"{name}.yaml") as path:
        return load_config(path, overrides)


def _counted(watcher: Watcher, total: int) -> Callable[[], None]:
    """What is called after each figure, of all readings."""
    numbers = count(1)
    watcher.drawing(0, total)
    return lambda: watcher.drawing(next(numbers), total)


def _report(
    reading: str,
    plans: Mapping[str, Plan],
    journal: Journal,
    overrides: Sequence[str],
    out: Path,
    drawn: Callable[[], None],
) -> Reproduction:
    """Write configurations, rows, figures and the record of one reading."""
    # Not at the top: pages, which show the same figures, need no matplotlib.
    from simmpp.plot.matplotlib_panels import draw

    for name in (MODEL, *plans):
        write_text(_said(overrides) + configuration(name), out / f"{name}.yaml")
    rows = {name: plan.rows(journal.outcomes) for name, plan in plans.items()}
    for name, table in rows.items():
        write_csv(table, plans[name].result_columns(table), out / f"{name}.csv")
    measured = {name: RowIndex(table) for name, table in rows.items()}
    for figure, (name, panels) in FIGURES.items():
        draw(_of_reading(panels(measured[name]), reading), out / figure)
        drawn()
    model = load_experiment(MODEL, overrides)
    verdicts = reproduce_figure2(model, workload_of(model), out)
    drawn()
    verdicts += judge(Evidence(measured["figure3"], measured["figure4"], measured["figure6"]))
    facts = {"set": list(overrides), READING: reading, "versions": all_versions()}
    write_record(facts, out / RECORD)
    errors = [row["error"] for table in rows.values() for row in table if row["error"]]
    return Reproduction(reading, verdicts, errors)


def _of_reading(panels: list[Panel], reading: str) -> list[Panel]:
    """The panels with a word on what they are of; the text of the paper alone needs none."""
    if reading == TEXT_ALONE:
        return panels
    return [replace(panel, note=f"{panel.note}; reading {reading}") for panel in panels]


def _write_claims(done: Sequence[Reproduction], out: Path, *, with_reading: bool) -> None:
    """Write ``claims.csv``; which reading a verdict is of stands first, if any was asked for."""
    rows = [{READING: one.reading, **asdict(each)} for one in done for each in one.verdicts]
    columns = (READING, *CLAIM_COLUMNS) if with_reading else CLAIM_COLUMNS
    write_csv(rows, columns, out / CLAIMS)


def _said(overrides: Sequence[str]) -> str:
    """A comment on top of a configuration that was not run as it is."""
    return f"# Run with {' '.join(f'--set {key!r}' for key in overrides)}\n" if overrides else ""
