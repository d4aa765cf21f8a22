"""Runs of one scene with several parameter sets, differentiated in parallel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import describe, real_array, refuse
from resilin.differentiated import Differentiated, checked_checkpoints, joined_by_frame, names_of
from resilin.mesh import warn
from resilin.objective import Seeds
from resilin.scene import read_scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin.differentiated import Numbers, Objective
    from resilin.objective import FrameChange, FrameSlopes
    from resilin.typing import Overrides, RealArray, Scene

    Floats = NDArray[np.float64]


class DifferentiatedBatch:
    """Runs of one scene with B parameter sets, an objective and their derivatives.

    `value, gradients = batch` unpacks it; `batch[i]` is the `Differentiated` of one set, `len(batch)` is B.

    Attributes
    ----------
    value : array (B,) or None
        Objective of each set; None without one.
    gradients : dict
        Gradients by parameter name, with a leading dimension B.
    parameters : dict
        Parameter values, likewise.
    positions : array (B, T, N, d)
        [m], if all runs have the same number of frames.
    """

    def __init__(self, runs: Sequence[_core.DifferentiatedRun], objective: Objective | None) -> None:
        self._runs = list(runs)
        self._items = [Differentiated(run, objective) for run in runs]
        self.value: Floats | None = None
        self.gradients: dict[str, Floats] = {}
        if objective is not None:
            self.value = np.array([item.value for item in self._items])
            each = self._transposed([item._slopes() for item in self._items])
            for item, gradients in zip(self._items, each, strict=True):
                item.gradients = gradients
            self.gradients = _stacked(each)

    def __len__(self) -> int:
        return len(self._items)

    def __getitem__(self, number: int) -> Differentiated:
        return self._items[number]

    def __iter__(self) -> Iterator[Any]:
        return iter((self.value, self.gradients))

    @property
    def parameters(self) -> dict[str, Floats]:
        """Parameter values by name, with the B sets along the first axis."""
        return _stacked([item.parameters for item in self._items])

    @property
    def positions(self) -> Floats:
        """Positions of all frames (B, T, N, d) [m].

        Raises
        ------
        ValueError
            When runs differ in their number of frames, because of cutbacks.
        """
        counts = {run.num_frames for run in self._runs}
        if len(counts) > 1:
            refuse(
                "positions",
                "runs of as many frames each",
                "from " + " to ".join(str(count) for count in (min(counts), max(counts))),
                "load steps were halved (cutback): use more simulation.load_steps, or batch[i].positions",
            )
        return np.array([item.positions for item in self._items])

    def vjp(self, seed: RealArray | Sequence[Mapping[str, Any]]) -> dict[str, Floats]:
        """`Differentiated.vjp` of each set.

        Parameters
        ----------
        seed : array or sequence
            Derivatives by `positions` (B, T, N, d), or (B, N, d) for the last frame; or B seeds of
            `Differentiated.vjp`.

        Returns
        -------
        dict
            As `gradients`.
        """
        seeds = list(seed) if isinstance(seed, Sequence) else list(np.asarray(real_array(seed, "seed")))
        self._check_count(len(seeds), "seed")
        return _stacked(
            self._transposed([Seeds(one, run).slopes() for one, run in zip(seeds, self._runs, strict=True)])
        )

    def jvp(self, direction: Mapping[str, RealArray]) -> dict[str, Any]:
        """`Differentiated.jvp` of each set.

        Parameters
        ----------
        direction : dict
            Changes by parameter name, with a leading dimension B; others are zero.

        Returns
        -------
        dict
            As `Differentiated.jvp`, all arrays with a leading dimension B.
        """
        frames = self._forward(direction)
        each = [item._changes_of_results(of) for item, of in zip(self._items, frames, strict=True)]
        return {
            key: {name: np.array([one[key][name] for one in each]) for name in each[0][key]}
            if isinstance(each[0][key], dict)
            else np.array([one[key] for one in each])
            for key in each[0]
        }

    def gauss_newton_product(self, direction: Mapping[str, RealArray]) -> dict[str, Floats]:
        """`Differentiated.gauss_newton_product` of each set.

        Parameters
        ----------
        direction : dict
            The vectors v by parameter name, with a leading dimension B.

        Returns
        -------
        dict
            As `gradients`.
        """
        sums = [item._sum() for item in self._items]
        frames = self._forward(direction)
        slopes = [of.slopes_of_residuals(of.change_of_residuals(f)) for of, f in zip(sums, frames, strict=True)]
        return _stacked(self._transposed(slopes))

    @property
    def residuals(self) -> Floats:
        """(B, R): `Differentiated.residuals` of each set."""
        return np.array([item.residuals for item in self._items])

    def _transposed(self, slopes: Sequence[Sequence[FrameSlopes]]) -> list[dict[str, Numbers]]:
        before = [len(run.warnings) for run in self._runs]
        found = _core.transposed_all(self._runs, [joined_by_frame(of) for of in slopes])
        for run, count in zip(self._runs, before, strict=True):
            warn(run.warnings[count:])
        return [item._by_names(of, by) for item, of, by in zip(self._items, found, slopes, strict=True)]

    def _forward(self, direction: Mapping[str, RealArray]) -> list[list[FrameChange]]:
        arrays = {name: np.asarray(real_array(array, f"direction.{name}")) for name, array in direction.items()}
        for name, array in arrays.items():
            self._check_count(len(array) if array.ndim > 0 else 0, f"direction.{name}")
        changes = [
            item._changes({name: array[i] for name, array in arrays.items()}) for i, item in enumerate(self._items)
        ]
        found = _core.forward_all(self._runs, changes)
        return [[(*frame, of) for frame in frames] for frames, of in zip(found, changes, strict=True)]

    def _check_count(self, count: int, place: str) -> None:
        if count != len(self._items):
            refuse(place, f"{len(self._items)} of the batch, one after another", str(count))

    def __repr__(self) -> str:
        return f"<resilin.DifferentiatedBatch of {len(self._items)}: by {', '.join(self._items[0].parameters)}>"


def _stacked(each: Sequence[Mapping[str, Numbers]]) -> dict[str, Floats]:
    return {name: np.array([one[name] for one in each]) for name in each[0]}


def differentiated_batch(
    scene: Scene,
    objective: Objective | None,
    wrt: Iterable[str],
    overrides: Overrides,
    values: Mapping[str, RealArray],
    checkpoints: int = 0,
) -> DifferentiatedBatch:
    """Runs a scene with each of B sets of numbers, arrays with a leading dimension B."""
    arrays = {name: np.asarray(real_array(value, name), dtype=np.float64) for name, value in values.items()}
    counts = {name: len(array) if array.ndim > 0 else 0 for name, array in arrays.items()}
    if not counts:
        refuse("values", "numbers by the names of parameters", "none", "a batch has a leading dimension of these")
    size = max(counts.values())
    for name, count in counts.items():
        if count != size or size == 0:
            got = describe(arrays[name].shape)
            refuse(name, f"an array with the batch as its leading dimension, ({max(size, 1)}, ...)", got)
    numbers = [{name: np.ascontiguousarray(array[i]).ravel() for name, array in arrays.items()} for i in range(size)]
    handle = read_scene(scene, overrides)
    runs = _core.differentiated_runs(handle, names_of(wrt), numbers, checked_checkpoints(checkpoints))
    return DifferentiatedBatch(runs, objective)
