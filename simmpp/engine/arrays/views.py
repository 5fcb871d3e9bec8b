"""The arrays of a run as compiled code sees them: ``rays(s)[7]`` is the record of ray 7.

A view is an intrinsic: its few instructions (address and length out of the run's record) are put
where it is used, so forty views cost no compilation of their own and no call.
"""

from __future__ import annotations

from typing import Any

import numba
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from simmpp.engine.arrays.hashtable import Lists, Table
from simmpp.engine.arrays.layout import ARRAYS
from simmpp.engine.arrays.records import Run


def _type_of(name: str) -> types.Array:
    return types.Array(numba.from_dtype(ARRAYS[name].dtype), 1, "C")


def _array(context: Any, builder: Any, run_type: Any, run: Any, name: str) -> Any:
    """Instructions that make an array of what the record says about it."""
    at, n = (
        context.get_getattr(run_type, field)(context, builder, run_type, run, field)
        for field in (f"{name}_at", f"{name}_n")
    )
    item_type = context.get_data_type(_type_of(name).dtype)
    item_bytes = context.get_constant(types.intp, context.get_abi_sizeof(item_type))
    array = make_array(_type_of(name))(context, builder)
    populate_array(
        array,
        data=builder.inttoptr(at, item_type.as_pointer()),
        shape=[n],
        strides=[item_bytes],
        itemsize=item_bytes,
        meminfo=None,
    )
    return array._getvalue()


def view(name: str) -> Any:
    """A function of a run's record that gives the array of that name."""

    @intrinsic
    def array_of(typing_context: Any, s: Run) -> Any:
        def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return _array(context, builder, s, values[0], name)

        return _type_of(name)(s), build

    return array_of


def bundle(kind: type, *names: str) -> Any:
    """A function of a run's record that gives a named tuple of arrays."""

    @intrinsic
    def tuple_of(typing_context: Any, s: Run) -> Any:
        def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            arrays = [_array(context, builder, s, values[0], name) for name in names]
            return context.make_tuple(builder, signature.return_type, arrays)

        return types.BaseTuple.from_types([_type_of(name) for name in names], kind)(s), build

    return tuple_of


itinerary_offsets = view("itinerary_offsets")
itinerary_objects = view("itinerary_objects")
child_offsets = view("child_offsets")
object_bytes = view("object_bytes")
test_ps = view("test_ps")
test_scales = view("test_scales")
owners = view("owners")
holder_offsets = view("holder_offsets")
holder_pes = view("holder_pes")
resident = view("resident")
replica_offsets = view("replica_offsets")
replica_objects = view("replica_objects")
pixels = view("pixels")
ray_rounds = view("ray_rounds")
rounds = view("rounds")
leaves = view("leaves")
deposits = view("deposits")
deposit_rounds = view("deposit_rounds")
deposit_lists = bundle(Lists, "deposit_ends", "deposit_links")
rooms = view("rooms")
most_alive = view("most_alive")
waited = view("waited")
credits = view("credits")
due = bundle(Lists, "due_ends", "due_links")
copy_costs = view("copy_costs")
noise_factors = view("noise_factors")
topology = view("topology")
policy_views = view("policy_views")
sent_by_kind = view("sent_by_kind")
parts_by_kind = view("parts_by_kind")
pes = view("pes")
rays = view("rays")
miss_rows = view("misses")
misses = bundle(Table, "miss_buckets", "misses", "miss_marks")
peer_rows = view("peers")
peers = bundle(Table, "peer_buckets", "peers", "peer_marks")
messages = view("messages")
message_marks = view("message_marks")
user_words = view("user_words")
asked_in = view("asked_in")
told_loads = view("told_loads")
unasked = bundle(Lists, "unasked_ends", "unasked_links")
recent = bundle(Lists, "recent_ends", "recent_links")
unsent = bundle(Lists, "unsent_ends", "unsent_links")
exchanged = bundle(Lists, "exchanged_ends", "exchanged_links")
sendable = bundle(Lists, "sendable_ends", "sendable_links")
outbox = view("outbox")
made_up = view("made_up")
sort_keys = view("sort_keys")
sort_items = view("sort_items")
tested_rays = view("tested_rays")
ends_ps = view("ends_ps")
tested_objects = view("tested_objects")
free_ps = view("free_ps")
log = view("log")
compute_bins = view("compute_bins")
communication_bins = view("communication_bins")
moments = view("moments")
traffic = view("traffic")
sizes = view("sizes")
slices = view("slices")
held_bins = view("held_bins")
heap = view("heap")
processes = view("processes")
