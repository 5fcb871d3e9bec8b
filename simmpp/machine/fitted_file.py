"""A machine of one's own, as a file, with the constants that a ping-pong gave."""

from __future__ import annotations

import json
from collections.abc import Callable

from simmpp.common.units import format_bytes_per_s, format_ps
from simmpp.machine.fit import Fit, Fitted
from simmpp.machine.transfer import PS_PER_S

Row = tuple[str, str, str, str]
"""Constant, value, range, and what the range is."""
INTERVAL = "95 % confidence"
ASSUMED = "ESTIMATE: a ping-pong does not tell startups and latency apart"
_WITHIN = "within the startups and the bandwidth, as the ping-pong has it"


def rows_of(fit: Fit) -> list[Row]:
    """What was found, for people."""
    given: list[tuple[str, Fitted, Callable[[float], str]]] = [
        ("one way, of no bytes", fit.start_s, _time),
        ("send_startup", fit.startup_s, _time),
        ("receive_startup", fit.startup_s, _time),
        ("latency", fit.latency_s, _time),
        ("bandwidth", fit.bandwidth, _rate),
    ]
    if fit.gap_s is not None:
        given.append(("port_gap", fit.gap_s, _time))
    return [
        (name, write(of.value), _span(of, write), ASSUMED if of.is_estimate else INTERVAL)
        for name, of, write in given
    ]


def _time(seconds: float) -> str:
    return format_ps(round(seconds * PS_PER_S))


def _rate(bytes_per_s: float) -> str:
    return format_bytes_per_s(round(bytes_per_s))


def _span(of: Fitted, write: Callable[[float], str]) -> str:
    return f"{write(of.low)} to {write(of.high)}"


def _quoted(text: str) -> str:
    """As YAML reads it again, whatever is in it: names of tables are users' own."""
    return json.dumps(text, ensure_ascii=False)


def text_of(fit: Fit, table: str, base: str) -> str:
    """The YAML of a crossbar with these constants, the rest those of a preset.

    Packing is free in it, so that a simulated message takes what was measured.
    """
    found = {name: (value, span, what) for name, value, span, what in rows_of(fit)}
    lines = [
        f"# Written by simmpp machine fit {table}",
        f"description: {_quoted(f'Fitted to {table}')}",
        f"based_on: {base}",
        "constants:",
    ]

    def put(key: str, name: str) -> None:
        value, span, what = found[name]
        source = ASSUMED if what == ASSUMED else f"{table}, {INTERVAL}"
        ends = f"[{span.replace(' to ', ', ')}]"
        lines.append(f"  {key}: {{value: {value}, range: {ends}, source: {_quoted(source)}}}")

    for key in ("send_startup", "receive_startup"):
        put(key, key)
    for key in ("pack", "unpack"):
        lines.append(f"  {key}:")
        lines += [
            f'    {part}: {{value: {value}, source: "{_WITHIN}"}}'
            for part, value in (("fixed", 0), ("bandwidth", "unlimited"))
        ]
    put("latency", "latency")
    for key in ("link_bandwidth", "injection_bandwidth"):
        put(key, "bandwidth")
    if fit.gap_s is not None:
        put("port_gap", "port_gap")
    lines.append(f'  header_bytes: {{value: 0, source: "{_WITHIN}"}}')
    lines.append("  levels: {network: {}}  # a crossbar")
    return "\n".join(lines) + "\n"
