"""Results of runs and steps: states as arrays, also for other packages and notebooks."""

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
    """Outcome of one step; not converging is a result, not an error."""

    status: StepStatus  #: "converged" or "not_converged"
    reason: str  #: in words, when it did not converge
    newton_iterations: int
    residual: float  #: force residual relative to the forces that balance

    def __bool__(self) -> bool:
        """True when the step converged."""
        return self.status == "converged"


class Fields(Mapping[str, "Floats"]):
    """Fields of a result by name, computed on request; see docs/results.md."""

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
    """The T recorded frames of a run; the first is the start.

    Attributes
    ----------
    positions, velocities : array (T, N, d)
        [m], [m/s]; the vertices of all bodies, one body after another.
    times, loads : array (T,)
        [s]; load factors of a static run.
    fields : mapping
        By name, over the T frames: displacement, velocity (T, N, d); by cell von_mises, volume_ratio ... (T, M),
        principal_stress (T, M, 3), cauchy_stress, green_strain ... (T, M, 3, 3); their L2 projection onto the vertices
        is nodal_von_mises (T, N) ... `list(result.fields)` has all names, docs/results.md explains them. Each access
        recomputes the field.
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
        """The content of report.json; computed on first access."""
        report: Report = json.loads(self._core.report())
        return report

    @property
    def status(self) -> RunStatus:
        """ "done", "not_converged", or "budget" if the run was stopped before its end."""
        return self.report["status"]

    def save(self, folder: AnyPath) -> None:
        """Writes the folder of `resilin run --out`: report.json, frames.pvd, frames/, checkpoint.bin and, by
        output.formats, result.html and result.usda.

        Parameters
        ----------
        folder : path
            Made if it does not exist.
        """
        self._core.save(file_path(folder, "folder"))

    def plot(
        self, field: str | None = "nodal_von_mises", *, frame: int = -1, **options: Unpack[PictureOptions]
    ) -> Picture:
        """Renders the deformed body, coloured by a field; needs no display and no other package.

        Parameters
        ----------
        field : str or None
            Any of `fields`, with a component where it has several: "displacement" (its length), "displacement.z",
            "cauchy_stress.xy", "principal_stress.1". "von_mises" has one colour in each cell, "averaged_von_mises" is
            the mean of the cells around each vertex, "nodal_von_mises" is smooth. A body with a skin is drawn by its
            skin, except for cell fields.
        frame : int
            Number of the frame; -1 is the last.
        size : (int, int)
            Width and height in pixels; (1200, 900).
        view : str or (3,)
            "auto", "iso", "front", "back", "left", "right", "top", "bottom", or the direction from the body to the eye;
            auto shows most of the body and of its motion.
        up : str
            Axis that points up: "x", "y", "z", or "auto": against gravity, z where there is none.
        range : (float, float), optional
            Limits of the colour bar; by default those of the field.
        map : str
            "viridis", "diverging", or "auto": diverging for fields of two signs.
        scale : float
            Displacement magnification; 1.
        edges : bool, optional
            Whether to draw cell edges; by default if they are large enough.
        rest : bool
            Whether to draw the outline of the reference configuration.
        colliders : bool
            Whether to draw colliders near the bodies; True.
        bar : bool
            Whether to draw the colour bar with field, unit and range; True.
        caption : bool
            Whether to print time, load factor or mode in the corner; True.
        dark : bool
            A dark background.
        transparent : bool
            A transparent background, for bright pages, with `dark` for dark ones.

        Returns
        -------
        Picture
            Notebooks display it; `.save("stress.png")` writes it, `.pixels` is an array.
        """
        return Picture(self._core.draw(int(frame), picture_options(field, **options)))

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies, in order."""
        return self._core.body_names()

    def cells(self, body: str | None = None) -> NDArray[np.int32]:
        """Vertices of the cells of a body (M, n), as rows of `positions`.

        n is 3 or 6 for triangles, 4 for quadrilaterals, 4 or 10 for tetrahedra and 8 for hexahedra: quadratic elements
        have a vertex in the middle of each edge, behind the corners and in the order of MSH.

        Parameters
        ----------
        body : str, optional
            Its name; may be left out if there is one body.

        Returns
        -------
        array (M, n) of int32
        """
        return self._core.cells(exchange.body_name(self._core, body))

    def vertices(self, body: str | None = None) -> slice:
        """Rows of `positions` that belong to a body.

        Parameters
        ----------
        body : str, optional
            Its name; may be left out if there is one body.

        Returns
        -------
        slice
        """
        return slice(*self._core.vertex_range(exchange.body_name(self._core, body)))

    def to_meshio(self, frame: int = -1, fields: Sequence[str] = exchange.USUAL_FIELDS) -> meshio.Mesh:
        """Converts a frame to a meshio.Mesh: deformed cells, vertex and cell fields, and body numbers.

        Parameters
        ----------
        frame : int
            Its number; -1 is the last.
        fields : sequence of str
            Any of `fields`. Tensors have nine components, row by row.

        Returns
        -------
        meshio.Mesh
            Positions in metres, fields in SI units.
        """
        return exchange.to_meshio(self._core, frame, fields)

    def to_pyvista(self, frame: int = -1, fields: Sequence[str] = exchange.USUAL_FIELDS) -> pv.UnstructuredGrid:
        """Converts a frame to a pyvista.UnstructuredGrid.

        Parameters
        ----------
        frame : int
            Number of the frame; -1 is the last.
        fields : list of str
            Names of fields, as for `to_meshio`.

        Returns
        -------
        pyvista.UnstructuredGrid
            Positions in metres, fields in SI units.
        """
        return exchange.to_pyvista(self._core, frame, fields)

    def to_dataframe(self) -> pd.DataFrame:
        """Returns a pandas table with a row for each frame: time, load, energies, momenta, probes, reactions, sections,
        extremes.

        The columns are named as in report.json, joined by points: "energy.elastic", "probes.tip.displacement.z",
        "reactions.wall.x".

        Returns
        -------
        pandas.DataFrame
            Units are those of report.json (docs/results.md).
        """
        return exchange.to_dataframe(self.report)

    def _repr_html_(self) -> str:
        """The page with the motion, for notebooks: that of result.html, of as many frames as a few megabytes hold."""
        return notebook.html_of(self._core, len(self.times), repr(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._core,)

    def __repr__(self) -> str:
        return f"<resilin.Result {self.status}: {len(self.times)} frames; {self.report['reason']}>"
