"""The energy of a mesh at torch tensors, followed by autograd.

Where only positions are followed, the core's gradient and Hessian are the derivatives (`body_evaluation`). Where
constants of the law are, the energy is put together of the law at the deformation gradients, of which autograd knows
all slopes.
"""

# ruff: noqa: N803, N806 - F, H and P are the letters of the field

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import torch

from resilin import _core, body_evaluation
from resilin.arrays import describe, refuse
from resilin.evaluation import ENERGY, STRESS
from resilin.law_at_arrays import LawAtArrays
from resilin.law_at_tensors import LawAtTensors
from resilin.tensor_constants import TensorConstants
from resilin.tensors import arrays_of, in_type_of, real_tensor

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Law = LawAtArrays | TensorConstants


class ElasticAtTensors:
    """The quantities of `Elastic`, which says what they are.

    Parameters
    ----------
    core : function
        Gives the core's body with the law's constants as they are now.
    geometry : _core.ElasticBody
        A body with the same cells and points, whose constants are not asked for.
    rest_positions, cells : arrays (N, d), (M, n)
    law : LawAtArrays or TensorConstants
        Of the body's material.
    """

    def __init__(
        self,
        core: Callable[[], _core.ElasticBody],
        geometry: _core.ElasticBody,
        rest_positions: NDArray[np.float64],
        cells: NDArray[np.int32],
        law: Law,
    ) -> None:
        self._core = core
        self._has_mean_volume = geometry.has_mean_volume
        self._rest_positions = torch.from_numpy(rest_positions)
        self._cells = torch.from_numpy(cells.astype(np.int64))
        points = len(cells), geometry.num_points
        self._volumes = torch.from_numpy(geometry.point_volumes()).reshape(points)
        gradients = torch.from_numpy(geometry.shape_gradients())
        self._shape_gradients = gradients.reshape(*points, *gradients.shape[1:])  # dN_a/dX_k (M, Q, n, d)
        self._constants = law.tensors if isinstance(law, TensorConstants) else {}
        if self._constants and self._has_mean_volume:
            expected = "numbers or arrays, because the element is mixed (P2P0, Q1P0)"
            refuse(
                f"material.{' and '.join(self._constants)}",
                expected,
                "tensors that require grad",
                "use .detach(), or the element P1, P2 or Q1",
            )
        self._law = LawAtTensors(_at_points(law))

    def value(self, x: object) -> torch.Tensor:
        positions = self._positions(x)
        array = self._read(positions)
        if array is not None:
            return torch.tensor(self._core().value(array), dtype=positions.dtype)
        if not self._constants:
            return body_evaluation.energy(self._core(), positions)
        densities = self._law.followed(ENERGY, self._displacement_gradients(positions), True)
        return in_type_of(positions, (self._volumes * densities).sum())

    def gradient(self, x: object) -> torch.Tensor:
        positions = self._positions(x)
        array = self._read(positions)
        if array is not None:
            return in_type_of(positions, torch.from_numpy(self._core().gradient(array)))
        if not self._constants:
            return body_evaluation.gradient(self._core(), positions)
        P = self._law.followed(STRESS, self._displacement_gradients(positions), True)
        forces = torch.einsum("mq,mqij,mqaj->mai", self._volumes, P, self._shape_gradients)
        at_rest = torch.zeros_like(self._rest_positions)
        gradient = at_rest.index_add(0, self._cells.reshape(-1), forces.reshape(-1, forces.shape[-1]))
        return in_type_of(positions, gradient)

    def hessian(self, x: object, projection: _core.Projection) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Rows, columns and values."""
        positions = self._positions(x)
        values, columns, row_begin = self._core().hessian(self._unfollowed(positions), projection)
        rows = np.repeat(np.arange(len(row_begin) - 1), np.diff(row_begin))
        entries = in_type_of(positions, torch.from_numpy(values))
        return torch.from_numpy(rows), torch.from_numpy(columns.astype(np.int64)), entries

    def hessian_matrix(self, x: object, projection: _core.Projection) -> torch.Tensor:
        rows, columns, values = self.hessian(x, projection)
        size = self._rest_positions.numel()
        matrix: torch.Tensor = torch.sparse_coo_tensor(torch.stack([rows, columns]), values, (size, size)).coalesce()
        return matrix

    def max_step(self, x: object, p: object) -> torch.Tensor:
        positions, direction = self._positions(x), self._positions(p, "p")
        array = body_evaluation.array_of_positions
        return torch.tensor(self._core().max_step(array(positions), array(direction)), dtype=positions.dtype)

    def deformation_gradients(self, x: object) -> torch.Tensor:
        positions = self._positions(x)
        identity = torch.eye(positions.shape[-1], dtype=torch.float64)
        return in_type_of(positions, self._of_points(self._displacement_gradients(positions) + identity))

    def volume_ratios(self, x: object) -> torch.Tensor:
        ratios: torch.Tensor = torch.linalg.det(self.deformation_gradients(x))
        return ratios

    def energy_densities(self, x: object) -> torch.Tensor:
        positions = self._positions(x)
        array = self._read_points(positions)
        if array is None:
            densities = self._law.followed(ENERGY, self._displacement_gradients(positions), True)
        else:
            densities = torch.from_numpy(self._core().energy_densities(array)).reshape(self._volumes.shape)
        return in_type_of(positions, self._of_points(densities))

    def cauchy_stresses(self, x: object) -> torch.Tensor:
        positions = self._positions(x)
        array = self._read_points(positions)
        if array is None:
            sigma = self._law.cauchy_stress(self._displacement_gradients(positions), True)
        else:
            sigma = torch.from_numpy(self._core().cauchy_stresses(array)).reshape(*self._volumes.shape, 3, 3)
        return in_type_of(positions, self._of_points(sigma))

    def von_mises(self, x: object) -> torch.Tensor:
        sigma = self.cauchy_stresses(x)
        pressure = sigma.diagonal(dim1=-2, dim2=-1).mean(-1)[..., None, None]
        deviator = sigma - pressure * torch.eye(3, dtype=sigma.dtype)
        stress: torch.Tensor = (1.5 * (deviator * deviator).sum((-2, -1))).sqrt()
        return stress

    def _positions(self, x: object, place: str = "x") -> torch.Tensor:
        positions = real_tensor(x, place)
        shape = self._rest_positions.shape
        if positions.shape != shape:
            refuse(place, f"a tensor {describe(shape)}", describe(positions.shape))
        return positions

    def _read(self, positions: torch.Tensor) -> NDArray[np.float64] | None:
        """The positions as an array; None where autograd or torch.func follows them or a constant."""
        arrays = arrays_of([positions, *self._constants.values()])
        return None if arrays is None else np.ascontiguousarray(arrays[0], dtype=np.float64)

    def _read_points(self, positions: torch.Tensor) -> NDArray[np.float64] | None:
        array = self._read(positions)
        if array is None and self._has_mean_volume:
            refuse(
                "x",
                "a tensor that does not require grad, because pressures of mixed elements are not differentiable",
                "one that does",
                "use .detach(); `value` and `gradient` are differentiable",
            )
        return array

    def _unfollowed(self, positions: torch.Tensor) -> NDArray[np.float64]:
        array = self._read(positions)
        if array is None:
            refuse(
                "x",
                "positions and constants without grad, because the Hessian is not differentiable",
                "tensors that require grad",
                "call it under torch.no_grad(), or give x.detach()",
            )
        return array

    def _displacement_gradients(self, positions: torch.Tensor) -> torch.Tensor:
        """H = F - I at each point (M, Q, d, d)."""
        u = positions.double() - self._rest_positions
        H: torch.Tensor = torch.einsum("mai,mqaj->mqij", u[self._cells], self._shape_gradients)
        return H

    def _of_points(self, values: torch.Tensor) -> torch.Tensor:
        return values[:, 0] if values.shape[1] == 1 else values


class ConstantsAtPoints(TensorConstants):
    """Constants of cells, for states (cells, points)."""

    def __init__(self, constants: TensorConstants) -> None:
        self.__dict__.update(vars(constants))
        self.fibres = _fibres_at_points(constants.fibres)
        self.states_shape = () if self.fibres is None else self.fibres.shape[:-2]

    def own(self) -> list[torch.Tensor]:
        return [tensor if tensor.ndim == 0 else tensor[:, None] for tensor in super().own()]


def _at_points(law: Law) -> Law:
    if isinstance(law, TensorConstants):
        return ConstantsAtPoints(law)
    own = {name: array if array.ndim == 0 else array[:, None] for name, array in law.own.items()}
    return LawAtArrays(law.info, own, _fibres_at_points(law.fibres))


def _fibres_at_points(fibres: NDArray[np.float64] | None) -> NDArray[np.float64] | None:
    return fibres if fibres is None or fibres.ndim == 2 else fibres[:, None]
