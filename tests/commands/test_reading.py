"""What a user is told of readings: by ``simmpp reading``, and by run and sweep of what was set."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp

from simmpp.commands.reading import print_readings_of_sweep
from simmpp.config.config import load_config
from simmpp.config.reading import load_reading, reading_names
from simmpp.machine.presets import OVERRIDDEN

CONFIG = """
scene: tetra:2
picture: {resolution: 12}
processors: 4
reading: mixed
"""
SHORT = """
description: tiles
placement: {pixels: {value: tiles, source: "drawn by lot"}}
machine: {t3d: {ray: {value: 1 us, source: "a guess"}}}
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    monkeypatch.setenv("COLUMNS", "300")
    Path("c.yaml").write_text(CONFIG)
    Path("short.yaml").write_text(SHORT)


def block(stdout: str, reading: str) -> list[list[str]]:
    """What is printed as set by a reading: key, value, source of each line."""
    lines = iter(stdout.splitlines())
    next(line for line in lines if line.startswith(f"reading {reading} sets "))
    cells = []
    for line in lines:
        if not line.strip() or line.startswith("reading "):
            break
        if line.startswith(" "):  # of a source that takes two
            cells[-1][-1] += f" {line.strip()}"
            continue
        key, value, source = line.split(None, 2)
        cells.append([key, value, source.strip()])
    return cells


def lines_of(name: str) -> list[str]:
    return [line.key for line in load_reading(name).lines]


@pytest.mark.parametrize("name", reading_names())
def test_all_that_a_reading_sets_can_be_looked_at(name: str) -> None:
    done = simmpp("reading", name)
    assert done.exit_code == 0
    words = " ".join(done.stdout.split())
    reading = load_reading(name)
    assert words.startswith(f"{name}: {reading.description}")
    for line in reading.lines:
        assert f"{line.key} {line.value} {line.source}" in words
    listed = " ".join(simmpp("reading").stdout.split())
    assert f"{name} {reading.description}" in listed


def test_one_s_own_reading_can_be_looked_at() -> None:
    done = simmpp("reading", "short.yaml")
    assert "machine.t3d.ray   1 us   a guess" in done.stdout
    assert refused("reading", "shirt.yaml").startswith("value 'shirt.yaml': expected mixed or pl")


def test_values_are_printed_as_yaml_has_them() -> None:
    Path("own.yaml").write_text(
        "description: own\nbased_on: plain\n"
        'placement: {pixels: {value: {cells: 8}, source: "ours"}}\n'
        'policy: {object: {merge_requests: {value: false, source: "ours"}}}\n'
    )
    lines = [line.split("  ") for line in simmpp("reading", "own.yaml").stdout.splitlines()]
    values = {cells[0]: next(filter(None, cells[1:])).strip() for cells in lines if cells[1:]}
    assert values["placement.pixels"] == "{cells: 8}"
    assert values["policy.object.merge_requests"] == "false"


def test_run_says_what_the_reading_set_and_what_it_did_not() -> None:
    done = simmpp("run", "c.yaml", "--out", "r")
    assert done.exit_code == 0
    assert [line[0] for line in block(done.stdout, "mixed")] == lines_of("mixed")
    record = json.loads(Path("r/run.json").read_text())
    assert record["config"]["reading"] == "mixed"
    sources = record["machines"][0]["sources"]
    assert sources["quantum"].startswith("ESTIMATE: Nebel 1998")
    with open("r/results.csv", newline="") as file:
        assert "reading" not in next(csv.reader(file))

    sets = ("--set", "machine.quantum=8", "--set", "placement.pixels=tiles")
    done = simmpp("run", "c.yaml", "--out", "s", *sets)
    left = [key for key in lines_of("mixed") if key.split(".")[-1] not in ("quantum", "pixels")]
    assert [line[0] for line in block(done.stdout, "mixed")] == left
    sources = json.loads(Path("s/run.json").read_text())["machines"][0]["sources"]
    assert sources["quantum"] == OVERRIDDEN


def test_run_says_that_costs_are_for_another_preset() -> None:
    done = simmpp("run", "c.yaml", "--set", "reading=short.yaml")
    assert block(done.stdout, "short.yaml") == [["placement.pixels", "tiles", "drawn by lot"]]
    assert done.stdout.endswith("reading short.yaml has costs for t3d, none for t3e: not set\n")
    other = simmpp("run", "c.yaml", "--set", "machine.preset=t3d").stdout
    assert "reading mixed has costs for t3e, none for t3d: not set" in other
    assert "machine.t3e" not in other


def test_a_sweep_of_machines_says_whose_costs_the_reading_has(
    capsys: pytest.CaptureFixture[str],
) -> None:
    sweep = "sweep: {machine.preset: [gpu-node, t3e, t3d], processors: [2, 4]}\n"
    Path("c.yaml").write_text(CONFIG + sweep)
    print_readings_of_sweep(load_config(Path("c.yaml")))
    told = capsys.readouterr().out
    assert [line[0] for line in block(told, "mixed")] == lines_of("mixed")  # the T3E's as well
    assert told.endswith("reading mixed has costs for t3e, none for gpu-node, t3d: not set\n")


def test_a_sweep_of_readings_says_what_each_set() -> None:
    Path("c.yaml").write_text(
        CONFIG + "sweep: {reading: [plain, short.yaml], machine.quantum: [8, 9]}\n"
    )
    done = simmpp("sweep", "c.yaml", "--workers", "1", "--out", "s")
    assert done.exit_code == 0
    assert [line[0] for line in block(done.stdout, "plain")] == lines_of("plain")
    assert block(done.stdout, "short.yaml") == [["placement.pixels", "tiles", "drawn by lot"]]
    with open("s/results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["reading"] for row in rows} == {"plain", "short.yaml"}
    makespans = {
        (row["reading"], row["policy"], row["machine.quantum"]): row["makespan_ps"] for row in rows
    }
    assert len(makespans) == 2 * 2 * 2
    sets = ("--set", "reading=plain", "--set", "machine.quantum=9")
    assert simmpp("run", "c.yaml", *sets, "--out", "r").exit_code == 0
    with open("r/results.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["policy"] != "replicated":
                assert row["makespan_ps"] == makespans["plain", row["policy"], "9"]


def test_plain_gives_what_is_given_without_a_reading_in_the_code() -> None:
    """Every key that ``plain`` sets, said by the configuration itself, gives the same rows."""
    said = """
placement: {pixels: blocks}
memory: {transient: 0}
policy: [{name: object, packing: none}, {name: concurrent, packing: none, ask_at_least: 32}]
machine: {test: 4 us, ray: 6 us, quantum: 64, send_startup: 10 us, receive_startup: 20 us}
"""
    Path("said.yaml").write_text(CONFIG + said)
    named = "policy: [object, concurrent]\n"
    Path("plain.yaml").write_text(CONFIG.replace("mixed", "plain") + named)
    for name in ("said", "plain"):
        assert simmpp("run", f"{name}.yaml", "--out", name).exit_code == 0
    assert Path("said/results.csv").read_bytes() == Path("plain/results.csv").read_bytes()
