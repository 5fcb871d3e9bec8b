"""The constants of a machine as users write them: the keys of presets and of their overrides."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Bandwidth, Expect, Size, Strict, Time, integer, one_of, parsed_by
from simmpp.common.units import picoseconds, shown
from simmpp.machine.messages import MESSAGE_KINDS
from simmpp.machine.torus import CONTENTIONS, NO_CONTENTION

MOST_PROCESSORS = 65536
"""PEs of the largest torus of the presets: Blue Gene/L."""


def _shape(value: object) -> tuple[int, ...]:
    whole = isinstance(value, list | tuple) and all(
        isinstance(n, int) and not isinstance(n, bool) and 1 <= n <= MOST_PROCESSORS for n in value
    )
    if not whole or not isinstance(value, list | tuple) or len(value) != 3:
        raise ConfigError(f"value {shown(value)}: expected {_SHAPE}")
    return tuple(value)


_SHAPE = "three positive integers, such as [4, 4, 4]"
Shape = Annotated[tuple[int, int, int], parsed_by(_shape), Expect(_SHAPE)]


Quantum = Annotated[int, *integer(1, 2**31 - 1)]


class CopyConstants(Strict):
    """Cost of packing or unpacking one message: fixed + payload / bandwidth."""

    fixed: Time | None = Field(default=None, description="part that does not depend on the size")
    bandwidth: Bandwidth | None = Field(default=None, description="payload bytes copied per time")


class CopiesConstants(CopyConstants):
    """Copy costs of all kinds of messages, and of single kinds where they differ."""

    request: CopyConstants = Field(default=CopyConstants(), description="a request for an object")
    object: CopyConstants = Field(default=CopyConstants(), description="an object")
    rays: CopyConstants = Field(default=CopyConstants(), description="a batch of rays")
    load: CopyConstants = Field(default=CopyConstants(), description="the sender's load alone")


class TestConstants(Strict):
    """Cost of one ray-object intersection by kind of primitive."""

    __test__ = False  # not a test class, whatever pytest thinks of the name

    sphere: Time | None = Field(default=None, description="a test against a sphere")
    cone: Time | None = Field(default=None, description="a test against a cone or cylinder")
    polygon: Time | None = Field(
        default=None, description="a test against a polygon's first triangle"
    )
    mesh: Time | None = Field(
        default=None, description="a test against a mesh part's first triangle"
    )
    per_triangle: Time | None = Field(
        default=None, description="for every triangle beyond the first"
    )


def long_test(value: object) -> object:
    """One time for all kinds of primitives as the mapping it is short for."""
    if isinstance(value, dict | TestConstants):
        return value
    try:
        picoseconds(value)
    except ConfigError as error:
        raise ConfigError(f"{error.problem}, or a mapping by kind of primitive") from None
    return dict.fromkeys(("sphere", "cone", "polygon", "mesh"), value) | {"per_triangle": 0}


class Constants(Strict):
    """Any number of a machine's constants; what is None is left to the preset."""

    shape: Shape | None = Field(
        default=None, description="PEs along x, y, z of the torus; the most cubic when not given"
    )
    send_startup: Time | None = Field(default=None, description="sender's cost of any message")
    receive_startup: Time | None = Field(default=None, description="receiver's cost of any message")
    probe: Time | None = Field(default=None, description="looking into an empty inbox")
    pack: CopiesConstants = Field(
        default=CopiesConstants(), description="sender's copy of the payload"
    )
    unpack: CopiesConstants = Field(
        default=CopiesConstants(), description="receiver's copy of the payload"
    )
    header_bytes: Size | None = Field(default=None, description="header of every message")
    request_bytes: Size | None = Field(default=None, description="payload of a request")
    ray_bytes: Size | None = Field(default=None, description="one ray on the wire")
    latency: Time | None = Field(default=None, description="of the network, whatever the distance")
    hop_latency: Time | None = Field(default=None, description="for each link a message crosses")
    link_bandwidth: Bandwidth | None = Field(default=None, description="of one link, one way")
    injection_bandwidth: Bandwidth | None = Field(
        default=None, description="between a PE and its router"
    )
    contention: Annotated[str, *one_of(*CONTENTIONS)] = Field(
        default=NO_CONTENTION,
        description="what messages wait for: nothing, or links and ports that serve one at a time",
    )
    test: Annotated[TestConstants, parsed_by(long_test)] = Field(
        default=TestConstants(),
        description="one ray-object intersection: one time, or by kind of primitive",
    )
    ray: Time | None = Field(default=None, description="set-up and shading of one ray")
    quantum: Quantum | None = Field(
        default=None, description="tests computed at most between two looks into the inbox"
    )

    def flat(self) -> dict[str, int]:
        """The constants that are given, by dotted key (``pack.rays.bandwidth``): the numbers.

        What is given for all kinds of messages appears under each kind.
        """
        return _flat(self, "")


def _flat(model: Strict, prefix: str) -> dict[str, int]:
    if isinstance(model, CopiesConstants):
        return _flat_copies(model, prefix)
    given: dict[str, int] = {}
    for key in type(model).model_fields:
        value = getattr(model, key)
        if isinstance(value, Strict):
            given |= _flat(value, f"{prefix}{key}.")
        elif isinstance(value, int):
            given[prefix + key] = value
    return given


def _flat_copies(copies: CopiesConstants, prefix: str) -> dict[str, int]:
    given: dict[str, int] = {}
    for kind in MESSAGE_KINDS:
        own: CopyConstants = getattr(copies, kind)
        for key in CopyConstants.model_fields:
            value = getattr(own, key)
            value = getattr(copies, key) if value is None else value
            if value is not None:
                given[f"{prefix}{kind}.{key}"] = value
    return given
