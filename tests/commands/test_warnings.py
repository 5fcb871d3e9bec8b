"""What users are warned of: one line each, once, on the error output; results stay the same."""

from __future__ import annotations

from pathlib import Path

import pytest
from calls import begin_in, simmpp

CONFIG = "{scene: tetra:2, picture: {resolution: 12}, processors: 4, memory: {fraction: 0.5}}"
RING = (
    "simmpp: warning: 13 PEs are a torus of 13 x 1 x 1, so messages cross up to 6 links; "
    "12 (3 x 2 x 2) is rounder"
)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)


def warnings(*call: str) -> list[str]:
    done = simmpp(*call)
    assert done.exit_code == 0, done.output
    assert "warning" not in done.stdout
    return [line for line in done.stderr.splitlines() if "warning: " in line]


def test_nothing_to_warn_of() -> None:
    assert warnings("run", "c.yaml") == []
    assert warnings("sweep", "c.yaml", "--workers", "1") == []


def test_a_run_and_a_sweep_warn_once() -> None:
    assert warnings("run", "c.yaml", "--processors", "13") == [RING]
    sweep = ("sweep", "c.yaml", "--workers", "1", "--processors", "4,13", "--fraction", "0.5,1")
    assert warnings(*sweep) == [RING]


def test_a_number_that_its_policy_ignores() -> None:
    policy = "policy={name: object, min_load: 5%}"
    (line,) = warnings("run", "c.yaml", "--set", policy)
    assert line == "simmpp: warning: --set policy: object ignores min_load"


def test_a_window_in_which_nothing_happens() -> None:
    timeline = ("--timeline", "t.json", "--timeline-window")
    assert warnings("run", "c.yaml", *timeline, "0 ms:5 ms") == []
    (line,) = warnings("run", "c.yaml", *timeline, "9 s:")
    assert line.startswith("simmpp: warning: --timeline-window: nothing happens from 9 s on: obj")
    assert line.endswith(" ended")
