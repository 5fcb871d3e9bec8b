"""Names of the integers of a result, as columns of ``results.csv`` have them."""

COLUMNS = (
    "makespan_ps",
    "messages",
    "request_messages",
    "object_messages",
    "ray_messages",
    "load_messages",
    "bytes_sent",
    "rays",
    "tests",
    "rays_sent",
    "objects_fetched",
    "compute_ps",
    "communication_ps",
    "waiting_ps",
    "peak_rays",
    "peak_bytes",
    "events",
)
"""Integers of a result, as in a row of ``results.csv``; times of PEs are sums over them."""
SERVICE_COLUMNS = ("service_ps",)
"""A further one, in rows of sweeps on machines whose threads serve."""
PACKED_COLUMNS = ("request_parts", "object_parts", "ray_parts", "peak_object_bytes")
"""Further ones, in rows of sweeps in which a policy packs."""
USER_COLUMNS = ("user_messages", "user_dropped")
"""Likewise, in which a policy sends messages of its own."""
ROUND_COLUMNS = ("barriers", "barrier_ps", "round_messages")
"""Likewise, with rays in rounds that others waited for."""
TALLY_COLUMNS = ("tally_messages", "deposits", "reduction_ps")
"""Likewise, with tallies of which something is sent."""
STEAL_COLUMNS = ("steal_messages",)
"""Likewise, in which PEs steal pixels."""
UNEVEN_COLUMNS = ("launch_ps", "work_ps", "bound_ps")
"""Likewise, with a machine on which computing is uneven."""
