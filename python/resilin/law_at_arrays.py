"""A law whose constants are numbers or arrays, at arrays of deformation gradients."""

# ruff: noqa: N803, N806 - F, P, A and J are the letters of the field

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from resilin.arrays import real_array, refuse, result_array, square_matrices
from resilin.catalog import projection_named
from resilin.constants import batch_law, common_shape, own_constants

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from resilin import _core
    from resilin.typing import Projection

    Floats = NDArray[np.floating[Any]]


class LawAtArrays:
    """The quantities of `Material`, which says what they are. `is_H`: whether F holds displacement gradients.

    Parameters
    ----------
    given : dict of float64 arrays
        What the user gave, youngs_modulus and poissons_ratio or the law's own constants.
    fibres : None, or unit vectors (families, 3) or (..., families, 3)
    """

    def __init__(
        self, info: _core.LawInfo, given: Mapping[str, NDArray[np.float64]], fibres: NDArray[np.float64] | None
    ) -> None:
        self.info = info
        self.fibres = fibres
        self.own: dict[str, NDArray[np.float64]] = own_constants(info, given)
        for array in self.own.values():
            array.flags.writeable = False
        shapes = dict(self.own)
        if fibres is not None:
            shapes["fibres"] = fibres[..., 0, 0]
        self.states_shape: tuple[int, ...] = common_shape(shapes, info.name)
        self._law = batch_law(info, self.own.values(), fibres, self.states_shape)
        # One for all states, which has a short way for plain arrays; None where states have constants of their own.
        self.shared_law: _core.BatchLaw | None = None if self.states_shape else self._law

    def constants(self) -> dict[str, float | NDArray[np.float64]]:
        """Those of the law's formula in its order."""
        return {name: float(array) if array.ndim == 0 else array for name, array in self.own.items()}

    def energy_density(self, F: object, is_H: bool, out: object) -> Floats:
        F, batch, law = self._states(F)
        psi = result_array(out, batch, F)
        law.energy_densities(F, is_H, psi)
        return psi if batch else psi[()]

    def first_piola_kirchhoff_stress(self, F: object, is_H: bool, out: object) -> Floats:
        F, _, law = self._states(F)
        P = result_array(out, F.shape, F)
        law.first_piola_kirchhoff_stresses(F, is_H, P)
        return P

    def stress_tangent(self, F: object, projection: Projection, is_H: bool, out: object) -> Floats:
        kind = projection_named(projection)
        F, _, law = self._states(F)
        A = result_array(out, F.shape + F.shape[-2:], F)
        law.stress_tangents(F, is_H, kind, A)
        return A

    def elastic_forces(self, F: object, Dm_inv: object, volume: object, is_H: bool, out: object) -> Floats:
        arrays = (square_matrices(F, "F"), square_matrices(Dm_inv, "Dm_inv"), real_array(volume, "volume"))
        (F, Dm_inv, volume), batch, law = self._cells(*arrays)
        dim = F.shape[-1]
        forces = result_array(out, (*batch, dim + 1, dim), F, (Dm_inv, volume))
        law.elastic_forces(F, is_H, Dm_inv, volume, forces)
        return forces

    def constant_derivatives(self, F: object, is_H: bool) -> dict[str, tuple[Floats, Floats]]:
        F, batch, law = self._states(F)
        derivatives = {}
        for place, constant in enumerate(self.info.constants):
            dpsi, dP = np.empty(batch, F.dtype), np.empty_like(F)
            law.constant_derivatives(F, is_H, place, dpsi, dP)
            derivatives[constant.name] = (dpsi if batch else dpsi[()], dP)
        return derivatives

    def cauchy_stress(self, F: object, is_H: bool) -> Floats:
        F = square_matrices(F, "F")
        in_space = np.zeros((*F.shape[:-2], 3, 3)) if is_H else np.tile(np.eye(3), (*F.shape[:-2], 1, 1))
        in_space[..., : F.shape[-1], : F.shape[-1]] = F
        sigma = self.first_piola_kirchhoff_stress(in_space, is_H, None)
        if not self.info.is_small_strain:
            if is_H:
                in_space += np.eye(3)
            with np.errstate(all="ignore"):  # nan and inf are results here
                sigma = sigma @ in_space.swapaxes(-1, -2) / np.linalg.det(in_space)[..., None, None]
        return sigma.astype(F.dtype, copy=False)

    def law_for(self, batch: tuple[int, ...]) -> _core.BatchLaw:
        """The core's law for states of the leading shape `batch`."""
        if not self.states_shape or batch == self.states_shape:
            return self._law
        return batch_law(self.info, self.own.values(), self.fibres, batch)

    def _states(self, F: object) -> tuple[Floats, tuple[int, ...], _core.BatchLaw]:
        """F ready for the core, its leading shape, and the law for it."""
        F = square_matrices(F, "F")
        batch = F.shape[:-2]
        if not self.states_shape or batch == self.states_shape:
            return F, batch, self._law
        batch = self._batch({"F": batch})
        return np.ascontiguousarray(np.broadcast_to(F, (*batch, *F.shape[-2:]))), batch, self.law_for(batch)

    def _cells(
        self, F: Floats, Dm_inv: Floats, volume: Floats
    ) -> tuple[tuple[Floats, Floats, Floats], tuple[int, ...], _core.BatchLaw]:
        """The same for three arrays, which take one type and one leading shape."""
        if Dm_inv.shape[-1] != F.shape[-1]:
            refuse("Dm_inv", f"matrices as large as those of F, {F.shape[-2:]}", f"{Dm_inv.shape[-2:]}")
        batch = F.shape[:-2]
        is_one_type = F.dtype is Dm_inv.dtype is volume.dtype
        if is_one_type and F.shape == Dm_inv.shape and batch == volume.shape and self.states_shape in ((), batch):
            return (F, Dm_inv, volume), batch, self._law
        batch = self._batch({"F": batch, "Dm_inv": Dm_inv.shape[:-2], "volume": volume.shape})
        dtype = np.result_type(F, Dm_inv, volume)

        def spread(array: Floats, shape: tuple[int, ...]) -> Floats:
            return np.ascontiguousarray(np.broadcast_to(array, shape), dtype)

        matrices = (*batch, *F.shape[-2:])
        return (spread(F, matrices), spread(Dm_inv, matrices), spread(volume, batch)), batch, self.law_for(batch)

    def _batch(self, shapes: dict[str, tuple[int, ...]]) -> tuple[int, ...]:
        """The leading shape that arguments, {name: leading shape}, and the constants take together."""
        try:
            return np.broadcast_shapes(*shapes.values(), self.states_shape)
        except ValueError:
            got = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
            refuse("F", f"leading shapes that go together and with the constants' {self.states_shape}", got)
