"""Ctrl-C: where it must not come between, and a process that ends when it comes.

Python raises a KeyboardInterrupt in its main thread as soon as that runs Python again. Two things
stand against this. Compilers and other foreign code that calls Python back may lose the exception,
or go on with half an answer: :class:`Uninterrupted` puts it off until such code has returned. And
code that doesn't return for long keeps it waiting: :func:`ending_on_signals` lets a process wait
PATIENCE_S for its own end and no longer.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any, ClassVar, NoReturn

SIGNALS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
"""What ends a command, with the word that says so."""
PATIENCE_S = 1.5
"""How long a process may take to end: to close its files and write its tables."""
SHOW_CURSOR = b"\r\x1b[J\x1b[?25h"
"""To a terminal on which a bar was being drawn."""
_Handler = Callable[[int, FrameType | None], Any]


class Interrupt(KeyboardInterrupt):
    """The signal that came; whoever is ready for Ctrl-C is ready for the others."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


def last_word(interrupt: KeyboardInterrupt) -> tuple[str, int]:
    """What whoever asks now says of it, and the exit code: 128 + the signal's number."""
    _State.is_told = True
    number = interrupt.number if isinstance(interrupt, Interrupt) else signal.SIGINT
    return SIGNALS[signal.Signals(number)], 128 + number


class Uninterrupted:
    """``with Uninterrupted():`` signals are noted, and answered when the block is over.

    Within another such block, and beside the main thread, where no signal is answered, it does
    nothing. It takes 40 us; less than one in a process that :func:`ending_on_signals`.
    """

    def __enter__(self) -> None:
        self._before: dict[int, _Handler] = {}
        self._is_outermost = not _State.puts_off and _is_main()
        if not self._is_outermost:
            return
        if not _State.is_ours:
            handlers = {number: signal.getsignal(number) for number in SIGNALS}
            self._before = {n: handler for n, handler in handlers.items() if callable(handler)}
        for number in self._before:
            signal.signal(number, _note)
        _State.puts_off = True

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        if not self._is_outermost:
            return
        _State.puts_off = False
        for number, handler in self._before.items():
            signal.signal(number, handler)
        if _State.noted:
            number = _State.noted[0]
            _State.noted.clear()
            self._before.get(number, _interrupt_once)(number, sys._getframe())


class _State:
    """Of the main thread."""

    is_ours = False
    """Signals come to :func:`_interrupt_once`."""
    puts_off = False
    noted: ClassVar[list[int]] = []
    came: ClassVar[Interrupt | None] = None
    """The signal that was answered."""
    is_told = False
    """Somebody says, or has said, by what the process is ended."""


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


def _note(number: int, frame: FrameType | None) -> None:
    _State.noted.append(number)


@contextmanager
def ending_on_signals() -> Iterator[None]:
    """The whole of a command: ended by a signal, it says so in one line and the process ends.

    A signal that the process was begun to ignore, as in the background of a script, stays ignored.
    """
    heard, pen = os.pipe()
    os.set_blocking(pen, False)
    signal.set_wakeup_fd(pen, warn_on_full_buffer=False)
    defaults = (signal.default_int_handler, signal.SIG_DFL)
    for number in SIGNALS:
        if signal.getsignal(number) in defaults:
            signal.signal(number, _interrupt_once)
    _State.is_ours = True
    sys.unraisablehook = _unless_interrupt(sys.unraisablehook)
    threading.Thread(target=_end_when_heard, args=(heard,), daemon=True).start()
    try:
        yield
    except KeyboardInterrupt as interrupt:
        _end(interrupt)
    except Exception:
        if _State.came is None:
            raise
        _end(_State.came)  # what a signal breaks off may fail in its own way: a pipe, a worker
    except SystemExit as leaving:
        if leaving.code in [128 + number for number in SIGNALS]:
            _leave(int(leaving.code))
        raise


def _interrupt_once(number: int, frame: FrameType | None) -> None:
    """Raise; a second Ctrl-C, while what the first one began is under way, changes nothing."""
    if _State.puts_off:
        _note(number, frame)
        return
    for other in SIGNALS:
        signal.signal(other, _pass)  # not SIG_IGN, which processes begun here would inherit
    _State.came = Interrupt(number)
    raise _State.came


def _pass(number: int, frame: FrameType | None) -> None:
    pass


def _unless_interrupt(show: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """An interrupt that was lost in a destructor or a callback is not told: the process ends."""

    def hook(lost: Any) -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            show(lost)

    return hook


def _say(word: str) -> None:
    with suppress(OSError):
        os.write(2, f"simmpp: {word}\n".encode())


def _end_when_heard(heard: int) -> None:
    """In a thread: the time that the process has for its own end begins with the signal.

    The signal is written into the pipe when it comes, whatever the main thread does.
    """
    number = next(byte for byte in iter(lambda: os.read(heard, 1)[0], None) if byte in SIGNALS)
    time.sleep(PATIENCE_S)
    with suppress(OSError):
        if os.isatty(2):
            os.write(2, SHOW_CURSOR)
    if not _State.is_told:
        _say(SIGNALS[signal.Signals(number)])
    os._exit(128 + number)


def _end(interrupt: KeyboardInterrupt) -> NoReturn:
    word, code = last_word(interrupt)
    _say(word)
    _leave(code)


def _leave(code: int) -> NoReturn:
    """End at once: what Python does at its end may wait for processes that are starting."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)
