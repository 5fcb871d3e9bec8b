"""The arrays of a run as compiled code sees them: views at the addresses in its record."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import carray, types
from numba.extending import intrinsic

from simmpp.common.compiled import njit
from simmpp.engine.arrays.hashtable import Lists, Table
from simmpp.engine.arrays.layout import (
    COPY,
    EVENT,
    I1,
    I4,
    I8,
    MESSAGE,
    MOMENT,
    PARTNER,
    PE,
    RAY,
    SLICE,
    TRAFFIC,
    WANT,
    Run,
)


@intrinsic
def _pointer(typing_context: Any, address: Any) -> Any:
    """The pointer to an address."""

    def cast(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.inttoptr(values[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), cast


@njit
def itinerary_offsets(s: Run) -> Any:
    """(n + 1,) int64."""
    return carray(_pointer(s.itinerary_offsets_at), s.itinerary_offsets_n, I8)


@njit
def itinerary_objects(s: Run) -> Any:
    """(tests,) int32."""
    return carray(_pointer(s.itinerary_objects_at), s.itinerary_objects_n, I4)


@njit
def child_offsets(s: Run) -> Any:
    """(n + 1,) int32."""
    return carray(_pointer(s.child_offsets_at), s.child_offsets_n, I4)


@njit
def object_bytes(s: Run) -> Any:
    """(N,) int64."""
    return carray(_pointer(s.object_bytes_at), s.object_bytes_n, I8)


@njit
def test_ps(s: Run) -> Any:
    """(N,) int64."""
    return carray(_pointer(s.test_ps_at), s.test_ps_n, I8)


@njit
def owners(s: Run) -> Any:
    """(N,) int32."""
    return carray(_pointer(s.owners_at), s.owners_n, I4)


@njit
def resident(s: Run) -> Any:
    """(nb * row_bytes,) uint8."""
    return carray(_pointer(s.resident_at), s.resident_n, I1)


@njit
def replica_offsets(s: Run) -> Any:
    """(nb + 1,) int64, or empty."""
    return carray(_pointer(s.replica_offsets_at), s.replica_offsets_n, I8)


@njit
def replica_objects(s: Run) -> Any:
    """(replicas,) int32: sorted for each PE."""
    return carray(_pointer(s.replica_objects_at), s.replica_objects_n, I4)


@njit
def copy_costs(s: Run) -> Any:
    """(8,) COPY."""
    return carray(_pointer(s.copy_costs_at), s.copy_costs_n, COPY)


@njit
def sent_by_kind(s: Run) -> Any:
    """(4,) int64."""
    return carray(_pointer(s.sent_by_kind_at), s.sent_by_kind_n, I8)


@njit
def pes(s: Run) -> Any:
    """(nb,) PE."""
    return carray(_pointer(s.pes_at), s.pes_n, PE)


@njit
def rays(s: Run) -> Any:
    """(n,) RAY."""
    return carray(_pointer(s.rays_at), s.rays_n, RAY)


@njit
def want_rows(s: Run) -> Any:
    """(capacity,) WANT."""
    return carray(_pointer(s.wants_at), s.wants_n, WANT)


@njit
def wants(s: Run) -> Table:
    """WANT rows by PE * N + object."""
    return Table(
        carray(_pointer(s.wants_buckets_at), s.wants_buckets_n, I4),
        want_rows(s),
        carray(_pointer(s.wants_marks_at), s.wants_marks_n, I4),
    )


@njit
def partner_rows(s: Run) -> Any:
    """(capacity,) PARTNER."""
    return carray(_pointer(s.partners_at), s.partners_n, PARTNER)


@njit
def partners(s: Run) -> Table:
    """PARTNER rows by PE * nb + the other PE."""
    return Table(
        carray(_pointer(s.partners_buckets_at), s.partners_buckets_n, I4),
        partner_rows(s),
        carray(_pointer(s.partners_marks_at), s.partners_marks_n, I4),
    )


@njit
def messages(s: Run) -> Any:
    """(capacity,) MESSAGE."""
    return carray(_pointer(s.messages_at), s.messages_n, MESSAGE)


@njit
def messages_marks(s: Run) -> Any:
    """(2,) int32: free list and high-water mark of ``messages``."""
    return carray(_pointer(s.messages_marks_at), s.messages_marks_n, I4)


@njit
def unasked(s: Run) -> Lists:
    """Wants with unasked rays, two lists per PE."""
    return _lists(s.unasked_ends_at, s.unasked_ends_n, s.unasked_links_at, s.unasked_links_n)


@njit
def recent(s: Run) -> Lists:
    """Wants in transient memory, one list per PE."""
    return _lists(s.recent_ends_at, s.recent_ends_n, s.recent_links_at, s.recent_links_n)


@njit
def unsent(s: Run) -> Lists:
    """Partners with sendable rays, two lists per PE."""
    return _lists(s.unsent_ends_at, s.unsent_ends_n, s.unsent_links_at, s.unsent_links_n)


@njit
def exchanged(s: Run) -> Lists:
    """Partners that rays or objects were exchanged with, one list per PE."""
    return _lists(
        s.exchanged_ends_at, s.exchanged_ends_n, s.exchanged_links_at, s.exchanged_links_n
    )


@njit
def sendable(s: Run) -> Lists:
    """Wants with sendable rays, one list per partner."""
    return _lists(s.sendable_ends_at, s.sendable_ends_n, s.sendable_links_at, s.sendable_links_n)


@njit
def _lists(ends_at: int, ends_n: int, links_at: int, links_n: int) -> Lists:
    return Lists(carray(_pointer(ends_at), ends_n, I4), carray(_pointer(links_at), links_n, I4))


@njit
def outbox(s: Run) -> Any:
    """(capacity,) int32."""
    return carray(_pointer(s.outbox_at), s.outbox_n, I4)


@njit
def sort_keys(s: Run) -> Any:
    """(max(N, nb),) int64."""
    return carray(_pointer(s.sort_keys_at), s.sort_keys_n, I8)


@njit
def sort_items(s: Run) -> Any:
    """(max(N, nb),) int64."""
    return carray(_pointer(s.sort_items_at), s.sort_items_n, I8)


@njit
def tested_rays(s: Run) -> Any:
    """(tests,) int32, or empty."""
    return carray(_pointer(s.tested_rays_at), s.tested_rays_n, I4)


@njit
def tested_objects(s: Run) -> Any:
    """(tests,) int32, or empty."""
    return carray(_pointer(s.tested_objects_at), s.tested_objects_n, I4)


@njit
def free_ps(s: Run) -> Any:
    """(8 nb,) int64, or empty: see ``machine.links``."""
    return carray(_pointer(s.free_ps_at), s.free_ps_n, I8)


@njit
def compute_bins(s: Run) -> Any:
    """(nb * BINS,) int64, or empty."""
    return carray(_pointer(s.compute_bins_at), s.compute_bins_n, I8)


@njit
def communication_bins(s: Run) -> Any:
    """(nb * BINS,) int64, or empty."""
    return carray(_pointer(s.communication_bins_at), s.communication_bins_n, I8)


@njit
def moments(s: Run) -> Any:
    """(BINS,) MOMENT, or empty."""
    return carray(_pointer(s.moments_at), s.moments_n, MOMENT)


@njit
def traffic(s: Run) -> Any:
    """(nb * nb,) TRAFFIC, or empty."""
    return carray(_pointer(s.traffic_at), s.traffic_n, TRAFFIC)


@njit
def sizes(s: Run) -> Any:
    """(4 * SIZES,) int64, or empty."""
    return carray(_pointer(s.sizes_at), s.sizes_n, I8)


@njit
def slices(s: Run) -> Any:
    """(nb,) SLICE, or empty."""
    return carray(_pointer(s.slices_at), s.slices_n, SLICE)


@njit
def log(s: Run) -> Any:
    """(capacity,) EVENT, or empty."""
    return carray(_pointer(s.log_at), s.log_n, EVENT)
