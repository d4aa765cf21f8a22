"""torch: simulations as functions of tensors, and a drop-in replacement for a class common in torch simulators."""

# ruff: noqa: N803, N806 - E, F and P are the letters of the field

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

from resilin.material import Material

if TYPE_CHECKING:
    from typing import TypeVar

    import numpy as np
    import torch
    from numpy.typing import NDArray

    from resilin.typing import Constant, Overrides, Scene, TensorLike

    Real = TypeVar("Real", np.float32, np.float64)
    T = TypeVar("T")


class StableNeoHookean:
    """Neo-Hookean solid of tetrahedra, Psi = mu/2 (I_C - 3) - mu ln J + lambda/2 (J - 1)^2, with the exact derivatives.

    The names are those of the replaced class; the model is Resilin's "neo_hookean_quadratic". Tensors (or numpy arrays)
    of F may have any leading shape and may be 2 by 2; autograd differentiates every method. The replaced class clamped
    its numbers, so that its forces were not derivatives of its energy. Differences:

    - J <= 0 gives the energy inf and the stress nan for that element only. There, J became 1e-6.
    - `first_piola_kirchhoff_stress_analytic` and `compute_elastic_forces` are exact. There, J was clamped to [0.3, 3],
      or to [0.1, 5] for all elements as soon as one of the batch had J < 0.01, the singular values of F^-T to [0.2, 5],
      and every stress above 1e6 Pa in norm was scaled down to 1e6 Pa.
    - `first_piola_kirchhoff_stress` keeps the graph of F, which the replaced method detached.

    Parameters
    ----------
    youngs_modulus, poissons_ratio : float or tensor
        [Pa], [-]; autograd differentiates tensors that require grad.
    """

    def __init__(self, youngs_modulus: Constant = 1e6, poissons_ratio: Constant = 0.45) -> None:
        self._material = Material("neo_hookean_quadratic", youngs_modulus=youngs_modulus, poissons_ratio=poissons_ratio)
        self._given = youngs_modulus, poissons_ratio

    @property
    def E(self) -> Constant:  # noqa: N802
        """Young's modulus [Pa]."""
        return self._given[0]

    @property
    def nu(self) -> Constant:
        """Poisson's ratio."""
        return self._given[1]

    @property
    def mu(self) -> float | NDArray[np.float64] | torch.Tensor:
        """Shear modulus [Pa]."""
        return self._material.constants["shear_modulus"]

    @property
    def lam(self) -> float | NDArray[np.float64] | torch.Tensor:
        """Lame's lambda [Pa]."""
        return self._material.constants["lame_lambda"]

    @overload
    def energy_density(self, F: TensorLike[T]) -> T: ...

    @overload
    def energy_density(self, F: NDArray[Real]) -> NDArray[Real]: ...

    def energy_density(self, F: Any) -> Any:
        """Strain energy density Psi.

        Parameters
        ----------
        F : array or tensor (M, 3, 3)
            Deformation gradients.

        Returns
        -------
        array or tensor (M,)
            [J/m^3]
        """
        return self._material.energy_density(F)

    @overload
    def first_piola_kirchhoff_stress(self, F: TensorLike[T]) -> T: ...

    @overload
    def first_piola_kirchhoff_stress(self, F: NDArray[Real]) -> NDArray[Real]: ...

    def first_piola_kirchhoff_stress(self, F: Any) -> Any:
        """First Piola-Kirchhoff stress P = dPsi/dF.

        Parameters
        ----------
        F : array or tensor (M, 3, 3)
            Deformation gradients.

        Returns
        -------
        array or tensor (M, 3, 3)
            [Pa]
        """
        return self._material.first_piola_kirchhoff_stress(F)

    @overload
    def first_piola_kirchhoff_stress_analytic(self, F: TensorLike[T]) -> T: ...

    @overload
    def first_piola_kirchhoff_stress_analytic(self, F: NDArray[Real]) -> NDArray[Real]: ...

    def first_piola_kirchhoff_stress_analytic(self, F: Any) -> Any:
        """First Piola-Kirchhoff stress, the same as `first_piola_kirchhoff_stress`.

        Parameters
        ----------
        F : array or tensor (M, 3, 3)
            Deformation gradients.

        Returns
        -------
        array or tensor (M, 3, 3)
            [Pa]
        """
        return self._material.first_piola_kirchhoff_stress(F)

    @overload
    def compute_elastic_forces(self, F: TensorLike[T], Dm_inv: Constant, volume: Constant) -> T: ...

    @overload
    def compute_elastic_forces(
        self, F: NDArray[Real], Dm_inv: NDArray[Real], volume: NDArray[Real]
    ) -> NDArray[Real]: ...

    def compute_elastic_forces(self, F: Any, Dm_inv: Any, volume: Any) -> Any:
        """Forces on the corners of tetrahedra.

        Parameters
        ----------
        F : array or tensor (M, 3, 3)
            Deformation gradients.
        Dm_inv : array or tensor (M, 3, 3)
            Inverse of the matrix whose columns are the reference edges from corner 0 [1/m].
        volume : array or tensor (M,)
            Reference volume [m^3].

        Returns
        -------
        array or tensor (M, 4, 3)
            [N]
        """
        return self._material.elastic_forces(F, Dm_inv, volume)


def simulate(
    scene: Scene, *, overrides: Overrides = (), checkpoints: int = 0, batch: bool = False, **tensors: torch.Tensor
) -> torch.Tensor:
    """Nodal positions as a differentiable function of parameters of the scene.

    Static and dynamic runs with the adjoint of `resilin.value_and_gradient`: exact, one solve for each equilibrium or
    step, without a tape. First derivatives only.

    Parameters
    ----------
    scene : path or dict
        As for `resilin.run`.
    overrides : dict or list of "KEY=VALUE"
        Changes of the scene.
    checkpoints : int
        As for `resilin.value_and_gradient`.
    batch : bool
        All tensors have a leading dimension B: B runs of one scene on all cores, bitwise equal to single runs. Give a
        common value as `tensor.expand(B, ...)`.
    **tensors
        Parameters by key, given with **: {"body.beam.material.youngs_modulus": E}; they replace values of the scene. A
        tensor (M,) for a constant has one value for each cell.

    Returns
    -------
    tensor (T, N, d), for a batch (B, T, N, d)
        [m], float64; frame 0 is the start, the last is the equilibrium or the end of the dynamic run. In statics the
        others are at load factors k / load_steps; cutbacks are left out.

    Examples
    --------
    >>> E = torch.tensor(1e6, dtype=torch.float64, requires_grad=True)
    >>> x = resilin.torch.simulate("beam.toml", **{"body.beam.material.youngs_modulus": E})
    >>> x[-1, :, 2].min().backward()
    """
    from resilin.tensor_simulation import simulate_at_tensors

    return simulate_at_tensors(scene, overrides, checkpoints, batch, tensors)
