"""``simmpp machine``: one's own machines, those of configurations, and fits."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest
from calls import refused, simmpp

from simmpp.machine.presets import OVERRIDDEN, load_own

OURS = """\
description: Our nodes
based_on: t3d
constants:
  send_startup: 0.2 us
  receive_startup: {value: 0.3 us, source: "our log book, 2026"}
  levels:
    node: {size: 2, latency: 0.5 us, bandwidth: 100 GB/s}
    system: {latency: 1.5 us, bandwidth: 100 Gb/s}
"""
CONFIG = (
    "{scene: tetra:2, picture: {resolution: 12}, processors: 4, policy: [object, ray],"
    " reading: plain, machine: {file: ours.yaml, quantum: 32, levels: {system: {latency: 2 us}}}}"
)


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One's own machine and a configuration of it."""
    monkeypatch.chdir(tmp_path)
    Path("ours.yaml").write_text(OURS)
    Path("c.yaml").write_text(CONFIG)


def printed(*arguments: str) -> dict[str, tuple[str, str]]:
    """Value, and source or range, by constant."""
    done = simmpp("machine", *arguments)
    assert done.exit_code == 0, done.stderr
    lines = (re.split(r" {2,}", line.strip()) for line in done.stdout.splitlines())
    rows = [cells for cells in lines if len(cells) >= 3]
    return {row[0].strip(): (row[1].strip(), row[2].strip()) for row in rows}


def test_a_file_is_printed_with_what_its_preset_says() -> None:
    lines = printed("ours.yaml")
    assert lines["send_startup"] == ("200 ns", OVERRIDDEN)
    assert lines["receive_startup"] == ("300 ns", "our log book, 2026")
    assert lines["levels.system.bandwidth"] == ("12.5 GB/s", OVERRIDDEN)
    assert lines["ray_bytes"] == ("128 B", "64 B to 184 B")
    assert lines["topology"][0] == "levels"


def test_ones_own_constants_have_ranges_with_a_source_or_without() -> None:
    ours = OURS.replace("0.2 us", "{value: 0.2 us, range: [0.1 us, 400 ns]}")
    source = 'range: [0.3 us, 0.3 us], source: "our'
    Path("ours.yaml").write_text(ours.replace('source: "our', source))
    lines = printed("ours.yaml")
    assert lines["send_startup"] == ("200 ns", "100 ns to 400 ns")
    assert lines["receive_startup"] == ("300 ns", "our log book, 2026")  # one value is no range
    assert load_own("ours.yaml").known["send_startup"][:3] == (200_000, 100_000, 400_000)


def test_a_configuration_is_printed_with_what_it_sets() -> None:
    lines = printed("c.yaml")
    assert lines["quantum"] == ("32", OVERRIDDEN)
    assert lines["levels.system.latency"] == ("2 us", OVERRIDDEN)
    assert lines["receive_startup"] == ("300 ns", "our log book, 2026")


def test_runs_and_sweeps_have_that_machine() -> None:
    done = simmpp("run", "c.yaml", "--out", "o")
    assert done.exit_code == 0, done.stderr
    assert "ours: 4 PEs (node of 2, system of 2)" in done.stdout
    (machine,) = json.loads(Path("o/run.json").read_text())["machines"]
    assert machine["name"] == "ours" and machine["send_startup_ps"] == 200_000
    assert [level["latency_ps"] for level in machine["levels"]] == [500_000, 2_000_000]
    assert machine["sources"]["receive_startup"] == "our log book, 2026"
    Path("theirs.yaml").write_text(OURS.replace("1.5 us", "15 us") + "  price: 3.5/h\n")
    text = CONFIG.replace("levels: {system: {latency: 2 us}}", "latency: 1 us")
    Path("s.yaml").write_text(text[:-1] + ", sweep: {machine.file: [ours.yaml, theirs.yaml]}}")
    done = simmpp("sweep", "s.yaml", "--out", "s", "--workers", "1")
    assert done.exit_code == 0, done.stderr
    rows = list(csv.DictReader(Path("s/results.csv").read_text().splitlines()))
    assert {row["machine.file"] for row in rows} == {"ours.yaml", "theirs.yaml"}
    asked = {row["makespan_ps"] for row in rows if row["policy"] == "object"}
    assert len(asked) == 2
    assert "Of 2 machines ours.yaml finishes first: " in done.stdout
    record = json.loads(Path("s/run.json").read_text())
    assert [of["price_micros"] for of in record["machines"]] == [0, 3_500_000]
    assert [of["at"]["machine.file"] for of in record["machine_of"]] == ["ours.yaml", "theirs.yaml"]


def test_what_makes_pes_unlike_others_is_printed() -> None:
    unlike = "speed: {50%: 2}, noise: 5%, straggler: {pe: 3, factor: 3, from: 1 s}"
    Path("c.yaml").write_text(CONFIG.replace("quantum: 32", f"quantum: 32, {unlike}"))
    lines = printed("c.yaml")
    assert lines["speed"] == ("50%: 2", OVERRIDDEN)
    assert lines["noise"] == ("0.05", OVERRIDDEN)
    assert lines["straggler"] == ("PE 3, 3 times, 1 s to 4000000 s", OVERRIDDEN)
    assert lines["compute_startup"][0] == "0 ps" and lines["least_tests"][0] == "0"
    own = OURS + '  speed: {value: {0: 2}, source: "our log book"}\n  noise: 3%\n'
    Path("ours.yaml").write_text(own)
    lines = printed("ours.yaml")
    assert (lines["speed"], lines["noise"]) == (("0: 2", "our log book"), ("0.03", OVERRIDDEN))


MISTAKES = [
    (OURS.replace("t3d", "cm5"), "ours.yaml:2: based_on: value 'cm5': expected bluegene-l"),
    (OURS.replace("0.2 us", "2"), "ours.yaml:4: send_startup: value 2: expected a time"),
    (OURS.replace("send_startup", "sned_startup"), "ours.yaml:4: unknown key 'sned_startup'"),
    (
        "{description: x, constants: {}}",
        "ours.yaml: expected the keys description, based_on, const",
    ),
    (
        OURS.replace("size: 2", "size: {value: 2, range: 4}"),
        "ours.yaml:7: levels.node.size.range: ",
    ),
    (
        OURS.replace("0.2 us", "{value: 0.2 us, range: [1 us, 3 us]}"),
        "ours.yaml:4: send_startup: value 0.2 us: expected in its range, 1 us to 3 us",
    ),
    (
        OURS.replace("0.2 us", "{value: 0.2 us, range: [0, 3]}"),
        "ours.yaml:4: send_startup: value 3: expected a time",
    ),
    (OURS.replace("size: 2", "sise: 2"), "ours.yaml:7: levels.node: unknown key 'sise'"),
]


@pytest.mark.parametrize(("text", "line"), MISTAKES)
@pytest.mark.parametrize("call", [("run", "c.yaml"), ("machine", "c.yaml")])
def test_mistakes_in_the_file_are_one_line(call: tuple[str, str], text: str, line: str) -> None:
    Path("ours.yaml").write_text(text)
    assert refused(*call).startswith(line)


CALLS = [
    (
        "run c.yaml --set machine.file=no.yaml",
        "--set machine.file: value 'no.yaml': expected a file",
    ),
    ("run c.yaml --set machine.preset=t3e", "c.yaml:1: machine: file says itself what it is based"),
    ("machine fit", "expected a table: simmpp machine fit pingpong.csv"),
    ("machine fit no.csv", "no.csv: No such file"),
    ("machine fit t.csv --out x.csv", "--out: value 'x.csv': expected a file .yaml"),
    ("machine fit t.csv --based-on cm5", "value 'cm5': expected a preset"),
    ("machine t3e t.csv", "TABLE: expected with fit alone"),
    ("machine --out x.yaml", "--out: expected with fit alone"),
]


@pytest.mark.parametrize(("call", "line"), CALLS)
def test_mistakes_in_the_call_are_one_line(call: str, line: str) -> None:
    assert line in refused(*call.split())


def test_fit_prints_and_writes_a_machine_that_runs() -> None:
    sizes = [2**k for k in range(20)]
    rows = "".join(f"{n},{1.5 + n / 12500:.5f},{1e6 / max(0.2, n / 12500):.1f}\n" for n in sizes)
    Path("t.csv").write_text("bytes,one_way_us,messages_per_s\n" + rows)
    done = simmpp("machine", "fit", "t.csv", "--out", "ours.yaml", "--based-on", "t3d")
    assert done.exit_code == 0, done.stderr
    for text in ("1.5 us", "12.5 GB/s", "200 ns", "95 % confidence", "ESTIMATE", "wrote ours.yaml"):
        assert text in done.stdout, done.stdout
    assert (
        "ours: 4 PEs (network of 4)"
        in simmpp("run", "c.yaml", "--set", "machine.levels={network: {}}").stdout
    )


def test_a_machine_of_ones_own_on_another_network() -> None:
    """The file is of a torus; a configuration may put its nodes on levels all the same."""
    constants = "constants:\n  hop_latency: {value: 70 ns, source: measured}\n"
    Path("own.yaml").write_text(f"description: o\nbased_on: t3e\n{constants}")
    levels = "levels: {node: {size: 4, ports: 1}, system: {ports: 1}}"
    Path("c.yaml").write_text(
        f"scene: tetra:3\nprocessors: 8\nmachine: {{file: own.yaml, {levels}}}\n"
    )
    done = simmpp("machine", "c.yaml")
    assert done.exit_code == 0, done.stderr
    assert "levels.node.size" in done.stdout
