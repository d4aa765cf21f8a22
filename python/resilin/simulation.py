"""Simulations of scenes: step by step, or to the end with all results as arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, NoReturn

import numpy as np

from resilin import _core
from resilin.arrays import file_path, plain_text, refuse, require_instance
from resilin.live import LiveScene
from resilin.material import Material
from resilin.mesh import warn
from resilin.present_state import PresentState
from resilin.result import Result, Step
from resilin.scene import material_entries, read_scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin.typing import (
        AnyPath,
        BodyReport,
        FixReport,
        FrameReport,
        LoadReport,
        Overrides,
        Scene,
    )
    from resilin.widget import LiveView

    Floats = NDArray[np.float64]


class Simulation(PresentState[_core.Simulation]):
    """A simulation, advanced step by step.

    Parameters
    ----------
    scene : path or dict
        A scene file, or the same keys as a dict; see docs/scene.md. A dict may hold arrays and `Mesh` objects.
    overrides : dict or list of str
        Changes to the scene, as after `--set`: {"newton.tolerance": 1e-6}.

    Raises
    ------
    InputError
        With the line of the command line: where, what was expected, what was found, what to do.

    Examples
    --------
    >>> simulation = resilin.Simulation("beam.toml")
    >>> while not simulation.is_finished:
    ...     simulation.step()
    >>> simulation.positions
    """

    def __init__(self, scene: Scene, overrides: Overrides = ()) -> None:
        self._core = _core.Simulation(read_scene(scene, overrides))
        self._played: LiveScene | None = None
        warn(self._core.warnings)

    def step(self) -> Step:
        """Takes one time step, or the largest load increment that converges.

        Ctrl-C raises KeyboardInterrupt and leaves the state before the step.

        Returns
        -------
        Step
            True as a condition if it converged.
        """
        step = Step(*self._core.step())
        self._wake_pages()
        return step

    def run(
        self,
        out: AnyPath | None = None,
        *,
        resume: bool | Literal["anyway"] = False,
        steps: int | None = None,
        progress: bool | None = None,
    ) -> Result:
        """Runs to the end and records every `output.every`-th step.

        Ctrl-C raises KeyboardInterrupt; the simulation keeps the last whole step, `out` everything up to it.

        Parameters
        ----------
        out : path, optional
            Folder for the files that `resilin run` writes.
        resume : bool or "anyway"
            Restarts from the checkpoint in `out`, which must belong to the same scene unless "anyway".
        steps : int, optional
            Stops after so many steps.
        progress : bool, optional
            Whether to show a progress line; by default in a terminal and in a notebook.

        Returns
        -------
        Result
        """
        from resilin.progress import Progress

        if steps is not None and (not isinstance(steps, int | np.integer) or steps < 1):
            refuse("steps", "a whole number of at least 1", repr(steps))
        if not (isinstance(resume, bool | np.bool_) or resume == "anyway"):
            refuse("resume", 'True, False or "anyway"', repr(resume))
        if resume and out is None:
            refuse("resume", "a folder `out` with a checkpoint", "no folder")
        line = Progress(self._core, progress)
        try:
            folder = None if out is None else file_path(out, "out")
            how = None if not resume else "anyway" if resume == "anyway" else "same"
            result = Result(self._core.run(folder, how, int(steps or 0), line.after_step))
        finally:
            line.end()
            self._wake_pages()
        warn(result._core.warnings()[len(self._core.warnings) :])
        return result

    def set_material(self, body: str, material: Material, density: float | None = None) -> None:
        """Replaces the material of a body; the simulation continues from the present state.

        Parameters
        ----------
        body : str
            Its name in the scene.
        material : Material
            Its constants may be arrays (M,) and its fibres (M, families, 3), one value for each cell. Fibres refer to
            the axes of the mesh and rotate with the body's `rotate`.
        density : float, optional
            [kg/m^3]; unchanged by default.
        """
        require_instance(material, Material, "material")
        entries = material_entries(material)
        law, fibres = entries.pop("law"), entries.pop("fibres", [])
        uniform = {name: float(value) for name, value in entries.items() if np.ndim(value) == 0}
        by_cell = {name: np.asarray(value).tolist() for name, value in entries.items() if np.ndim(value)}
        fibres = [np.ascontiguousarray(np.atleast_2d(family)) for family in fibres]
        self._core.set_material(
            plain_text(body, "body"), law, uniform, by_cell, fibres, None if density is None else float(density)
        )
        if self._played is not None:
            self._played._pages.end("A body has another material now; call view() again.")
            self._played = None

    def view(self, height: int = 560) -> LiveView:
        """Interactive page of the bodies as a notebook widget.

        The page starts with the present state under the full loads and runs in real time while it is visible. Bodies
        moved on the page are moved here too: `positions`, `velocities` and `fields` follow, and `step` continues from
        there, at the time and load factor of this simulation. After a step or a run the page shows its result and
        pauses.

        Parameters
        ----------
        height : int
            [px]

        Returns
        -------
        LiveView
            A widget, displayed at the end of a cell; needs anywidget (`resilin[notebook]`).
        """
        if self._played is None:
            self._played = LiveScene._of(self._core.play())
        return self._played.view(height)

    def _wake_pages(self) -> None:
        if self._played is not None:
            self._played._pages.wake()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._core.time

    @property
    def load(self) -> float:
        """Load factor of a static run; 1 in dynamics."""
        return self._core.load

    @property
    def is_finished(self) -> bool:
        """Whether the end time or the full load is reached."""
        return self._core.is_finished

    @property
    def frame(self) -> FrameReport:
        """Entry of the present state in report.json: energies, momenta, probes, reactions."""
        frame: FrameReport = json.loads(self._core.frame())
        return frame

    @property
    def bodies(self) -> list[BodyReport]:
        """Entries of the bodies in report.json."""
        bodies: list[BodyReport] = json.loads(self._core.bodies())
        return bodies

    @property
    def fixes(self) -> list[FixReport]:
        """Selection of each [[fix]], as in report.json: nodes, facets, area [m^2], centre [m]."""
        fixes: list[FixReport] = json.loads(self._core.fixes())
        return fixes

    @property
    def loads(self) -> list[LoadReport]:
        """Selection of each [[load]] and of gravity, as in report.json.

        `force` [N] and `moment` about `center` [N m] are those at load factor 1 on the reference configuration. Look at
        them before a run: a selection may have caught more than was meant.
        """
        loads: list[LoadReport] = json.loads(self._core.loads())
        return loads

    def skin_positions(self, body: str) -> Floats:
        """Present positions of the embedded surface (skin) of a body.

        Parameters
        ----------
        body : str
            Its name.

        Returns
        -------
        array (V, 3)
            [m]; in 2D the third column is zero.

        Raises
        ------
        InputError
            For a body without the key `skin`.
        """
        return self._core.skin_positions(plain_text(body, "body"))

    def skin_triangles(self, body: str) -> NDArray[np.int32]:
        """Triangles of the embedded surface (skin) of a body.

        Parameters
        ----------
        body : str
            Its name.

        Returns
        -------
        array (T, 3) of int32
            Rows of `skin_positions`; for a curve in 2D its lines (T, 2).
        """
        return self._core.skin_facets(plain_text(body, "body"))

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Simulation cannot be pickled; pickle its scene, or the Result of a run")

    def __repr__(self) -> str:
        title = f" {self._core.title}" if self._core.title else ""
        return f"<resilin.Simulation{title}: {self._core.reached()}>"


def run(
    scene: Scene,
    out: AnyPath | None = None,
    *,
    overrides: Overrides = (),
    resume: bool | Literal["anyway"] = False,
    steps: int | None = None,
    progress: bool | None = None,
) -> Result:
    """Simulates a scene to its end.

    Parameters
    ----------
    scene : path or dict
        Scene file (TOML), or its contents; see `Simulation`.
    out : path, optional
        Folder for the files that `resilin run` writes.
    overrides : dict or list of "KEY=VALUE"
        Changes of the scene, such as {"newton.tolerance": 1e-6}.
    resume, steps, progress
        As for `Simulation.run`.

    Returns
    -------
    Result

    Examples
    --------
    >>> result = resilin.run("beam.toml", overrides={"body.beam.material.youngs_modulus": 1e6})
    >>> result.report["frames"][-1]["probes"]["tip"]["displacement"]
    """
    if isinstance(out, Mapping):
        refuse("out", "a folder for the results", "a dict", "changes of the scene are given as overrides={...}")
    return Simulation(scene, overrides).run(out, resume=resume, steps=steps, progress=progress)
