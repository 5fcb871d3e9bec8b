"""The baseline of `simmpp check`: a committed profits.csv with results.csv and run.json beside it.

These are files of a sweep. Their ``run.json`` also holds the SHA-256 of the other two, so that a
baseline that was merged by hand, or of which an update was interrupted, is noticed. The versions
that it records are for people and are not compared: float64 decides hits and integers are the
clock, so no version of numba or embreex changes a row.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.files import copy, read_csv
from simmpp.common.folders import last_call
from simmpp.config.config import Config, config_from_mapping, described, with_key
from simmpp.config.defaults import READING
from simmpp.config.own_policies import FILE
from simmpp.config.reading import reading_names
from simmpp.methods.columns import COLUMNS
from simmpp.run.provenance import difference
from simmpp.run.record import read_record, write_record
from simmpp.run.rows import PROFITS, RECORD, RESULTS
from simmpp.run.standing import recorded_standing
from simmpp.studies.check.moves import Sweep
from simmpp.sweeps.profits import profit_columns

DIGESTS = "sha256"
"""Key of ``run.json``: the other files' digests."""
IRRELEVANT_TO_INTEGERS = ("check", "engine")
"""Keys of a configuration that change no integer. A journal has no such exception for the engine,
which is a column of its rows."""
BEFORE_READINGS = "plain"
"""The reading of a baseline that names none."""
MACHINES, WORKLOADS = "machines", "workloads"
"""What of ``run.json`` explains moves."""
UPDATE = "run with --update to make one"


def baseline_folder(path: Path) -> Path:
    """The folder of a baseline that is named by its profits.csv or by itself."""
    if path.is_dir() or not (path.suffix or path.exists()):
        return path
    if path.name != PROFITS:
        raise _wrong(path, f"expected a file {PROFITS} (with {RESULTS} and {RECORD} beside it)")
    return path.parent


def read_baseline(path: Path, config: Config) -> Sweep:
    """The baseline at ``path``, which must be one of this configuration.

    Raises ConfigError, one line, if there is none, if it is damaged, or what differs.
    """
    folder = baseline_folder(path)
    try:
        baseline = read_sweep(folder)
        problem = _other_settings(baseline.record["config"], config)
    except FileNotFoundError as error:
        missing = Path(error.filename).name if folder.is_dir() else "such folder"
        raise _wrong(path, f"there is no {missing}: {UPDATE}") from None
    except (OSError, ValueError, KeyError, TypeError, csv.Error, ConfigError) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise _wrong(path, f"it is no baseline ({reason}): {UPDATE}") from None
    standing = recorded_standing(baseline.record)
    if standing is not None and not standing.is_whole:
        call = last_call(folder) or "the call that made it"
        raise _wrong(path, f"it is unfinished ({standing.counts}; to go on: {call}): {UPDATE}")
    if problem:
        raise _wrong(path, f"it is of other settings ({problem}): {UPDATE}")
    return baseline


def _wrong(path: Path, problem: str) -> ConfigError:
    return ConfigError(f"--baseline: value {str(path)!r}: {problem}")


def read_sweep(folder: Path) -> Sweep:
    """The tables in a folder; raises OSError, ValueError or csv.Error for what is none."""
    record = read_record(folder / RECORD)
    if not isinstance(record.get("config"), dict):
        raise ValueError(f"{RECORD} has no configuration")
    for name, digest in dict(record.get(DIGESTS, {})).items():
        if _digest(folder / name) != digest:
            raise ValueError(f"{name} is not the file that {RECORD} was written with")
    results = read_csv(folder / RESULTS, COLUMNS)
    profits = read_csv(folder / PROFITS, profit_columns())
    return Sweep(results, profits, record)


def _digest(path: Path) -> str:
    """SHA-256 of a text's lines, however they end."""
    return hashlib.sha256(b"\n".join(path.read_bytes().splitlines())).hexdigest()


def _other_settings(recorded: dict[str, Any], config: Config) -> str:
    """What differs between the settings recorded and these; keys not known then had defaults.

    Those of the reading that is recorded: that the default one is another now is no other setting.
    """
    reading = recorded.get(READING, BEFORE_READINGS)
    if default_changed(recorded, config):
        config = with_key(config, READING, reading)
    here = described(config)
    known = {"scene": here["scene"], READING: reading}
    if policies := recorded.get("policy"):
        known["policy"] = [_named(policy) for policy in policies]
    defaults = config_from_mapping(known, folder=config.kept_source.folder)
    before = _merged(described(defaults), recorded)
    return difference(before, _merged(here, here), "in the baseline")


def _named(policy: Mapping[str, Any]) -> dict[str, Any]:
    """A policy by its name; one of one's own, whose file isn't here, by its label alone."""
    if FILE in policy:
        return {"label": policy.get("label", policy["name"])}
    return {key: policy[key] for key in ("name", "label") if key in policy}


def default_changed(recorded: Mapping[str, Any], config: Config) -> bool:
    """Does a configuration leave the reading to a default that was another when it was recorded?"""
    was = recorded.get(READING, BEFORE_READINGS)
    could_be_default = was in reading_names() and READING not in config.kept_source.data
    return could_be_default and was != config.settings.reading


def _merged(defaults: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """What is given, over the defaults, without what changes no integer."""
    merged = {k: v for k, v in {**defaults, **given}.items() if k not in IRRELEVANT_TO_INTEGERS}
    for key in ("picture", "machine", "memory", "placement"):
        if isinstance(given.get(key), dict):
            merged[key] = {**defaults[key], **given[key]}
    policies = zip(defaults["policy"], merged["policy"], strict=True)
    merged["policy"] = [
        policy if FILE in policy else {**by_default, **policy} for by_default, policy in policies
    ]
    return merged


def reasons(config: Config, baseline: Sweep, now: Sweep) -> list[str]:
    """Defaults, machines and workloads that are not what they were: why values may have moved."""
    problems = []
    recorded = baseline.record["config"]
    if default_changed(recorded, config):
        was = recorded.get(READING, BEFORE_READINGS)
        problems.append(
            f"the defaults changed: the baseline is of reading {was}, the default is "
            f"{config.settings.reading} now; `reading: {was}` in the configuration is the old one"
        )
    for old, new in zip(_machines(baseline), _machines(now), strict=False):
        if problem := difference(old, new, "in the baseline"):
            problems.append(f"machine {new.get('name')}, shape {new.get('shape')}: {problem}")
    before, after = (sweep.record.get(WORKLOADS) for sweep in (baseline, now))
    if isinstance(before, dict) and isinstance(after, dict):
        others = [name for name in before if before[name] != after.get(name)]
        problems += [f"{name} was traced by other code, or is another scene" for name in others]
    return problems


def _machines(sweep: Sweep) -> list[dict[str, Any]]:
    """Constants of each machine, without what is said of their sources."""
    machines = sweep.record.get(MACHINES)
    listed = machines if isinstance(machines, list) else []
    return [
        {key: _by_place(value) for key, value in machine.items() if key != "sources"}
        for machine in listed
        if isinstance(machine, dict)
    ]


def _by_place(value: Any) -> Any:
    """A list of mappings as a mapping, so that only what differs in it is told."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return {str(n): part for n, part in enumerate(value)}
    return value


def write_baseline(obtained: Path, folder: Path) -> None:
    """Make the tables of a sweep's folder the baseline; each file is replaced in one step.

    ``run.json`` comes last: until then its digests do not fit, and the baseline is refused.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name in (RESULTS, PROFITS):
        copy(obtained / name, folder / name)
    record = read_record(obtained / RECORD)
    record[DIGESTS] = {name: _digest(obtained / name) for name in (PROFITS, RESULTS)}
    write_record(record, folder / RECORD)
