"""Simulations as functions of named arrays: what the layers for torch and JAX share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from resilin.differentiated import differentiated
from resilin.differentiated_batch import differentiated_batch

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from resilin.differentiated import Differentiated
    from resilin.differentiated_batch import DifferentiatedBatch
    from resilin.typing import Overrides, Scene

    Floats = NDArray[np.float64]


class ArrayRun:
    """A run by all of `values`, or one for each of their leading dimension.

    Its frames are those that the scene asks for: an elastic equilibrium does not depend on the load steps on the way
    to it, so cutbacks and the additional steps of prescribed rotations are left out.
    """

    def __init__(
        self, scene: Scene, values: Mapping[str, NDArray[Any]], overrides: Overrides, checkpoints: int, batch: bool
    ) -> None:
        self._batch: DifferentiatedBatch | None = None
        if batch:
            self._batch = differentiated_batch(scene, None, values, overrides, values, checkpoints)
            self._items: Sequence[Differentiated] = [self._batch[i] for i in range(len(self._batch))]
        else:
            self._items = [differentiated(scene, None, values, overrides, values, checkpoints)]

    @property
    def positions(self) -> Floats:
        """(T, N, d) or (B, T, N, d)."""
        each = np.array([item.asked_positions for item in self._items])
        return each if self._batch is not None else each[0]

    @property
    def num_steps_beside_way(self) -> int:
        """Number of load increments after cutbacks, where friction makes the load history matter."""
        return sum(item.num_steps_beside_way for item in self._items)

    def slopes(self, by_positions: NDArray[Any], shapes: Iterable[tuple[int, ...]]) -> list[Floats]:
        """Slopes by the arrays that the run was made at, in their own shapes, from those by `positions`."""
        gradients: Mapping[str, Any]
        if self._batch is None:
            gradients = self._items[0].vjp(self._items[0].seed_of_asked(by_positions))
        else:
            pairs = zip(self._items, by_positions, strict=True)
            gradients = self._batch.vjp([{"positions": item.seed_of_asked(one)} for item, one in pairs])
        return [
            np.array(gradient, dtype=np.float64).reshape(shape)
            for gradient, shape in zip(gradients.values(), shapes, strict=True)
        ]
