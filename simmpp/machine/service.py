"""Who serves requests: the PE itself, a thread beside it, or the network card of its node.

``pe``
    A PE is one sequential processor that polls, as under PVM. A request lies in its inbox until its
    activity is over, at most a quantum of tests; then the PE pays receive startup and unpacking for
    it, send startup and packing for the object.

``thread``
    Beside each PE works a thread, a sequential server with the same costs. It receives all messages
    as they come, one after the other (receive startup + unpacking); at the end of that it notes the
    load in the header, hands rays, objects and loads over to the PE, which wakes if it sleeps, and
    answers requests (send startup + packing) with the load that the PE had when its last activity
    ended. The PE takes a message over for ``handoff`` when it next looks, as it would receive it,
    in the order in which they were handed over. What a PE decides to send it packs itself. What the
    thread does is no time of the PE: it is told apart, as ``service_ps``.

``nic``
    A message is an operation of one side, as with SHMEM on the T3E, or RDMA. Who requests an object
    *gets* it: the PE starts that for ``get_startup``, a message of header and request goes to the
    network card of the owner, and from there the object departs at once, with a header. The owner
    has no part in it. Who got it sees that for ``completion``; there is nothing to unpack.

    Rays are *put*: send startup and packing, then completion and unpacking. An object does not tell
    the load of its owner. Loads come with rays or, with ``refresh``, by a get of 8 bytes from each
    PE of which nothing was heard, nor a load got, for that long; it tells the load that the owner
    had when its last activity ended before the get came. Each get is a message, whatever is packed.

So with ``nic`` an object is there, if the PE has nothing else to do then,

    get_startup + 2 (latency + hops x hop latency)
    + (header + request) / bandwidth + (header + object) / bandwidth + completion

after the decision. With contention both messages take ports and links as all do: the injection port
of the owner is busy with the object for its bytes.

An example, on two PEs one hop apart: latency 100, hop latency 30, header 4, request 8, object 50
bytes at 1 byte per unit of time, startups 10 to send and 20 to receive, copies for nothing. At 0
the PE decides, and the owner begins a quantum of 4000. The object is there at

    pe      10 + 142 + (4000 - 152) + 20 + 10 + 184 + 20    = 4234
    thread  10 + 142 + 20 + 10 + 184 + 20 + handoff         = 386 + handoff
    nic     get_startup + 142 + 184 + completion            = 326 + both

Sources: polling as in the paper, which ran on PVM; gets and puts of SHMEM and their 1 us (CSC, Cray
T3E User's Guide, p. 62); a thread for messages as asynchronous renderers on clusters have it
(ESTIMATE: what taking over costs).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from simmpp.machine.machine import NIC, THREAD, CopyCost, Machine
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST, USER_COPIED_AS

LOAD_BYTES = 8
"""Of a load that is got: one 64-bit word."""


def copies(machine: Machine) -> tuple[list[CopyCost], list[CopyCost]]:
    """What a PE, or its thread, pays for packing each kind of message, and for unpacking it."""
    own = (USER_COPIED_AS, USER_COPIED_AS, RAYS)  # of a policy's own, for pixels, deposits
    pack, unpack = ([*of, *(of[kind] for kind in own)] for of in (machine.pack, machine.unpack))
    if machine.service == NIC:
        for kind in (REQUEST, OBJECT, LOAD):
            pack[kind] = unpack[kind] = CopyCost()
    return pack, unpack


def fixed_costs(
    constants: Mapping[str, Any], send_ps: int, receive_ps: int
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Of each kind of message, and of each kind of part: what both PEs pay whatever its size.

    ``constants`` are the fields of a machine, as records have them; older ones have no service.
    Startups are given, as those of levels differ.
    """
    pack, unpack = ([of["fixed_ps"] for of in constants[name]] for name in ("pack", "unpack"))
    startups = [send_ps + receive_ps] * len(pack)
    fixed = [sum(both) for both in zip(pack, unpack, strict=True)]
    if constants.get("service") == THREAD:  # the PE packs what it sends, and takes over
        handoff_ps = constants["handoff_ps"]
        startups = [send_ps + handoff_ps] * len(pack)
        startups[REQUEST], startups[OBJECT] = send_ps, handoff_ps
        fixed = [*pack]
        fixed[OBJECT] = 0
    elif constants.get("service") == NIC:
        get_ps, completion_ps = constants["get_startup_ps"], constants["completion_ps"]
        startups[REQUEST], startups[OBJECT] = get_ps, completion_ps
        startups[RAYS] = send_ps + completion_ps
        startups[LOAD] = (get_ps + completion_ps) // 2  # a load is got by two messages
        fixed[REQUEST] = fixed[OBJECT] = fixed[LOAD] = 0
    return tuple(startups), tuple(fixed)
