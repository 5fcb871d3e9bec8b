"""Constants of a network from a ping-pong: latency, startups, gap and bandwidth with their errors.

Half a round trip of B bytes takes T = T0 + B / bandwidth: T0 and the bandwidth are fitted to the
logarithms of the times, whose errors are taken to be alike for messages of all sizes.
Messages sent back to back follow each other at the gap where their bytes take less than that: the
gap is the mean of these intervals. (LogGP: Alexandrov et al. 1995, LogGP: incorporating long
messages into the LogP model, SPAA; T0 is its 2 o + L.)

No table of this kind tells how T0 is split between sender, network and receiver. With a gap each
startup is taken to be the gap, which bounds it (who takes longer over a message can't send that
often), else a third of T0: ESTIMATES with a range, unlike the rest, whose ranges are 95 %
confidence intervals.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown

Floats = NDArray[np.float64]
UNITS_S = {"one_way_s": 1.0, "one_way_ms": 1e-3, "one_way_us": 1e-6, "one_way_ns": 1e-9}
BYTES, RATE = "bytes", "messages_per_s"
COLUMNS = f"expected the columns bytes, one_way_us (or _s, _ms, _ns), and {RATE} if measured"
LEAST_ROWS = 4
WORST_ERROR = 0.5
"""Range of a fitted constant, as a share, beyond which the table does not tell it."""
WORST_SCATTER = 0.3
"""Standard deviation of the times about the fit, as a share, beyond which it is none."""


@dataclass(frozen=True)
class Table:
    """What was measured, a row for each size."""

    n_bytes: Floats
    one_way_s: Floats
    interval_s: Floats
    """Between messages sent back to back; nan where not measured."""


@dataclass(frozen=True)
class Fitted:
    """A constant and where it may lie."""

    value: float
    low: float
    high: float
    is_estimate: bool = False
    """The range is an assumption's, not a confidence interval."""


@dataclass(frozen=True)
class Fit:
    """Seconds, and bytes per second."""

    start_s: Fitted
    """T0."""
    bandwidth: Fitted
    gap_s: Fitted | None
    startup_s: Fitted
    """Of the sender, and of the receiver."""
    latency_s: Fitted
    scatter: float
    """Standard deviation of the times about the fit, as a share."""


def read_table(text: str, where: str) -> Table:
    """A table as CSV.

    Raises ConfigError, one line, for what can't be one: with its line.
    """
    rows = csv.reader(io.StringIO(text))
    names = [name.strip() for name in next(rows, [])]
    times = [name for name in names if name in UNITS_S]
    known = {BYTES, RATE, *times}
    if len(times) != 1 or BYTES not in names or len(set(names)) < len(names) or set(names) - known:
        raise ConfigError(f"columns {shown(', '.join(names))}: {COLUMNS}", where=where, line=1)
    found: dict[str, list[float]] = {name: [] for name in (BYTES, times[0], RATE)}
    for row in rows:
        if any(cell.strip() for cell in row):
            if len(row) != len(names):
                problem = f"{len(row)} cells, expected {len(names)}"
                raise ConfigError(problem, where=where, line=rows.line_num)
            cells = dict(zip(names, row, strict=True))
            for name, numbers in found.items():
                numbers.append(_number(name, cells.get(name, ""), where, rows.line_num))
    n_bytes, one_way, rate = (np.array(numbers) for numbers in found.values())
    return Table(n_bytes, one_way * UNITS_S[times[0]], 1 / rate)


def _number(name: str, cell: str, where: str, line: int) -> float:
    if name == RATE and not cell.strip():
        return float("nan")
    try:
        number = float(cell)
    except ValueError:
        number = -1.0
    if not (number > 0 or (name == BYTES and number == 0)) or number == float("inf"):
        problem = f"{name}: value {shown(cell)}: expected a number above 0"
        raise ConfigError(problem, where=where, line=line)
    return number


def fit(table: Table, where: str) -> Fit:
    """The constants that a table tells.

    Raises ConfigError, one line, for a table that makes no sense or does not tell enough.
    """
    if len(table.n_bytes) < LEAST_ROWS or len(set(table.n_bytes.tolist())) < LEAST_ROWS - 1:
        problem = f"{len(table.n_bytes)} rows: expected {LEAST_ROWS} or more, of different sizes"
        raise ConfigError(problem, where=where)
    start_s, bandwidth, scatter = _line(table, where)
    gap_s = _gap(table, bandwidth.value, scatter, where)
    third = Fitted(start_s.value / 3, 0.0, start_s.high / 2, is_estimate=True)
    startup_s = third
    if gap_s is not None:
        most = min(gap_s.high, start_s.high / 2)
        startup_s = Fitted(min(gap_s.value, start_s.value / 2), 0.0, most, is_estimate=True)
    latency_s = Fitted(
        start_s.value - 2 * startup_s.value,
        max(0.0, start_s.low - 2 * startup_s.high),
        start_s.high,
        is_estimate=True,
    )
    return Fit(start_s, bandwidth, gap_s, startup_s, latency_s, scatter)


def _line(table: Table, where: str) -> tuple[Fitted, Fitted, float]:
    """T0, the bandwidth, and how far the times scatter about them."""
    from scipy.optimize import curve_fit  # takes a quarter of a second
    from scipy.stats import t as student

    n_bytes, log_s = table.n_bytes, np.log(table.one_way_s)
    widest = int(np.argmax(n_bytes))
    if table.one_way_s[widest] <= 1.2 * table.one_way_s.min():
        raise ConfigError("large messages take no longer than small ones", where=where)

    def logarithm(sizes: Floats, log_start: float, log_rate: float) -> Floats:
        return np.logaddexp(log_start, np.log(np.maximum(sizes, 1e-300)) - log_rate)

    begin = (log_s.min(), np.log(n_bytes[widest]) - log_s[widest])
    try:
        best, covariance = curve_fit(logarithm, n_bytes, log_s, begin, maxfev=10_000)
    except RuntimeError:
        raise ConfigError("no latency and bandwidth were found", where=where) from None
    scatter = float(np.sqrt(np.mean((log_s - logarithm(n_bytes, *best)) ** 2)))
    if scatter > WORST_SCATTER:
        problem = (
            f"times lie {scatter:.0%} beside a latency and a bandwidth: expected less than "
            f"{WORST_SCATTER:.0%}"
        )
        raise ConfigError(problem, where=where)
    width = student.ppf(0.975, len(n_bytes) - 2) * np.sqrt(np.diag(covariance))
    fitted = []
    for name, log_value, half in zip(("small", "large"), best, width, strict=True):
        if not half < WORST_ERROR:
            problem = f"expected {name} messages too: what they take can't be told from the others"
            raise ConfigError(problem, where=where)
        fitted.append(_around(float(log_value), float(half)))
    return fitted[0], fitted[1], scatter


def _around(log_value: float, half: float) -> Fitted:
    low, value, high = (float(np.exp(log_value + n * half)) for n in (-1, 0, 1))
    return Fitted(value, low, high)


def _gap(table: Table, bandwidth: float, scatter: float, where: str) -> Fitted | None:
    """The mean interval of messages whose bytes take less than half of it, if there are any."""
    from scipy.stats import t as student

    measured = ~np.isnan(table.interval_s)
    if not measured.any():
        return None
    slow = measured & (table.interval_s > 2.2 * table.one_way_s)
    if slow.any():
        n_bytes = int(table.n_bytes[slow][0])
        problem = (
            f"{RATE} at {n_bytes} bytes: expected more than a message in each round trip, as of "
            "messages that are sent back to back"
        )
        raise ConfigError(problem, where=where)
    few = measured & (table.n_bytes / bandwidth < table.interval_s / 2)
    if not few.any():
        raise ConfigError(f"{RATE}: expected some of small messages", where=where)
    logs = np.log(table.interval_s[few])
    n = len(logs)
    spread = float(np.std(logs, ddof=1)) if n > 2 else max(scatter, 1e-6)
    freedom = n - 1 if n > 2 else len(table.n_bytes) - 2
    half = float(student.ppf(0.975, freedom)) * spread / np.sqrt(n)
    return _around(float(logs.mean()), half)
