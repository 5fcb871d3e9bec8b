"""What all PEs do together: barriers and reductions, in ceil(log2 nb) stages.

In each stage every PE sends a message and receives one, as in a dissemination barrier or an
all-reduce by recursive doubling (Thakur, Rabenseifner, Gropp, IJHPCA 19, 2005): startups, latency,
and the time of the bytes. With levels these are those of the outermost.
"""

from __future__ import annotations

from simmpp.machine.machine import LEVELS, Machine
from simmpp.machine.topology import topology_of
from simmpp.machine.transfer import slower, transfer_ps


def stages(machine: Machine) -> int:
    """ceil(log2 nb)."""
    return (machine.processors - 1).bit_length()


def barrier_ps(machine: Machine) -> int:
    """From the last PE's arrival until all know of it; a reduction of a word takes as long."""
    return stages(machine) * _startups_ps(machine)


def all_reduce_ps(machine: Machine, n_bytes: int) -> int:
    """Until every PE has the sum of what each had."""
    rate = slower(*topology_of(machine).rates)
    return stages(machine) * (_startups_ps(machine) + transfer_ps(n_bytes, rate))


def messages_of(machine: Machine) -> int:
    """Messages of a barrier or a reduction: of every PE one in each stage."""
    return stages(machine) * machine.processors


def _startups_ps(machine: Machine) -> int:
    of = machine.levels[-1] if machine.topology == LEVELS else machine
    return of.send_startup_ps + of.receive_startup_ps + of.latency_ps
