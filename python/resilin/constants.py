"""Constants of a law, one number each or one for every state."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from resilin import _core
from resilin.arrays import describe, refuse

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    Scalar = TypeVar("Scalar", bound=np.generic)


def number_array(value: object, place: str) -> NDArray[np.float64]:
    """A copy of `value`, one number or an array of them, in float64."""
    try:
        array = np.asarray(value)
    except ValueError:
        refuse(place, "a number or an array of numbers", "rows of different lengths")
    if array.dtype.kind not in "fiu":
        refuse(place, "a number or an array of numbers", repr(value) if array.ndim == 0 else array.dtype.name)
    return np.array(array, dtype=np.float64, order="C")


def common_shape(arrays: Mapping[str, NDArray[Any]], place: str) -> tuple[int, ...]:
    """The shape that all `arrays`, {name: array}, take together."""
    try:
        return np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {describe(array.shape)}" for name, array in arrays.items())
        refuse(place, "constants of one shape, or single numbers", shapes)


def own_constants(info: _core.LawInfo, given: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """The constants of the law's formula, {name: float64 array}, in its order.

    Parameters
    ----------
    info : LawInfo
    given : dict of float64 arrays
        What the user gave, youngs_modulus and poissons_ratio or the law's own; shapes go together.
    """
    shape = common_shape(given, info.name)
    spread = {name: array if array.ndim == 0 else spread_over(array, shape) for name, array in given.items()}
    rows = np.empty((len(info.constants), math.prod(shape)))
    _core.resolve_constants(info.name, spread, rows)
    own = {constant.name: row.reshape(shape) for constant, row in zip(info.constants, rows, strict=True)}
    return {name: given.get(name, values) for name, values in own.items()}


def batch_law(
    info: _core.LawInfo,
    constants: Iterable[NDArray[np.float64]],
    fibres: NDArray[np.float64] | None,
    batch: tuple[int, ...],
) -> _core.BatchLaw:
    """The core's law for arrays of states of the shape `batch`.

    Parameters
    ----------
    constants : iterable of float64 arrays, in the order of the law, each () or going with `batch`
    fibres : None, or unit vectors (families, 3) or (..., families, 3)
    """
    spread = [array if array.ndim == 0 else spread_over(array, batch) for array in constants]
    if fibres is not None and fibres.ndim > 2:
        per_state = fibres.shape[-2:]
        fibres = spread_over(fibres, (*batch, *per_state)).reshape(-1, *per_state)
    return _core.BatchLaw(info.name, spread, fibres)


def spread_over(array: NDArray[Scalar], shape: tuple[int, ...]) -> NDArray[Scalar]:
    return np.ascontiguousarray(np.broadcast_to(array, shape))


def unit_fibres(fibres: object, info: _core.LawInfo) -> NDArray[np.float64] | None:
    """Directions of fibre families, (3,), (families, 3) or (..., families, 3), at unit length; two components
    lie in the plane."""
    if fibres is None:
        return None
    if info.max_fibres == 0:
        refuse(f"{info.name}.fibres", "none: this law has no fibres", "fibres")
    array = number_array(fibres, f"{info.name}.fibres")
    if array.ndim == 1:
        array = array[None]
    if array.ndim == 0 or array.shape[-1] not in (2, 3) or array.shape[-2] > info.max_fibres:
        expected = f"directions (families, 3) or (M, families, 3), at most {info.max_fibres} families"
        refuse(f"{info.name}.fibres", expected, describe(array.shape))
    if array.shape[-1] == 2:
        array = np.concatenate([array, np.zeros((*array.shape[:-1], 1))], axis=-1)
    length = np.linalg.norm(array, axis=-1, keepdims=True)
    is_absent = (length == 0) & (" + " in info.name)  # a part of a sum may have fewer families than it could
    if not np.all(np.isfinite(length) & (length > 0) | is_absent):
        refuse(f"{info.name}.fibres", "directions of finite length above 0", "one that has none")
    return np.ascontiguousarray(array / np.where(is_absent, 1, length))
