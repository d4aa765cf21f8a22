"""What runs and steps give: states as arrays, and the same for other packages and for notebooks."""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from resilin import _core, exchange, notebook
from resilin.arrays import file_path, plain_text
from resilin.picture import Picture, picture_options

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    import meshio
    import pandas as pd
    import pyvista as pv
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from resilin.typing import AnyPath, PictureOptions, Report, RunStatus, StepStatus

    Floats = NDArray[np.float64]


class Step(NamedTuple):
    """What became of one step; not converging is a result, not an error."""

    status: StepStatus  #: "converged" or "not_converged"
    reason: str  #: in words, when it did not converge
    newton_iterations: int
    residual: float  #: force residual relative to the forces that balance

    def __bool__(self) -> bool:
        """True when the step converged."""
        return self.status == "converged"


class Fields(Mapping[str, "Floats"]):
    """Fields of a result by name, computed when they are asked for; see docs/results.md."""

    def __init__(self, evaluate: Callable[[str], Floats]) -> None:
        self._evaluate = evaluate

    def __getitem__(self, name: str) -> Floats:
        return self._evaluate(plain_text(name, "fields"))

    def __iter__(self) -> Iterator[str]:
        return iter(_core.field_names())

    def __len__(self) -> int:
        return len(_core.field_names())

    def __contains__(self, name: object) -> bool:
        return name in _core.field_names()

    def __repr__(self) -> str:
        return f"<fields {', '.join(self)}>"


class Result:
    """The recorded frames of a run; T of them, the first is the start.

    Attributes
    ----------
    positions, velocities : array (T, N, d)
        [m], [m/s]; the vertices of all bodies, one body after another.
    times, loads : array (T,)
        [s]; load factors of a static run.
    fields : mapping
        By name, over the T frames: displacement, velocity (T, N, d); by cell von_mises, volume_ratio ... (T, M),
        principal_stress (T, M, 3), cauchy_stress, green_strain ... (T, M, 3, 3); the same smoothed onto the vertices as
        nodal_von_mises (T, N) ... `list(result.fields)` has all names, docs/results.md what they mean. Each access
        computes the field anew.
    report : dict
        As report.json: status, reason, frames with energies, probes and reactions, bodies, timing.
    """

    def __init__(self, core: _core.History) -> None:
        self._core = core
        self.positions: Floats = core.positions()
        self.velocities: Floats = core.velocities()
        self.times: Floats = core.times()
        self.loads: Floats = core.loads()
        self.fields: Fields = Fields(core.field)

    @functools.cached_property
    def report(self) -> Report:
        """As report.json; made when it is first asked for."""
        report: Report = json.loads(self._core.report())
        return report

    @property
    def status(self) -> RunStatus:
        """ "done", "not_converged", or "budget" when the run was stopped before its end."""
        return self.report["status"]

    def save(self, folder: AnyPath) -> None:
        """Writes the folder that `resilin run --out` leaves: report.json, frames.pvd, frames/, checkpoint.bin and, as
        output.formats asks, result.html and result.usda."""
        self._core.save(file_path(folder, "folder"))

    def plot(
        self, field: str | None = "averaged_von_mises", *, frame: int = -1, **options: Unpack[PictureOptions]
    ) -> Picture:
        """Draws the deformed body, coloured by a field; no display and no other package is needed.

        Parameters
        ----------
        field : str or None
            Any of `fields`, with a component where it has several: "displacement" (its length), "displacement.z",
            "cauchy_stress.xy", "principal_stress.1". "von_mises" has one colour in each cell, "averaged_von_mises" is
            the mean of the cells around each vertex, "nodal_von_mises" is smooth. The skin is drawn where a body has
            one, but for fields by cell.
        frame : int
            Number of the frame; -1 is the last.
        size : (int, int)
            Width and height in pixels; (1200, 900).
        view : str or (3,)
            "auto", "iso", "front", "back", "left", "right", "top", "bottom", or the direction from the body to the eye;
            auto shows as much as it can of the body and of how it has moved.
        up : str
            Axis that points up: "x", "y", "z", or "auto": against gravity, z where there is none.
        range : (float, float), optional
            Values at the ends of the colours; by default those of the field.
        map : str
            "viridis", "diverging", or "auto": diverging for fields of two signs.
        scale : float
            Factor on displacements; 1.
        edges : bool, optional
            Edges of the cells; by default where there is room.
        rest : bool
            The outline of the rest shape.
        colliders : bool
            What of the colliders is near the bodies; True.
        bar : bool
            The bar of the colours, with the field, its unit and its range; True.
        caption : bool
            Time, load factor or mode in the corner; True.
        dark : bool
            A dark background.
        transparent : bool
            No background, to be put on a bright one, with `dark` on a dark one.

        Returns
        -------
        Picture
            A notebook shows it; `.save("stress.png")` writes it, `.pixels` is an array.
        """
        return Picture(self._core.draw(int(frame), picture_options(field, **options)))

    @property
    def bodies(self) -> list[str]:
        """The names of the bodies, in their order."""
        return self._core.body_names()

    def cells(self, body: str | None = None) -> NDArray[np.int32]:
        """Vertices of the cells of a body (M, n), as rows of `positions`.

        n is 3 or 6 for triangles, 4 for quadrilaterals, 4 or 10 for tetrahedra and 8 for hexahedra: quadratic elements
        have a vertex in the middle of each edge, behind the corners and in the order of MSH.

        Parameters
        ----------
        body : str, optional
            Its name; may be left out where there is one body.
        """
        return self._core.cells(exchange.body_name(self._core, body))

    def vertices(self, body: str | None = None) -> slice:
        """The rows of `positions` that belong to a body, as a slice."""
        return slice(*self._core.vertex_range(exchange.body_name(self._core, body)))

    def to_meshio(self, frame: int = -1, fields: Sequence[str] = exchange.USUAL_FIELDS) -> meshio.Mesh:
        """A frame as a meshio.Mesh: the deformed cells with fields on vertices and cells, and the number of the body.

        Parameters
        ----------
        frame : int
            Its number; -1 is the last.
        fields : sequence of str
            Any of `fields`. Tensors have nine components, row by row.
        """
        return exchange.to_meshio(self._core, frame, fields)

    def to_pyvista(self, frame: int = -1, fields: Sequence[str] = exchange.USUAL_FIELDS) -> pv.UnstructuredGrid:
        """A frame as a pyvista.UnstructuredGrid, with what `to_meshio` has; the arguments are the same."""
        return exchange.to_pyvista(self._core, frame, fields)

    def to_dataframe(self) -> pd.DataFrame:
        """A table with a row for each frame: time, load, energies, momenta, probes, reactions, sections, extremes.

        The columns are named as in report.json, with points between: "energy.elastic", "probes.tip.displacement.z",
        "reactions.wall.x".
        """
        return exchange.to_dataframe(self.report)

    def _repr_html_(self) -> str:
        """The page with the motion, for notebooks: that of result.html, of as many frames as a few megabytes hold."""
        return notebook.html_of(self._core, len(self.times), repr(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._core,)

    def __repr__(self) -> str:
        return f"<resilin.Result {self.status}: {len(self.times)} frames; {self.report['reason']}>"
