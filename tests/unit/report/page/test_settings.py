"""What a page says of the settings: units, and nothing that made no difference."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from simmpp.config.config import described, load_config
from simmpp.policy.parameters import POLICIES
from simmpp.policy.reads import settings_used
from simmpp.report.page.settings import settings_of

SCENE = "scene: {spd: mountain, size: 3}\n"


def told(folder: Path, text: str) -> list[tuple[str, str]]:
    path = folder / "config.yaml"
    path.write_text(SCENE + text)
    return list(settings_of({"config": json.loads(json.dumps(described(load_config(path))))}))


def test_numbers_have_units(tmp_path: Path) -> None:
    text = "processors: 8\nmemory: {fraction: 12.5%}\nmachine: {send_startup: 5 us, quantum: 7}\n"
    found = dict(told(tmp_path, f"{text}picture: {{resolution: 32}}\ntolerance: 2%\n"))
    assert found["scene"] == "mountain:3"
    assert found["processors"] == "8 PEs"
    assert found["memory"] == "fraction 12.5 %, residents random, transient x"
    assert found["machine"] == "send_startup 5 us, quantum 7 tests, preset t3e"
    assert found["picture"].startswith("resolution 32 pixels, ")
    assert found["tolerance"] == "2 %"
    assert found["max_seeds"] == "64 seeds"


def test_what_is_not_used_is_left_out(tmp_path: Path) -> None:
    found = dict(told(tmp_path, "sweep: {processors: [2, 4], memory.fraction: [0.1, 1]}\n"))
    assert found["machine"] == "preset t3e"
    assert found["memory"] == "residents random, transient x"
    assert not {"processors", "max_seeds", "refine", "seeds", "sweep"} & found.keys()


def test_policies_have_the_settings_that_they_read(tmp_path: Path) -> None:
    entries = "[object, ray, {name: concurrent, label: a, load_info: {refresh: 5 ms}}, replicated]"
    found = [text for name, text in told(tmp_path, f"policy: {entries}\n") if name == "policy"]
    assert found == [
        "object dataflow: merge_requests true, packing none",
        "ray dataflow: batch 256 rays",
        "a (concurrent dataflow): min_load 12 %, batch 256 rays, ask_at_least 64 rays, load_info "
        "refresh: 5 ms, merge_requests true, packing all",
        "replicated scene",
    ]


def test_swept_policies_are_as_they_were_written(tmp_path: Path) -> None:
    swept = "sweep: {policy: [object, {name: ray, label: small, batch: 8}]}\n"
    found = [text for name, text in told(tmp_path, swept) if name == "policy"]
    assert found == ["object dataflow", "small (ray dataflow): batch 8 rays"]


@pytest.mark.parametrize(
    ("name", "used"),
    [
        ("object", ("merge_requests", "packing")),
        ("ray", ("batch",)),
        (
            "concurrent",
            ("min_load", "batch", "ask_at_least", "load_info", "merge_requests", "packing"),
        ),
        ("replicated", ()),
    ],
)
def test_which_settings_a_policy_reads(name: str, used: tuple[str, ...]) -> None:
    assert settings_used(POLICIES[name]) == used


@pytest.mark.parametrize(
    "record", [{}, {"config": []}, {"config": {"sweep": []}}, {"config": {"policy": [3, None]}}]
)
def test_any_record_is_told(record: dict[str, Any]) -> None:
    assert all(isinstance(text, str) for _, text in settings_of(record))
