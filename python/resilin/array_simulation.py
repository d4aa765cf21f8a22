"""Simulations as functions of named arrays: what the layers for torch and JAX share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from resilin.differentiated import Differentiated, differentiated
from resilin.differentiated_batch import DifferentiatedBatch, differentiated_batch

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from resilin.typing import Overrides, Scene

    Floats = NDArray[np.float64]
    ArrayRun: TypeAlias = Differentiated | DifferentiatedBatch


def run_at_arrays(
    scene: Scene, values: Mapping[str, NDArray[Any]], overrides: Overrides, checkpoints: int, batch: bool
) -> ArrayRun:
    """A run by all of `values`, or one for each of their leading dimension."""
    if batch:
        return differentiated_batch(scene, None, values, overrides, values, checkpoints)
    return differentiated(scene, None, values, overrides, values, checkpoints)


def slopes_in_shapes(run: ArrayRun, by_positions: NDArray[Any], shapes: Iterable[tuple[int, ...]]) -> list[Floats]:
    """Slopes by the arrays that the run was made at, in their own shapes, from those by `run.positions`."""
    gradients = run.vjp(np.ascontiguousarray(by_positions))
    return [
        np.array(gradient, dtype=np.float64).reshape(shape)
        for gradient, shape in zip(gradients.values(), shapes, strict=True)
    ]
