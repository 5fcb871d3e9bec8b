"""``run.json`` has one format, whoever writes it, and what is committed can be read."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from simmpp.config.config import config_from_mapping
from simmpp.report.page.folder import read_folder
from simmpp.report.page.origin import origin
from simmpp.run.inputs import workload_of
from simmpp.run.point import make_point, run_point
from simmpp.run.record import read_record, record_of_run, write_record
from simmpp.run.rows import RECORD
from simmpp.sweeps.sweep import run_sweep

EXPERIMENTS = Path(__file__).parents[3] / "experiments"
SETTINGS = {"scene": "tetra:1", "picture": {"resolution": 4}, "processors": 2, "policy": "ray"}


def test_a_run_and_a_sweep_say_the_same_of_what_they_are_of(tmp_path: Path) -> None:
    config = config_from_mapping(SETTINGS)
    point = make_point(config, workload_of(config))
    write_record(record_of_run(point, list(run_point(point))), tmp_path / "of_a_run.json")
    run_sweep(config, out=tmp_path)
    run, sweep = read_record(tmp_path / "of_a_run.json"), read_record(tmp_path / RECORD)
    for key in ("versions", "config", "workloads", "machines"):
        assert run[key] == sweep[key]
    assert (run["points"], sweep["points"]) == (3, 2)  # a sweep adds no ceiling
    assert "mapbox-earcut" in run["versions"] and "simmpp source" in run["versions"]


@pytest.mark.parametrize("name", ["baselines/ci", "nebel98/mixed"])
def test_what_is_committed_is_read(name: str) -> None:
    folder = read_folder(EXPERIMENTS / name)
    facts = dict(origin(folder))
    assert facts["versions"].startswith("python 3")
    several = name == "nebel98/mixed"  # a configuration for each table
    assert ("machine" in facts) == (not several)
    assert json.dumps(folder.record)
