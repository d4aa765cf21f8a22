"""A result in a notebook: its animated page, which needs no other file and no network."""

from __future__ import annotations

import base64
import html
import tempfile
from typing import TYPE_CHECKING

import numpy as np

from resilin.picture import picture_options

if TYPE_CHECKING:
    from resilin import _core

MOST_BYTES = 3_000_000  # most bytes of a page; a notebook keeps each that it shows
HEIGHT = 560  # [px]


def page_of(core: _core.History, count: int, most_bytes: int = MOST_BYTES) -> str | None:
    """The page, with fewer frames where all would be too many; None where not even two fit."""
    with tempfile.TemporaryDirectory() as folder:
        frames = np.arange(count)
        while True:
            page = core.page(folder, frames.tolist())
            if len(page) <= most_bytes:
                return page
            if len(frames) <= 2:
                return None
            # Part of a page is there whatever the frames; to halve them at least comes to an end.
            share = min(0.5, most_bytes / len(page))
            frames = np.unique(np.linspace(0, count - 1, max(2, int(share * len(frames)))).astype(int))


def html_of(core: _core.History, count: int, words: str) -> str:
    """The page in a frame of its own, or a picture where it would be too large."""
    page = page_of(core, count)
    if page is not None:
        return (
            f'<iframe srcdoc="{html.escape(page)}" sandbox="allow-scripts allow-downloads" '
            f'title="{html.escape(words)}" style="width: 100%; height: {HEIGHT}px; border: 0"></iframe>'
        )
    image = core.draw(-1, picture_options("nodal_von_mises", size=(900, 675))).png()
    return (
        f'<img src="data:image/png;base64,{base64.b64encode(image).decode()}" alt="{html.escape(words)}">'
        "<p>The result is too large for a notebook; save it, and <code>resilin view</code> shows the folder.</p>"
    )
