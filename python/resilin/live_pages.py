"""The pages of a live scene that somebody else shows: what moves the scene, and carries words to and fro.

The protocol is that of `resilin view` (docs/view_protocol.md); how words travel is the caller's business.
"""

from __future__ import annotations

import atexit
import threading
import time
import weakref
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from resilin import _core

PATIENCE = 2.0  # [s] without an answer, after which nobody seems to look, and the scene waits


class _Page(NamedTuple):
    send: Callable[[str | bytes], None]  # carries a message of the program to it
    end: Callable[[str], None]  # says in words that nothing more will come


class LivePages:
    """Moves a live scene, in real time, while a page of it is open and answers.

    A thread does so; it ends when nothing moves or nobody looks, and a word of a page or `wake` starts it again. Texts
    and bytes reach each page in their order.
    """

    def __init__(self, core: _core.LiveScene) -> None:
        self._core = core
        self._pages: dict[int, _Page] = {}
        self._owing_since: dict[int, float] = {}  # times since when pages owe an answer to the last message
        self._last_number = 0
        self._sending = threading.Lock()
        self._starting = threading.Lock()
        self._thread: threading.Thread | None = None
        self._has_ended = False
        _all_pages.add(self)

    def open(self, send: Callable[[str | bytes], None], end: Callable[[str], None]) -> int:
        """A page is there, to which `send` carries all that it is to know. The number by which it is called."""
        self._last_number += 1
        page = self._last_number
        self._core.open_page(page)
        self._pages[page] = _Page(send, end)
        self._tell()
        self.wake()
        return page

    def close(self, page: int) -> None:
        """A page is gone; what it held is let go."""
        if self._pages.pop(page, None) is None:
            return
        self._owing_since.pop(page, None)
        self._core.close_page(page)
        if self._pages:
            self.wake()
        else:
            self._core.take_turn()  # the last one: nobody else lets go of what it held

    def receive(self, page: int, message: str | bytes) -> None:
        """A page says something."""
        if page in self._pages:
            self._owing_since.pop(page, None)
            self._core.receive(page, message)
            self._tell()
            self.wake()

    def wake(self) -> None:
        """Something may be to do; of no effect where no page is open."""
        with self._starting:
            if self._pages and self._thread is None and not self._has_ended:
                self._thread = threading.Thread(target=self._move, name="resilin view", daemon=True)
                self._thread.start()

    def end(self, words: str = "") -> None:
        """Nothing moves any more; with words that pages are told."""
        with self._starting:
            self._has_ended = True
            thread = self._thread
        if thread is not None and thread is not threading.current_thread():
            thread.join()
        for number, page in list(self._pages.items()):
            if words:
                page.end(words)
            self.close(number)

    def _move(self) -> None:
        while True:
            with self._starting:
                seconds = self._core.seconds_to_turn()
                if seconds is None or self._has_ended or not self._is_watched():
                    self._thread = None
                    return
            time.sleep(seconds)
            self._core.take_turn()
            self._tell()

    def _is_watched(self) -> bool:
        now = time.monotonic()
        return any(now - self._owing_since.get(page, now) < PATIENCE for page in list(self._pages))

    def _tell(self) -> None:
        """All pages what is new for them. One that cannot be reached is gone."""
        gone = []
        with self._sending:
            for number, page in list(self._pages.items()):
                try:
                    while (message := self._core.next_message(number)) is not None:
                        self._owing_since.setdefault(number, time.monotonic())
                        page.send(message)
                except Exception:  # errors of whatever carries it
                    gone.append(number)
        for number in gone:
            self.close(number)


_all_pages: weakref.WeakSet[LivePages] = weakref.WeakSet()


@atexit.register
def _end_all() -> None:
    """A thread that outlives the interpreter would end the process by a signal."""
    for pages in list(_all_pages):
        pages.end()
