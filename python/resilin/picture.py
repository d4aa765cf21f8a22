"""Pictures of results, without a display and without other packages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from resilin import _core
from resilin.arrays import file_path, plain_text, refuse

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Literal

    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from resilin.typing import AnyPath, ColorMap, PictureOptions


class Picture:
    """A drawn result: a notebook shows it, `save` writes it.

    Attributes
    ----------
    pixels : array (height, width, 3) of uint8
        Red, green, blue, from the top left corner; for matplotlib's `imshow` and the like. (height, width, 4), with the
        opacity, of a transparent one.
    """

    def __init__(self, image: _core.Image) -> None:
        self._image = image

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """Colours (height, width, 3 or 4) of the picture, 0 to 255; the fourth is the opacity."""
        return self._image.pixels()

    def save(self, path: AnyPath) -> None:
        """Writes a PNG file.

        Parameters
        ----------
        path : path
            A name that ends in .png.
        """
        self._image.save(file_path(path, "path"))

    def _repr_png_(self) -> bytes:
        return self._image.png()

    def __repr__(self) -> str:
        height, width = self.pixels.shape[:2]
        return f"<resilin.Picture {width} x {height}>"


def picture(place: AnyPath, field: str | None = None, *, frame: int = -1, **options: Unpack[PictureOptions]) -> Picture:
    """Renders a frame of a result folder, as `resilin picture` does.

    Parameters
    ----------
    place : path
        Folder of a run, or a .vtu file.
    field : str, optional
        Any, with a component where it has several: "von_mises", "displacement.z", "cauchy_stress.xy";
        "nodal_von_mises" by default, as on the page; "none" for one colour per body. Missing fields are computed
        from the frames and the scene in the folder.
    frame : int
        Number of the frame; -1 is the last.
    **options
        See `Result.plot`.

    Returns
    -------
    Picture
    """
    return Picture(_core.draw_result(file_path(place, "place"), int(frame), picture_options(field, **options)))


def picture_options(
    field: str | None = None,
    *,
    size: Sequence[float] = (1200, 900),
    view: str | Sequence[float] = "auto",
    up: Literal["auto", "x", "y", "z"] = "auto",
    range: Sequence[float] | None = None,
    map: ColorMap = "auto",
    scale: float = 1,
    edges: bool | None = None,
    rest: bool = False,
    colliders: bool = True,
    bar: bool = True,
    caption: bool = True,
    dark: bool = False,
    transparent: bool = False,
) -> _core.PictureOptions:
    """Options of `Result.plot` in the form of the core."""
    options = _core.PictureOptions()
    if field is not None and not isinstance(field, str):
        refuse("field", "the name of a field", repr(field))
    options.field = plain_text(field or "", "field")
    if np.shape(size) != (2,):
        refuse("size", "two numbers (width, height)", repr(size))
    options.width, options.height = (int(number) for number in size)
    if range is not None:
        if np.shape(range) != (2,):
            refuse("range", "two numbers (smallest, largest)", repr(range))
        options.range = [float(number) for number in range]
    direction = view if isinstance(view, str) else ",".join(repr(float(number)) for number in view)
    options.view = plain_text(direction, "view")
    options.up, options.map, options.scale = plain_text(up, "up"), plain_text(map, "map"), float(scale)
    options.edges = "auto" if edges is None else "on" if edges else "off"
    options.rest, options.colliders, options.dark = bool(rest), bool(colliders), bool(dark)
    options.bar, options.caption, options.transparent = bool(bar), bool(caption), bool(transparent)
    return options
