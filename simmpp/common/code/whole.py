"""How numba puts kernels together: once, with what Python calls.

This knows numba's compiler from inside, so ``pyproject.toml`` bounds numba's version.
"""

from __future__ import annotations

from typing import Any

from llvmlite.binding import Linkage
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


class _Part(JITCodeLibrary):  # type: ignore[misc]
    """Instructions of a kernel, as they were written.

    They are optimised and made machine code once, with all that calls them. Left alone, numba does
    so for each kernel by itself, and for all that it calls again: half the time of compiling.
    """

    def _optimize_final_module(self) -> None:
        """Nothing yet."""

    def _finalize_final_module(self) -> None:
        """Callers may have them."""
        self._finalized = True

    @property
    def codegen(self) -> _Part:
        """Who is given Python's globals for the machine code that there isn't."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Nobody needs them."""


class _Whole(JITCodeLibrary):  # type: ignore[misc]
    """Instructions of what Python calls, with all that it calls, which nobody else can call.

    So a kernel that is called from one place is put there. They get names of their own, as LLVM's
    linker takes what is local to one module for what another one shares under the same name.
    """

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if function.linkage == Linkage.linkonce_odr:
                function.linkage = Linkage.internal
                function.name += ".inside"
        super()._optimize_final_module()


class KernelCompiler(Compiler):  # type: ignore[misc]
    """numba's compiler, for such parts."""

    def __init__(self, typing: Any, target: Any, _library: object, *rest: Any) -> None:
        super().__init__(typing, target, _Part(target.codegen(), "kernel"), *rest)


class WholeCompiler(Compiler):  # type: ignore[misc]
    """The same, for what is whole."""

    def __init__(self, typing: Any, target: Any, _library: object, *rest: Any) -> None:
        whole = _Whole(target.codegen(), "whole")
        whole.enable_object_caching()
        super().__init__(typing, target, whole, *rest)
