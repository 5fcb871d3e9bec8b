"""What messages cost by who serves, and who has no part in the paper's model."""

from __future__ import annotations

from dataclasses import replace

import pytest
from by_hand import MACHINE

from simmpp.common.errors import ConfigError
from simmpp.machine.machine import NIC, SERVICES, THREAD, CopyCost
from simmpp.machine.presets import machine
from simmpp.machine.service import copies
from simmpp.machine.topology import require_torus

SERVED = replace(MACHINE, handoff_ps=5, get_startup_ps=3, completion_ps=4)


def test_what_is_got_is_not_copied() -> None:
    few, rays = MACHINE.pack[0], MACHINE.pack[2]
    assert copies(MACHINE)[0] == [*MACHINE.pack, few, few, rays]
    pack, unpack = copies(replace(SERVED, service=NIC))
    free = CopyCost()
    assert pack == [free, free, rays, free, few, few, rays]
    few, rays = MACHINE.unpack[0], MACHINE.unpack[2]
    assert unpack == [free, free, rays, free, few, few, rays]


def test_the_papers_model_knows_pes_that_poll() -> None:
    require_torus(MACHINE)
    for service in (THREAD, NIC):
        with pytest.raises(ConfigError, match=f"machine.service: value '{service}': expected pe"):
            require_torus(replace(MACHINE, service=service))


def test_a_service_is_a_choice_over_the_presets() -> None:
    assert {machine(name, processors=8).service for name in ("t3e", "cloud")} == {"pe"}
    assert machine("t3e-shmem", processors=8).service == "nic"
    assert machine("t3e-shmem", {"service": "pe"}, 8).service == "pe"
    assert machine("t3e", {"handoff": "1 us", "service": "thread"}, 8).handoff_ps == 10**6
    with pytest.raises(ConfigError, match="expected pe, thread or nic"):
        machine("t3e", {"service": "card"}, 8)
    assert SERVICES == ("pe", "thread", "nic")
