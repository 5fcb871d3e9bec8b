"""Rules as compiled code calls them: C functions of one record, by their address."""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction
from functools import cache
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from simmpp.common.compiled import cfunc
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.rules import Rule
from simmpp.policy.view import View

_DEFAULTS = PolicyParameters("object")
NUMBERS = tuple(
    field.name
    for field in fields(_DEFAULTS)
    if type(getattr(_DEFAULTS, field.name)) in (int, Fraction)
)
"""Parameters that rules may read: those whose default is a number."""
VIEW = np.dtype([(name, "i8") for name in (*View.__annotations__, *NUMBERS)])
"""A ``View``, with the policy's numbers."""

_RECORD = numba.from_dtype(VIEW)


@cache
def address_of(rule: Rule | None) -> int:
    """The machine code of a rule; 0 for one that the policy does not have."""
    compiled: Any = cfunc(types.int64(_RECORD))(rule) if rule else None
    return compiled.address if rule else 0


@intrinsic
def allows(typing_context: Any, address: Any, view: Any) -> Any:
    """Call the rule at ``address`` with a VIEW record, which goes as a pointer; 0 means no.

    A rule passed as a first-class function would cost microseconds to unwrap at every call from
    Python, and one compiled into its caller would leave that caller's cache stale when it changes.
    """

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = context.get_value_type(_RECORD)
        rule = ir.FunctionType(ir.IntType(64), [pointer]).as_pointer()
        return builder.call(builder.inttoptr(values[0], rule), [values[1]])

    return types.int64(types.int64, _RECORD), call
