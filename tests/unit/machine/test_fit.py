"""Constants from ping-pongs: known ones come back within their errors, nonsense is refused."""

from __future__ import annotations

import re
from math import inf
from pathlib import Path

import numpy as np
import pytest

from simmpp.common.errors import ConfigError
from simmpp.machine.fit import Fit, Fitted, fit, read_table
from simmpp.machine.fitted_file import text_of
from simmpp.machine.presets import load_own, machine

START_S, BYTES_PER_S, GAP_S = 1.9e-6, 12.5e9, 0.25e-6
SIZES = [0, *(2**k for k in range(3, 23))]


def measured(seed: int, noise: float = 0.05, rates: bool = True, rows: int = len(SIZES)) -> str:
    """A table of a machine whose constants are known; errors multiply the times."""
    rng = np.random.default_rng(seed)
    lines = ["bytes,one_way_us" + (",messages_per_s" if rates else "")]
    for n_bytes in SIZES[:rows]:
        one_way_s = (START_S + n_bytes / BYTES_PER_S) * rng.lognormal(0, noise)
        interval_s = max(GAP_S, n_bytes / BYTES_PER_S) * rng.lognormal(0, noise)
        rate = f",{1 / interval_s:.6g}" if rates else ""
        lines.append(f"{n_bytes},{one_way_s * 1e6:.6g}{rate}")
    return "\n".join(lines) + "\n"


def fitted(text: str) -> Fit:
    return fit(read_table(text, "t.csv"), "t.csv")


def holds(found: Fitted | None, known: float) -> bool:
    return found is not None and found.low <= known <= found.high


def test_known_constants_lie_within_their_errors_as_often_as_these_say() -> None:
    fits = [fitted(measured(seed)) for seed in range(200)]
    inside = {
        "start": sum(holds(found.start_s, START_S) for found in fits),
        "bandwidth": sum(holds(found.bandwidth, BYTES_PER_S) for found in fits),
        "gap": sum(holds(found.gap_s, GAP_S) for found in fits),
    }
    # 95 % of 200 is 190; a count of 178 or less has a chance below 1 in 2,000
    assert all(count > 178 for count in inside.values()), inside
    assert min(inside.values()) < 200, inside  # errors that are never exceeded say too little
    widths = [found.start_s.high / found.start_s.low for found in fits]
    assert 1.02 < float(np.mean(widths)) < 1.15


@pytest.mark.parametrize("startup_s", [0.0, 0.1e-6, 0.24e-6])
def test_a_startup_below_the_gap_lies_within_its_range_and_so_does_the_latency(
    startup_s: float,
) -> None:
    found = fitted(measured(1))
    assert holds(found.startup_s, startup_s)
    assert holds(found.latency_s, START_S - 2 * startup_s)


def test_without_noise_the_constants_are_those_that_made_the_table() -> None:
    found = fitted(measured(0, noise=0.0))
    assert found.start_s.value == pytest.approx(START_S, rel=1e-4)
    assert found.bandwidth.value == pytest.approx(BYTES_PER_S, rel=1e-4)
    assert found.gap_s is not None and found.gap_s.value == pytest.approx(GAP_S, rel=1e-4)


def test_without_rates_there_is_no_gap_and_startups_are_a_third() -> None:
    found = fitted(measured(2, rates=False))
    assert found.gap_s is None
    assert found.startup_s.value == pytest.approx(found.start_s.value / 3)
    assert found.startup_s.is_estimate and found.latency_s.is_estimate


def test_units_are_those_of_the_column() -> None:
    in_us = measured(3, rates=False)
    lines = [line.split(",") for line in in_us.splitlines()[1:]]
    in_ns = "bytes,one_way_ns\n" + "".join(f"{a},{float(b) * 1000}\n" for a, b in lines)
    assert fitted(in_ns).start_s.value == pytest.approx(fitted(in_us).start_s.value)


def test_the_file_that_is_written_is_a_machine_with_these_constants(tmp_path: Path) -> None:
    found = fitted(measured(4))
    (tmp_path / "ours.yaml").write_text(text_of(found, "t.csv", "t3e"))
    own = load_own("ours.yaml", tmp_path)
    made = machine(own.based_on, {}, 16, own=own)
    assert (made.name, made.topology, made.processors) == ("ours", "levels", 16)
    (level,) = made.levels
    assert (
        level.latency_ps == made.latency_ps == pytest.approx(found.latency_s.value * 1e12, rel=1e-4)
    )
    assert level.bytes_per_s == pytest.approx(found.bandwidth.value, rel=1e-4)
    assert level.gap_ps == pytest.approx(found.gap_s.value * 1e12, rel=1e-4)  # type: ignore[union-attr]
    one_way_ps = made.send_startup_ps + level.latency_ps + made.receive_startup_ps
    assert one_way_ps == pytest.approx(found.start_s.value * 1e12, rel=1e-4)
    assert made.sources["latency"].startswith("ESTIMATE: ")
    assert made.sources["link_bandwidth"] == "t.csv, 95 % confidence"
    for key, of in {"link_bandwidth": found.bandwidth, "port_gap": found.gap_s}.items():
        known, unit = own.known[key], 1 if key == "link_bandwidth" else 1e12
        expected = [end * unit for end in (of.value, of.low, of.high)]  # type: ignore[union-attr]
        assert [known.value, known.low, known.high] == pytest.approx(expected, rel=1e-3)
    assert own.known["send_startup"].low == 0  # of an ESTIMATE as well
    assert made.header_bytes == 0  # what it costs is in what was measured


def test_any_name_of_a_table_is_text_in_the_file(tmp_path: Path) -> None:
    name = 'run #2: "a".csv'
    (tmp_path / "ours.yaml").write_text(text_of(fitted(measured(4)), name, "t3e"))
    own = load_own("ours.yaml", tmp_path)
    assert own.description == f"Fitted to {name}"
    assert machine(own.based_on, {}, 4, own=own).sources["link_bandwidth"].startswith(name)


HEAD = "bytes,one_way_us\n"
SOUND = "8,1\n64,1.01\n4096,1.4\n1048576,90\n"
MISTAKES = [
    ("", r"t\.csv:1: columns '': expected the columns bytes, one_way_us"),
    ("size,time\n1,2\n", r"t\.csv:1: columns 'size, time'"),
    ("bytes,one_way_us,one_way_ns\n1,2,3\n", r"t\.csv:1: columns"),
    (HEAD + "8,1\n8\n", r"t\.csv:3: 1 cells, expected 2"),
    (HEAD + "8,one\n", r"t\.csv:2: one_way_us: value 'one': expected a number above 0"),
    (HEAD + "8,0\n", r"t\.csv:2: one_way_us: value '0'"),
    (HEAD + "8,nan\n", r"t\.csv:2: one_way_us: value 'nan'"),
    (HEAD + f"8,{inf}\n", r"t\.csv:2: one_way_us: value 'inf'"),
    (HEAD + "-8,1\n", r"t\.csv:2: bytes: value '-8'"),
    (HEAD + "8,1\n16,1\n32,1\n", r"t\.csv: 3 rows: expected 4 or more"),
    (HEAD + "8,1\n" * 9, r"t\.csv: 9 rows: expected 4 or more, of different sizes"),
    (HEAD + "8,9\n64,9\n4096,9\n1048576,9\n", r"t\.csv: large messages take no longer than small"),
    (HEAD + "8,90\n64,30\n4096,10\n1048576,1\n", r"t\.csv: large messages take no longer"),
    (HEAD + "8,1\n64,90\n4096,2\n1048576,50\n", r"t\.csv: (times lie|expected)"),
    (HEAD + "8,1\n64,1.1\n128,1.0\n256,1.3\n", r"t\.csv: expected large messages too"),
    (
        "bytes,one_way_us,messages_per_s\n8,1,10\n64,1.01,\n4096,1.4,\n1048576,90,\n",
        r"t\.csv: messages_per_s at 8 bytes: expected more than a message in each round trip",
    ),
    (
        "bytes,one_way_us,messages_per_s\n8,1,\n64,1.01,\n4096,1.4,\n1048576,90,11000\n",
        r"t\.csv: messages_per_s: expected some of small messages",
    ),
]


@pytest.mark.parametrize(("text", "line"), MISTAKES)
def test_a_table_that_makes_no_sense_is_refused_in_one_line(text: str, line: str) -> None:
    with pytest.raises(ConfigError) as error:
        fitted(text)
    assert re.match(line, str(error.value)) and "\n" not in str(error.value), str(error.value)


def test_the_table_beside_which_these_are_wrong_is_sound() -> None:
    assert fitted(HEAD + SOUND).start_s.value == pytest.approx(1e-6, rel=0.02)
