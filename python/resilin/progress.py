"""One line about a run that goes on: overwritten in a terminal and in a notebook, else repeated now and then."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from resilin import _core

BETWEEN_DRAWS = 0.1  # [s]
BETWEEN_LINES = 2.0  # [s]
LONG_STEP = 1.0  # [s]: a step that lasts longer is told of while it goes on ...
BETWEEN_LINES_OF_A_STEP = 10.0  # [s]: ... where lines are printed, once in so long a time without any


class Progress:
    """Prints after steps of `simulation`, and within those that last.

    Parameters
    ----------
    is_shown : bool or None
        None: in a terminal and in a notebook only.
    """

    def __init__(self, simulation: _core.Simulation, is_shown: bool | None = None) -> None:
        self._simulation = simulation
        self._overwrites = sys.stdout.isatty() or is_notebook()
        self._is_shown = self._overwrites if is_shown is None else is_shown
        self._width = 0
        self._next = self._next_in_step = self._step_start = self._start = time.monotonic()

    @property
    def after_step(self) -> Callable[..., None] | None:
        """Callbacks of the core: after each step, and within one with (fraction done, activity); or None."""
        return self._step if self._is_shown else None

    def _step(self, share: float | None = None, text: str = "") -> None:
        now = time.monotonic()
        if share is not None:
            if now >= max(self._step_start + LONG_STEP, self._next_in_step):
                self._print(f"{100 * share:3.0f} %  {text}, {now - self._start:.3g} s")
            return
        self._step_start = now
        if now < self._next and not self._simulation.is_finished:
            return
        self._next = now + (BETWEEN_DRAWS if self._overwrites else BETWEEN_LINES)
        self._print(self._text())

    def _print(self, text: str) -> None:
        self._next_in_step = time.monotonic() + (BETWEEN_DRAWS if self._overwrites else BETWEEN_LINES_OF_A_STEP)
        if self._overwrites:
            print("\r" + text.ljust(self._width), end="", flush=True)
            self._width = len(text)
        else:
            print(text, flush=True)

    def _text(self) -> str:
        simulation = self._simulation
        share = simulation.share_done
        if simulation.is_dynamic:
            state = f"step {simulation.step_number}/{simulation.expected_steps}, t = {simulation.time:.4g} s"
        else:
            state = f"step {simulation.step_number}, load {simulation.load:.4g}"
        return f"{100 * share:3.0f} %  {state}, {time.monotonic() - self._start:.3g} s"

    def end(self) -> None:
        """Ends the line that was drawn."""
        if self._width:
            print(flush=True)
        self._width = 0


class _Line:
    """A text, overwritten in a terminal and in a notebook, else repeated now and then."""

    BETWEEN_DRAWS = 0.1  # [s]
    BETWEEN_LINES = 2.0  # [s]

    def __init__(self, is_shown: bool | None) -> None:
        self._overwrites = sys.stdout.isatty() or is_notebook()
        self.is_shown = self._overwrites if is_shown is None else is_shown
        self._width = 0
        self._text = ""
        self._next = 0.0

    def _is_due(self) -> bool:
        return self.is_shown and time.monotonic() >= self._next

    def _print(self, text: str) -> None:
        self._next = time.monotonic() + (self.BETWEEN_DRAWS if self._overwrites else self.BETWEEN_LINES)
        if text == self._text:
            return
        self._text = text
        if self._overwrites:
            print("\r" + text.ljust(self._width), end="", flush=True)
            self._width = len(text)
        else:
            print(text, flush=True)

    def end(self) -> None:
        """Ends the line that was drawn."""
        if self._width:
            print(flush=True)
        self._width = 0


class SweepProgress(_Line):
    """One line about a sweep that goes on: overwritten in a terminal and in a notebook, else repeated now and then."""

    BETWEEN_LINES = 5.0  # [s]

    def show(self, done: int, failed: int, scenes: int, seconds_left: float | None) -> None:
        """Says how many have ended; `seconds_left` is None as long as nobody knows."""
        if not self.is_shown or (done + failed < scenes and not self._is_due()):
            return
        text = f"{100 * (done + failed) / max(scenes, 1):3.0f} %  {done} of {scenes} done"
        text += f", {failed} failed" if failed else ""
        text += f", {seconds_left:.3g} s left" if seconds_left is not None and done + failed < scenes else ""
        self._print(text)


class SearchProgress(_Line):
    """One line about a search that lasts for more than a second, likewise."""

    def __init__(self, is_shown: bool | None) -> None:
        super().__init__(is_shown)
        self._start = time.monotonic()
        self._next = self._start + LONG_STEP

    def show(self, share: float, text: str) -> None:
        """Says what it is at."""
        if self._is_due():
            self._print(f"{100 * share:3.0f} %  {text}, {time.monotonic() - self._start:.3g} s")


def is_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return type(shell).__name__ == "ZMQInteractiveShell"
