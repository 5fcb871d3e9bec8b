"""Random numbers by counting: draw n of a key, whatever was drawn before.

Philox4x64-10 of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3"
(SC 2011), as in ``numpy.random.Philox``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from simmpp.common.compiled import kernel

_M0, _M1 = np.uint64(0xD2E7470EE14C6C93), np.uint64(0xCA5A826395121157)
_W0, _W1 = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBB67AE8584CAA73B)


@intrinsic
def _upper(typing_context: Any, a: Any, b: Any) -> Any:
    """The upper 64 bits of a product, which is one instruction."""

    def multiply(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        wide = ir.IntType(128)
        product = builder.mul(*(builder.zext(value, wide) for value in values))
        return builder.trunc(builder.lshr(product, ir.Constant(wide, 64)), ir.IntType(64))

    return types.uint64(types.uint64, types.uint64), multiply


@kernel
def philox(key: int, stream: int, counter: int) -> int:
    """The first word of a block, without its sign: 0 <= draw < 2^63."""
    k0, k1 = np.uint64(key), np.uint64(stream)
    a, b, c, d = np.uint64(counter), np.uint64(0), np.uint64(0), np.uint64(0)
    for _ in range(10):
        a, b, c, d = _upper(_M1, c) ^ b ^ k0, _M1 * c, _upper(_M0, a) ^ d ^ k1, _M0 * a
        k0, k1 = k0 + _W0, k1 + _W1
    draw: int = np.int64(a >> np.uint64(1))  # type: ignore[assignment]
    return draw
