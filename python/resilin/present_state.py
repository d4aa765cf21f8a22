"""Quantities of every object that has a present state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from resilin import _core as core
from resilin.arrays import plain_text
from resilin.picture import Picture, picture_options
from resilin.result import Fields

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from resilin.typing import PictureOptions

    Floats = NDArray[np.float64]

Core = TypeVar("Core", core.Simulation, core.LiveScene)


class PresentState(Generic[Core]):
    """Present state of all bodies and its fields."""

    _core: Core

    @property
    def positions(self) -> Floats:
        """Positions (N, d) [m], the vertices of all bodies, one body after another."""
        return self._core.positions()

    @property
    def velocities(self) -> Floats:
        """Velocities (N, d) [m/s]; zero in statics."""
        return self._core.velocities()

    @property
    def rest_positions(self) -> Floats:
        """Reference positions (N, d) [m]."""
        return self._core.rest_positions()

    def cells(self, body: str) -> NDArray[np.int32]:
        """Vertices of the cells of a body (M, n), as rows of `positions`; see `Result.cells`."""
        return self._core.cells(plain_text(body, "body"))

    def vertices(self, body: str) -> slice:
        """The rows of `positions` that belong to a body, as a slice."""
        return slice(*self._core.vertex_range(plain_text(body, "body")))

    @property
    def fields(self) -> Fields:
        """Fields of the present state by name, as in `Result` without the frame axis."""
        return Fields(lambda name: self._core.field(name)[0])

    def plot(self, field: str | None = "nodal_von_mises", **options: Unpack[PictureOptions]) -> Picture:
        """Draws the present state; see `Result.plot`."""
        return Picture(self._core.draw(picture_options(field, **options)))
