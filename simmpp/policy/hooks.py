"""Hooks as compiled code calls them: C functions of one record, by their address."""

from __future__ import annotations

from functools import cache
from typing import Any

from numba import types

from simmpp.common.compiled import cfunc
from simmpp.policy.file import key_of
from simmpp.policy.mistakes import not_compiled
from simmpp.policy.policy import Hook
from simmpp.policy.record import record_with


@cache
def address_of(hook: Hook | None, parameters: tuple[str, ...] = ()) -> int:
    """The machine code of a hook; 0 for one that the policy does not have.

    The policy's own ``parameters`` are words of the record that have names as well. Raises
    ConfigError for a hook that can't be compiled.
    """
    if hook is None:
        return 0
    try:
        compiled: Any = cfunc(types.int64(record_with(parameters)), key_of(hook))(hook)
    except Exception as error:  # numba's own, and what it trips over
        raise not_compiled(error, hook) from None
    return int(compiled.address)
