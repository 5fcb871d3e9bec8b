"""Text to exact integers: what is read, what is refused, and that no float is in between."""

import re
from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common import units
from simmpp.common.errors import ConfigError


@pytest.mark.parametrize(
    ("text", "expected_ps"),
    [
        ("12 us", 12_000_000),
        ("0.5us", 500_000),
        ("13.33 ns", 13_330),
        ("1e-6 s", 1_000_000),
        ("5 µs", 5_000_000),
        ("0.1 min", 6 * 10**12),
        ("0.5 ps", 1),
        ("0.4 ps", 0),
        (0, 0),
        ("0 s", 0),
        ("10 s", 10**13),
    ],
)
def test_times(text: object, expected_ps: int) -> None:
    assert units.picoseconds(text) == expected_ps


@pytest.mark.parametrize(
    ("text", "expected_bytes"), [("64 MB", 64_000_000), ("1 KiB", 1024), ("1.5 kB", 1500), (0, 0)]
)
def test_sizes(text: object, expected_bytes: int) -> None:
    assert units.byte_count(text) == expected_bytes


def test_bandwidths() -> None:
    assert units.bytes_per_second("340 MB/s") == 340_000_000
    assert units.bytes_per_second("3 B/us") == 3_000_000
    assert units.bytes_per_second("unlimited") == units.UNLIMITED


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("10 Gbit/s", 1_250_000_000),
        ("10Gb/s", 1_250_000_000),
        ("10 GB/s", 10_000_000_000),
        ("8 kbit/s", 1000),
        ("1 Gibit/s", 2**27),
        ("1 bit/us", 125_000),
        ("100003 b/s", 12_500),  # 12500.375
        ("100004 b/s", 12_501),  # halves go up
    ],
)
def test_bits_are_eighths_of_bytes(text: str, expected: int) -> None:
    assert units.bytes_per_second(text) == expected


@given(number=st.integers(1, 10**6), prefix=st.sampled_from(["k", "M", "G", "Ki", "Mi", "Gi"]))
def test_a_bandwidth_in_bits_is_that_in_bytes_eight_times(number: int, prefix: str) -> None:
    as_bytes = units.bytes_per_second(f"{number} {prefix}B/s")
    for bit in ("bit", "b"):
        assert units.bytes_per_second(f"{8 * number} {prefix}{bit}/s") == as_bytes


@pytest.mark.parametrize("text", ["7 kbit/s", "0 Mbit/s", "10 Gbit", "10 bit s", "1e30 Gbit/s"])
def test_wrong_rates_of_bits(text: str) -> None:
    with pytest.raises(
        ConfigError, match=r"expected a bandwidth such as '340 MB/s' or '10 Gbit/s'"
    ):
        units.bytes_per_second(text)


@pytest.mark.parametrize("text", ["64 Mbit", "64 Mb", "8 b", "1 bit"])
def test_a_size_has_no_bits(text: str) -> None:
    with pytest.raises(ConfigError, match="expected a size such as '64 MB'"):
        units.byte_count(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("12%", Fraction(12, 100)),
        (0.1, Fraction(1, 10)),
        (1e-6, Fraction(1, 10**6)),
        ("1/64", Fraction(1, 64)),
        (0, Fraction(0)),
        (1, Fraction(1)),
        (Fraction(1, 3), Fraction(1, 3)),
    ],
)
def test_shares_are_exact(text: object, expected: Fraction) -> None:
    assert units.share(text) == expected


WRONG_TIMES = [
    12,
    0.5,
    True,
    None,
    "",
    "12",
    "-1 us",
    "nan s",
    "inf s",
    "1e99 s",
    "11 s",
    "5 MB",
    "1 s/s",
    "2 * 3 s",
    "9**9 s",
    "12 Us",
    "us",
    "1 light_year",
    ["1 us"],
    "1 us us",
    "1 d",
]


@pytest.mark.parametrize("value", WRONG_TIMES)
def test_wrong_times_say_what_was_expected(value: object) -> None:
    with pytest.raises(ConfigError, match=r"expected a time such as '12 us'"):
        units.picoseconds(value)


def test_powers_and_prices() -> None:
    assert units.milliwatts("1.275 kW") == 1_275_000
    assert units.milliwatts(0) == 0
    assert units.price_micros("4.916/h") == units.price_micros(" 4.916 / h") == 4_916_000
    assert units.price_micros("0/h") == 0
    for power in (1, 628_000, 1_275_000, 10**12):
        assert units.milliwatts(units.write_mw(power)) == power
    for price in (0, 1, 127_500, 5_000_000, 10**15):
        assert units.price_micros(units.write_price(price)) == price
    assert units.write_price(5_000_000) == "5/h"


@pytest.mark.parametrize("value", [3, "3", "-3/h", "3 W", "3 $/h", "9" * 16 + "/h", None])
def test_wrong_prices(value: object) -> None:
    with pytest.raises(ConfigError, match=r"expected a price of an hour such as '4\.92/h'"):
        units.price_micros(value)


@pytest.mark.parametrize("value", [3, "3", "-3 W", "3 Wh", "2000 MW", None])
def test_wrong_powers(value: object) -> None:
    with pytest.raises(ConfigError, match="expected a power such as '630 W'"):
        units.milliwatts(value)


@pytest.mark.parametrize("value", [0, "0 MB/s", "999 B/s", "fast", "-1 B/s", "5 MB", "8 mb/s"])
def test_wrong_bandwidths(value: object) -> None:
    with pytest.raises(ConfigError, match="expected a bandwidth"):
        units.bytes_per_second(value)


@pytest.mark.parametrize("value", ["1.5 B", "64", 64, "1 s", "-1 B", "1e30 B"])
def test_wrong_sizes(value: object) -> None:
    with pytest.raises(ConfigError, match="expected"):
        units.byte_count(value)


@pytest.mark.parametrize("value", [1.1, -0.1, "101%", "1/0", "x", True, None, float("nan"), "3/2"])
def test_wrong_shares(value: object) -> None:
    with pytest.raises(ConfigError, match="expected a share from 0 to 1"):
        units.share(value)


@pytest.mark.parametrize(
    ("parse", "value", "most"),
    [
        (units.picoseconds, "11 s", "10 s"),
        (units.byte_count, "1e30 B", "100000 TB"),
        (units.bytes_per_second, "1e30 B/s", "9000 TB/s"),
    ],
)
def test_bounds_are_quantities_too(parse: Callable[[object], int], value: str, most: str) -> None:
    with pytest.raises(ConfigError, match=rf", at most {re.escape(most)}$"):
        parse(value)


@given(number=st.integers(0, 10**13))
def test_text_for_files_is_exact(number: int) -> None:
    assert units.picoseconds(units.write_ps(number)) == number
    assert units.byte_count(units.write_bytes(number)) == number
    if number == units.UNLIMITED or number >= units.LEAST_BYTES_PER_S:
        assert units.bytes_per_second(units.write_bytes_per_s(number)) == number


def test_text_for_people() -> None:
    assert units.counted(1, "mesh") == "1 mesh"
    assert units.counted(2, "mesh") == "2 meshes"
    assert units.counted(0, "PE") == "0 PEs"
    assert units.format_ps(12_000_000) == "12 us"
    assert units.format_ps(0) == "0 s"
    assert units.format_bytes(64_000_000) == "64 MB"
    assert units.format_bytes_per_s(340_000_000) == "340 MB/s"
    assert units.format_bytes_per_s(units.UNLIMITED) == "unlimited"


@given(st.integers(1, 999_999), st.sampled_from(["ps", "ns", "us"]))
def test_what_is_printed_is_read_back(number: int, unit: str) -> None:
    time_ps = units.picoseconds(f"{number} {unit}")
    assert units.picoseconds(units.format_ps(time_ps)) == time_ps


@given(st.decimals("0", "10", places=12, allow_nan=False))
def test_no_picosecond_is_lost(seconds: object) -> None:
    text = f"{seconds:f}"
    assert units.picoseconds(f"{text} s") == int(Fraction(text) * 10**12)


@given(st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    for parse in (units.picoseconds, units.byte_count, units.bytes_per_second, units.share):
        try:
            assert parse(text) >= 0
        except ConfigError as error:
            assert len(str(error).splitlines()) == 1
