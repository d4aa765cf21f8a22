"""A law at torch tensors of deformation gradients: numbers are read where they lie, and autograd follows them."""

# ruff: noqa: N803, N806 - F and P are the letters of the field

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from resilin.arrays import refuse
from resilin.evaluation import ENERGY, STRESS, Quantity, States, energy_slope, evaluated, stress_slope, tangent
from resilin.law_at_arrays import LawAtArrays
from resilin.tensor_constants import TensorConstants
from resilin.tensors import array_of, arrays_of, plain_arrays, real_tensor, square_tensors, tensor_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin.typing import Projection


class LawAtTensors:
    """The quantities of `Material`, which says what they are. `is_H`: whether F holds displacement gradients."""

    def __init__(self, law: LawAtArrays | TensorConstants) -> None:
        self._law = law
        self._shared_law = law.shared_law if isinstance(law, LawAtArrays) else None

    def energy_density(self, F: object, is_H: bool, out: object) -> torch.Tensor:
        if out is None and self._shared_law is not None and (arrays := plain_arrays(F)):
            psi = self._shared_law.new_energy_densities(arrays[0], is_H)
            if psi is not None:
                return tensor_of(psi, None)
        states = square_tensors(F, "F")
        read = self._read(states)
        if read is None:
            return self.followed(ENERGY, states, is_H, out)
        law, (array,) = read
        return tensor_of(law.energy_density(array, is_H, array_of(out)), out)

    def first_piola_kirchhoff_stress(self, F: object, is_H: bool, out: object) -> torch.Tensor:
        if out is None and self._shared_law is not None and (arrays := plain_arrays(F)):
            P = self._shared_law.new_first_piola_kirchhoff_stresses(arrays[0], is_H)
            if P is not None:
                return tensor_of(P, None)
        states = square_tensors(F, "F")
        read = self._read(states)
        if read is None:
            return self.followed(STRESS, states, is_H, out)
        law, (array,) = read
        return tensor_of(law.first_piola_kirchhoff_stress(array, is_H, array_of(out)), out)

    def stress_tangent(self, F: object, projection: Projection, is_H: bool, out: object) -> torch.Tensor:
        states = square_tensors(F, "F")
        read = self._read(states)
        if read is None:
            return self.followed(tangent(projection), states, is_H, out)
        law, (array,) = read
        return tensor_of(law.stress_tangent(array, projection, is_H, array_of(out)), out)

    def elastic_forces(self, F: object, Dm_inv: object, volume: object, is_H: bool, out: object) -> torch.Tensor:
        if out is None and self._shared_law is not None and (arrays := plain_arrays(F, Dm_inv, volume)):
            array, inverse_array, volume_array = arrays
            new_forces = self._shared_law.new_elastic_forces(array, is_H, inverse_array, volume_array)
            if new_forces is not None:
                return tensor_of(new_forces, None)
        states, inverses = square_tensors(F, "F"), square_tensors(Dm_inv, "Dm_inv")
        volumes = real_tensor(volume, "volume")
        read = self._read(states, inverses, volumes)
        if read is not None:
            law, (array, inverse_array, volume_array) = read
            forces = law.elastic_forces(array, inverse_array, volume_array, is_H, array_of(out))
            return tensor_of(forces, out)
        if inverses.shape[-1] != states.shape[-1]:
            expected = f"matrices as large as those of F, {tuple(states.shape[-2:])}"
            refuse("Dm_inv", expected, f"{tuple(inverses.shape[-2:])}")
        P = self.followed(STRESS, states, is_H, out)
        others = -volumes[..., None, None] * (inverses @ P.transpose(-1, -2))  # rows: corners 1, 2, ...
        return torch.cat([-others.sum(-2, keepdim=True), others], -2)

    def constant_derivatives(self, F: object, is_H: bool) -> dict[str, tuple[torch.Tensor, torch.Tensor]]:
        states = square_tensors(F, "F")
        return {
            constant.name: (
                self.followed(energy_slope(place), states, is_H),
                self.followed(stress_slope(place), states, is_H),
            )
            for place, constant in enumerate(self._law.info.constants)
        }

    def cauchy_stress(self, F: object, is_H: bool) -> torch.Tensor:
        states = square_tensors(F, "F")
        read = self._read(states)
        if read is not None:
            law, (array,) = read
            return tensor_of(law.cauchy_stress(array, is_H), None)
        missing = 3 - states.shape[-1]
        in_space = torch.nn.functional.pad(states, (0, missing, 0, missing))
        if missing and not is_H:
            in_space = in_space + torch.diag(torch.tensor([0, 0, 1], dtype=states.dtype))
        P = self.followed(STRESS, in_space, is_H)
        if self._law.info.is_small_strain:
            return P
        if is_H:
            in_space = in_space + torch.eye(3, dtype=states.dtype)
        F_3d = in_space.double()
        sigma: torch.Tensor = P.double() @ F_3d.transpose(-1, -2) / torch.linalg.det(F_3d)[..., None, None]
        sigma = sigma.to(states.dtype)
        return sigma

    def _read(self, *tensors: torch.Tensor) -> tuple[LawAtArrays, list[NDArray[Any]]] | None:
        """Evaluator for views of the tensors; None where autograd or torch.func must follow."""
        law = self._law
        if not isinstance(law, LawAtArrays):
            return None
        arrays = arrays_of(tensors)
        return None if arrays is None else (law, arrays)

    def followed(self, quantity: Quantity, F: torch.Tensor, is_H: bool, out: object = None) -> torch.Tensor:
        """The quantity as a node that autograd, and vmap, can follow."""
        if out is not None:
            refuse("out", "nothing where autograd or torch.func follows the result", "a tensor")
        constants = self._law.own() if isinstance(self._law, TensorConstants) else []
        batch = tuple(F.shape[:-2])
        shapes = [batch, self._law.states_shape, *(tuple(constant.shape) for constant in constants)]
        try:
            batch = np.broadcast_shapes(*shapes)
        except ValueError:
            refuse("F", f"a leading shape that goes with the constants' {shapes[-1]}", str(batch))
        constants = [constant if constant.ndim == 0 else constant.expand(batch) for constant in constants]
        return evaluated(quantity, States(self._law, is_H), F.expand(*batch, *F.shape[-2:]), *constants)
