"""Who serves requests: the PE itself, a thread beside it, or the network card of its node.

- ``pe``: a PE is one sequential processor that polls, as under PVM. A request lies in its inbox
  until its activity is over, at most a quantum of tests; then the PE pays receive startup and
  unpacking for it, send startup and packing for the object.
- ``thread``: beside each PE works a thread, a sequential server with the same costs. It receives
  all messages, one after the other as they come (receive startup + unpacking); at the end of that
  it notes the load in the header, hands rays, objects and loads over to the PE, and answers
  requests (send startup + packing) with the load that the PE had when its last activity ended. The
  PE, which is woken by it, takes a message over for ``handoff`` when it next looks, as it would
  receive one, in the order in which they were handed over. What a PE decides to send it packs
  itself. What the thread does is no time of the PE: it is told apart, as ``service_ps``.
- ``nic``: a message is an operation of one side, as with SHMEM on the T3E or RDMA. Who requests
  an object *gets* it. The PE starts that for ``get_startup``; a message of header and request goes to
  the network card of the owner, from where the object departs at once, with a header: the owner has
  no part in it. Who got it sees that for ``completion``; there is nothing to unpack. Rays are *put*:
  send startup and packing, then completion and unpacking. An object does not tell the load of its
  owner. Loads come with rays or, with ``refresh``, by a get of 8 bytes from each PE of which nothing
  was heard, and no load was got, for that long; it tells the load that the owner had when its last
  activity ended before the request came. Each get is a message, whatever is packed.

So with nic an object is there

    get_startup + 2 (latency + hops x hop latency)
    + (header + request) / bandwidth + (header + object) / bandwidth + completion

after the decision, if the PE has nothing else to do then. With contention both messages take ports
and links as all do: the injection port of the owner is busy with the object for its bytes.

An example, on two PEs one hop apart: latency 100, hop latency 30, header 4, request 8 and object 50
bytes at 1 byte per unit of time, startups 10 to send and 20 to receive, nothing for copies. The PE
decides at 0, the owner begins a quantum of 4000 then. The object is there at

    pe      10 + 142 + (4000 - 152) + 20 + 10 + 184 + 20             = 4234
    thread  10 + 142 + 20 + 10 + 184 + 20 + handoff                  = 386 + handoff
    nic     get_startup + 142 + 184 + completion                     = 326 + both

Sources: polling as in the paper, of which PVM is what it ran on; gets and puts of SHMEM and their
1 us (CSC, Cray T3E User's Guide, p. 62); a thread for messages as in asynchronous renderers on
clusters (ESTIMATE for what it costs to take over what it has received).
"""

from __future__ import annotations

from simmpp.machine.machine import NIC, Copies, CopyCost, Machine
from simmpp.machine.messages import LOAD, OBJECT, REQUEST

LOAD_BYTES = 8
"""Of a load that is got: one 64-bit word."""


def copies(machine: Machine) -> tuple[Copies, Copies]:
    """What a PE, or its thread, pays for packing each kind of message, and for unpacking it."""
    pack, unpack = list(machine.pack), list(machine.unpack)
    if machine.service == NIC:
        for kind in (REQUEST, OBJECT, LOAD):
            pack[kind] = unpack[kind] = CopyCost()
    return (pack[0], pack[1], pack[2], pack[3]), (unpack[0], unpack[1], unpack[2], unpack[3])
