"""A constant is a field of a class: its key, what users write for it, and its default follow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest
from pydantic import create_model

from simmpp.common.errors import ConfigError
from simmpp.common.quantities import Bandwidth, Size, Time
from simmpp.common.strict import Strict, structure
from simmpp.machine.constants import optional_fields
from simmpp.machine.machine import LEVELS
from simmpp.machine.presets import load_preset, machine, preset_names


@dataclass(frozen=True)
class Switched:
    name: str
    """Not a constant."""
    switch_ps: Time
    """Setting a switch,
    once a message."""
    trunk_bytes_per_s: Bandwidth
    """Of the trunk."""
    cell_bytes: Size = 53
    """Of a cell."""


def test_a_new_constant_is_one_field() -> None:
    made = create_model("Made", __base__=Strict, **optional_fields(Switched, {}))
    assert list(made.model_fields) == ["switch", "trunk_bandwidth", "cell_bytes"]
    assert made.model_fields["switch"].description == "Setting a switch, once a message."
    given = structure(made, {"switch": "3 ns", "trunk_bandwidth": "2 GB/s"}, {})
    assert dict(given) == {"switch": 3000, "trunk_bandwidth": 2 * 10**9, "cell_bytes": None}
    with pytest.raises(ConfigError, match="switch: value '3 MB': expected a time such as"):
        structure(made, {"switch": "3 MB"}, {})
    with pytest.raises(ConfigError, match="unknown key 'swich': did you mean 'switch'"):
        structure(made, {"swich": "3 ns"}, {})


@pytest.mark.parametrize("name", preset_names())
def test_a_machine_is_made_of_its_constants_as_text(name: str) -> None:
    """All of them override those of another preset: none is left to it, and none is lost."""
    written, made = load_preset(name).constants.model_dump(exclude_none=True), machine(name, {}, 8)
    other = "t3d" if name == "t3e" else "t3e"
    left = {"hop_latency_ps": made.hop_latency_ps, "name": name}
    if made.topology == LEVELS:
        del written["hop_latency"]  # refused, as it is in vain
    assert replace(machine(other, written, 8), **left) == made
