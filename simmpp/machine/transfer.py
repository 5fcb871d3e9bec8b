"""How long bytes take, in whole picoseconds, on a link or through a copy."""

from __future__ import annotations

from simmpp.common.compiled import njit

PS_PER_S = 10**12
MAX_BYTES_PER_S = 9 * 10**15
"""Fastest bandwidth that ``transfer_ps`` computes without overflow: remainder * 1000 < 2^63."""

FEW_BYTES = 9 * 10**6
"""Times PS_PER_S they are below 2^63."""


@njit
def transfer_ps(n_bytes: int, bytes_per_s: int) -> int:
    """Time of ``n_bytes`` at ``bytes_per_s``: bytes * 10^12 / bandwidth, halves rounded up.

    Bytes that are few enough are divided at once; for others long division in steps of 1000 keeps
    every intermediate value below 2^63. A bandwidth of 0 means unlimited.
    """
    if bytes_per_s == 0:
        return 0
    if n_bytes < FEW_BYTES:
        scaled = n_bytes * PS_PER_S
        whole = scaled // bytes_per_s
        rest = scaled - whole * bytes_per_s
        return whole + (1 if rest >= bytes_per_s - rest else 0)
    whole, rest = n_bytes // bytes_per_s, n_bytes % bytes_per_s
    for _ in range(4):
        rest *= 1000
        whole = whole * 1000 + rest // bytes_per_s
        rest %= bytes_per_s
    return whole + (1 if rest >= bytes_per_s - rest else 0)


def slower(*rates: int) -> int:
    """The lowest of bandwidths, of which 0 is unlimited."""
    return min((rate for rate in rates if rate), default=0)
