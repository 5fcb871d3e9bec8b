"""Settings of all tests; each bears the name of its folder as a mark, and each folder its time."""

from __future__ import annotations

import os
from collections import Counter, defaultdict

import pytest
from hypothesis import settings

# The first example of a test may compile for seconds. On CI the same examples are tried each time.
settings.register_profile("simmpp", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("simmpp")


def layer(nodeid: str) -> str:
    """``unit`` of ``tests/unit/sweeps/test_plan.py::test_plan``."""
    return nodeid.split("/")[1]


def pytest_itemcollected(item: pytest.Item) -> None:
    """``pytest -m unit`` runs the tests of that folder."""
    item.add_marker(layer(item.nodeid))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Tests and seconds of each layer, with what they had to prepare; examples that were fuzzed."""
    tests, seconds, tried = Counter[str](), defaultdict[str, float](float), Counter[str]()
    for outcome, reports in terminalreporter.stats.items():
        for report in reports:
            if isinstance(report, pytest.TestReport):
                tests[layer(report.nodeid)] += report.when == "call" or outcome == "skipped"
                seconds[layer(report.nodeid)] += report.duration
                if report.when == "teardown":  # each phase's report repeats the properties
                    tried.update(dict(report.user_properties).get("tried", {}))
    if seconds:
        terminalreporter.section("layers")
    for name in sorted(seconds):
        terminalreporter.line(f"{name:10}{tests[name]:6} tests {seconds[name]:8.1f} s")
    for name in sorted(tried):
        terminalreporter.line(f"{tried[name]:6} {name}")
