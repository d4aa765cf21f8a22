"""The page of a live scene as a widget of notebooks. Needs anywidget, which nothing else does."""

from __future__ import annotations

import pathlib
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from resilin import _core

if TYPE_CHECKING:
    from collections.abc import Sequence

    from resilin.live_pages import LivePages

ENDED = "This scene has ended in its program. Run the cell again to see it move."


class LiveView(anywidget.AnyWidget):
    """A page for each cell that shows it; all of them play with one scene."""

    _esm = pathlib.Path(__file__).parent / "widget.js"
    height = traitlets.Int(560).tag(sync=True)  # [px]
    title = traitlets.Unicode().tag(sync=True)

    def __init__(self, pages: LivePages, title: str, height: int) -> None:
        self._pages = pages
        self._numbers: dict[str, int] = {}  # numbers of pages, by the names that they have given themselves
        super().__init__(title=title, height=height)
        self.on_msg(self._hear)

    def _hear(self, _: object, content: dict[str, Any], buffers: Sequence[bytes | memoryview]) -> None:
        """A page says something. What does not fit the protocol the scene refuses in words."""
        page, kind = str(content.get("page", "")), content.get("kind")
        if kind == "html":
            self.send({"page": page, "kind": "html"}, [_core.hosted_page().encode()])
        elif kind == "open":
            self._forget(page)
            self._numbers[page] = self._pages.open(
                lambda message: self._say(page, message),
                lambda words: self.send({"page": page, "kind": "end", "text": words}),
            )
        elif kind == "close":
            self._forget(page)
        elif page in self._numbers:
            message = str(content.get("text", "")) if kind == "text" else b"".join(map(bytes, buffers))
            self._pages.receive(self._numbers[page], message)

    def _say(self, page: str, message: str | bytes) -> None:
        if isinstance(message, str):
            self.send({"page": page, "kind": "text", "text": message})
        else:
            self.send({"page": page, "kind": "bytes"}, [message])

    def _forget(self, page: str) -> None:
        if page in self._numbers:
            self._pages.close(self._numbers.pop(page))

    def close(self) -> None:
        """Its pages show the scene no more, and say so."""
        for page in list(self._numbers):
            self.send({"page": page, "kind": "end", "text": ENDED})
            self._forget(page)
        super().close()
