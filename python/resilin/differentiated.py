"""A differentiated run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import plain_text, real_array, refuse
from resilin.mesh import warn
from resilin.objective import Function, Outcome, Seeds, Sum
from resilin.scene import read_scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin.objective import FrameChange, FrameSlopes
    from resilin.typing import Overrides, RealArray, Scene

    Floats = NDArray[np.float64]
    #: terms by kind, or a function of the outcome that gives a value and its slopes
    Objective = Mapping[str, Any] | Callable[[Outcome], tuple[float, Any]]
    Numbers = float | Floats
    #: frame, slopes by its positions, velocities and reactions
    FrameArrays = tuple[int, Floats | None, Floats | None, Floats | None]


def names_of(wrt: Iterable[str]) -> list[str]:
    """Each once."""
    given = [wrt] if isinstance(wrt, str) else wrt
    return list(dict.fromkeys(plain_text(name, "wrt") for name in given))


def flat_numbers(value: RealArray, place: str) -> Floats:
    return np.ascontiguousarray(np.ravel(np.asarray(real_array(value, place), dtype=np.float64)))


def checked_checkpoints(checkpoints: int) -> int:
    if checkpoints < 0:
        refuse("checkpoints", "a number of at least 0", str(checkpoints))
    return int(checkpoints)


def joined_by_frame(slopes: Sequence[FrameSlopes]) -> list[FrameArrays]:
    """One entry for each frame."""
    frames: dict[int, list[Floats | None]] = {}
    for of in slopes:
        kept = frames.setdefault(of.frame, [None, None, None])
        for i, part in enumerate((of.positions, of.velocities, of.reactions)):
            if part is not None:
                before = kept[i]
                kept[i] = part if before is None else before + part
    return [(frame, kept[0], kept[1], kept[2]) for frame, kept in sorted(frames.items())]


def differentiated(
    scene: Scene,
    objective: Objective | None,
    wrt: Iterable[str],
    overrides: Overrides = (),
    values: Mapping[str, RealArray] | None = None,
    checkpoints: int = 0,
) -> Differentiated:
    """Runs a scene with other numbers by the names of parameters."""
    numbers = {name: flat_numbers(value, name) for name, value in (values or {}).items()}
    handle = read_scene(scene, overrides)
    run = _core.DifferentiatedRun(handle, names_of(wrt), numbers, checked_checkpoints(checkpoints))
    made = Differentiated(run, objective)
    if objective is not None:
        made.gradients = made._transposed(made._slopes())
    return made


class Differentiated:
    """A run, an objective and their derivatives; `value, gradients = differentiated` unpacks it.

    Attributes
    ----------
    value : float or None
        Value of the objective; None without one.
    gradients : dict
        Gradients by parameter name: a number, an array (M,) by cell, (V, d) by vertex, or (d,) for a vector.
    parameters : dict
        Parameter values of the scene, in the same shapes.
    positions : array (T, N, d)
        [m]; frame 0 is the start; the others are equilibria of load increments or ends of time steps.
    """

    def __init__(self, run: _core.DifferentiatedRun, objective: Objective | None) -> None:
        self._run = run
        warn(run.warnings)
        self._shapes: dict[str, tuple[int, ...]] = {}
        self.parameters: dict[str, Numbers] = {}
        for name, shape, value in run.parameters():
            self._shapes[name] = tuple(shape)
            self.parameters[name] = self._shaped(name, value)
        self._objective: Sum | Function | None = None
        if callable(objective):
            self._objective = Function(objective, self.outcome, self._run)
        elif isinstance(objective, Mapping):
            self._objective = Sum(objective, self._run)
        elif objective is not None:
            refuse("objective", "a dict of terms or a function", type(objective).__name__)
        self.value = None if self._objective is None else self._objective.value
        self.gradients: dict[str, Numbers] = {}

    def __iter__(self) -> Iterator[Any]:
        return iter((self.value, self.gradients))

    @property
    def positions(self) -> Floats:
        """Positions of all frames of the run (T, N, d) [m], load increments after cutbacks included."""
        return np.array([self._run.positions(frame) for frame in range(self._run.num_frames)])

    @property
    def asked_positions(self) -> Floats:
        """Positions at the frames of the scene [m]: the load factors k / load_steps, or all time steps."""
        return np.array([self._run.positions(frame) for frame in self._run.asked_frames])

    @property
    def num_steps_beside_way(self) -> int:
        """Load increments with cutbacks where the load history matters (friction)."""
        return self._run.num_steps_beside_way

    def seed_of_asked(self, by_positions: NDArray[Any]) -> Floats:
        """Derivatives by `positions` from derivatives by `asked_positions`.

        Parameters
        ----------
        by_positions : array (frames of the scene, N, d)
            Derivatives of a scalar by `asked_positions`.

        Returns
        -------
        array (T, N, d)
            Argument of `vjp`.
        """
        frames = self._run.asked_frames
        seed = np.zeros((self._run.num_frames, *by_positions.shape[1:]))
        seed[frames] = by_positions
        return seed

    @property
    def outcome(self) -> Outcome:
        """The argument of an objective function."""
        frames = range(self._run.num_frames)
        clock = np.array([self._run.time_and_load(frame) for frame in frames])
        forces = np.array([self._run.reactions(frame) for frame in frames])
        names = self._run.supports()
        reactions = {name: forces[:, i] for i, name in enumerate(names)}
        speeds = [self._run.velocities(frame) for frame in frames]
        moving = [of_frame for of_frame in speeds if of_frame is not None]
        return Outcome(self.positions, clock[:, 0], clock[:, 1], reactions, np.array(moving) if moving else None)

    def vjp(self, seed: RealArray | Mapping[str, Any]) -> dict[str, Numbers]:
        """Vector-Jacobian product: the gradient of a scalar with known derivatives by the results.

        Parameters
        ----------
        seed : array or dict
            Derivatives by `positions` (T, N, d), or (N, d) for the last frame; or a dict with "positions", "velocities"
            and "reactions" ({boundary condition: (T, 3)}).

        Returns
        -------
        dict
            As `gradients`.
        """
        return self._transposed(Seeds(seed, self._run).slopes())

    def jvp(self, direction: Mapping[str, RealArray]) -> dict[str, Any]:
        """Jacobian-vector product: first-order change of the results with the parameters.

        Parameters
        ----------
        direction : dict
            Changes by parameter name; others are zero.

        Returns
        -------
        dict
            "positions" (T, N, d), "velocities" in dynamics, "reactions" {boundary condition: (T, 3)}, and for an
            objective of terms "value" and "residuals".
        """
        return self._changes_of_results(self._forward(direction))

    def _changes_of_results(self, frames: Sequence[FrameChange]) -> dict[str, Any]:
        names = self._run.supports()
        forces = np.array([frame[2] for frame in frames])
        changes: dict[str, Any] = {
            "positions": np.array([frame[0] for frame in frames]),
            "reactions": {name: forces[:, i] for i, name in enumerate(names)},
        }
        if frames[0][1] is not None:
            changes["velocities"] = np.array([frame[1] for frame in frames])
        if isinstance(self._objective, Sum):
            changes["residuals"] = self._objective.change_of_residuals(frames)
            changes["value"] = self._objective.change(frames)
        return changes

    def gauss_newton_product(self, direction: Mapping[str, RealArray]) -> dict[str, Numbers]:
        """Gauss-Newton product J^T J v for an objective 1/2 |r|^2 with residuals r.

        J is the derivative of r by the parameters. It needs one tangent and one adjoint product.

        Parameters
        ----------
        direction : dict
            The vector v, by parameter name; others are zero.

        Returns
        -------
        dict
            As `gradients`.
        """
        terms = self._sum()
        change = terms.change_of_residuals(self._forward(direction))
        return self._transposed(terms.slopes_of_residuals(change))

    @property
    def residuals(self) -> Floats:
        """(y - target) / sigma of all terms with a target, one after another."""
        return self._sum().residuals

    def _sum(self) -> Sum:
        if not isinstance(self._objective, Sum):
            refuse("objective", "a dict of terms with targets", "a function" if self._objective else "none")
        return self._objective

    def _slopes(self) -> list[FrameSlopes]:
        """Derivatives of the objective by the positions of its frames."""
        return [] if self._objective is None else self._objective.slopes()

    def _shaped(self, name: str, values: Floats) -> Numbers:
        shape = self._shapes[name]
        return float(values[0]) if shape == () else values.reshape(shape)

    def _transposed(self, slopes: Sequence[FrameSlopes]) -> dict[str, Numbers]:
        num_warnings = len(self._run.warnings)
        found = self._run.transposed(joined_by_frame(slopes))
        warn(self._run.warnings[num_warnings:])
        return self._by_names(found, slopes)

    def _by_names(self, found: Sequence[Floats], slopes: Sequence[FrameSlopes]) -> dict[str, Numbers]:
        """Slopes by the parameters through what comes out, and those that a result has by itself."""
        for of in slopes:
            for values, direct in zip(found, of.parameters or (), strict=of.parameters is not None):
                values += direct
        return {name: self._shaped(name, values) for name, values in zip(self._shapes, found, strict=True)}

    def _forward(self, direction: Mapping[str, RealArray]) -> list[FrameChange]:
        changes = self._changes(direction)
        return [(*frame, changes) for frame in self._run.forward(changes)]

    def _changes(self, direction: Mapping[str, RealArray]) -> list[Floats]:
        """Change of each parameter, flat; zero for those that are left out."""
        for name in direction:
            if name not in self._shapes:
                refuse(f"direction.{name}", "one of " + ", ".join(self._shapes), "a name that is not in wrt")
        changes: list[Floats] = []
        for name, shape in self._shapes.items():
            array = np.asarray(real_array(direction.get(name, 0.0), f"direction.{name}"), dtype=np.float64)
            if array.ndim > 0 and array.shape != shape:
                refuse(f"direction.{name}", f"an array {shape}", str(array.shape))
            changes.append(np.ascontiguousarray(np.broadcast_to(array, shape)).ravel())
        return changes

    def __repr__(self) -> str:
        return f"<resilin.Differentiated {self.value}: by {', '.join(self._shapes)}>"
