"""Constitutive models of hyperelastic solids for arrays of deformation gradients."""

# ruff: noqa: N803, N806 - F and P are the letters of the field

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

from resilin import _core
from resilin.arrays import is_tensor, plain_text, refuse
from resilin.catalog import HelpWithLaws
from resilin.constants import number_array, unit_fibres
from resilin.law_at_arrays import LawAtArrays

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import TypeVar

    import numpy as np
    import torch
    from numpy.typing import NDArray

    from resilin.curve import StretchCurve
    from resilin.law_at_tensors import LawAtTensors
    from resilin.tensor_constants import TensorConstants
    from resilin.typing import Constant, CurveKind, Projection, RealArray, TensorLike

    Real = TypeVar("Real", np.float32, np.float64)  # the type of the numbers: results have that of F
    T = TypeVar("T")  # the class of the tensors
    Floats = NDArray[np.floating[Any]]


class Material:
    """A hyperelastic constitutive model (law) with its constants.

    Methods take deformation gradients F of any leading shape, ``(..., d, d)`` with d = 3, or 2 for plane strain, as
    numpy arrays or torch tensors in float64 or float32, and return the same kind. Computations are in double precision.
    C-contiguous arrays are read in place; others are copied. Integers are read as float64. A state outside the domain
    of the law (J <= 0 under a logarithm, nan) gives inf or nan; other states are unaffected.

    Parameters
    ----------
    law : str
        A name from the table below.
    youngs_modulus, poissons_ratio : float or array or tensor
        [Pa], [-]. The small-strain response, for every law; they are converted to the constants of its formula.
    fibres : array (families, 3) or (..., families, 3), optional
        Fibre directions in the reference configuration, for laws with fibres; two components lie in the plane.
    **constants : float or array or tensor
        Constants of the law's formula by name, instead of youngs_modulus and poissons_ratio, or beside them where the
        table says so. An array holds one value for every state; its shape broadcasts against the leading shape of F.
        Autograd differentiates tensors that require grad.

    Raises
    ------
    InputError
        A ValueError with one line: what was expected and what was found.

    Examples
    --------
    >>> law = resilin.Material("neo_hookean", youngs_modulus=1e6, poissons_ratio=0.45)
    >>> P = law.first_piola_kirchhoff_stress(F)
    """

    def __init__(
        self,
        law: str,
        *,
        youngs_modulus: Constant | None = None,
        poissons_ratio: Constant | None = None,
        fibres: Constant | None = None,
        **constants: Constant | None,
    ) -> None:
        if not isinstance(law, str):
            refuse("law", "a name", repr(law))
        info = self._info = _core.require_law(plain_text(law, "law"), "law")
        given: dict[str, object] = {"youngs_modulus": youngs_modulus, "poissons_ratio": poissons_ratio, **constants}
        given = {plain_text(name, law): value for name, value in given.items() if value is not None}
        self.tensors: dict[str, torch.Tensor] = {}  # the given constants that autograd follows
        directions: object = fibres
        if any(is_tensor(value) for value in (*given.values(), fibres)):
            from resilin.tensor_constants import split_constants

            given, self.tensors, directions = split_constants(law, given, fibres)
        self._given = {name: number_array(value, f"{law}.{name}") for name, value in given.items()}
        self._fibres = unit_fibres(directions, info)
        self._law: LawAtArrays | TensorConstants
        if self.tensors:
            from resilin.tensor_constants import TensorConstants

            self._law = TensorConstants(info, self._given, self.tensors, self._fibres)
        else:
            self._law = LawAtArrays(info, self._given, self._fibres)
        self._tensor_law: LawAtTensors | None = None  # made when the first tensor comes
        self._shared_law = self._law.shared_law if isinstance(self._law, LawAtArrays) else None

    @property
    def law(self) -> str:
        """The law's name."""
        return self._info.name

    @property
    def info(self) -> _core.LawInfo:
        """Formula, source, constants with units and bounds, behaviour under inversion (LawInfo)."""
        return self._info

    @property
    def constants(self) -> dict[str, float | NDArray[np.float64] | torch.Tensor]:
        """The constants of the law's formula in its order: floats, arrays, or tensors where one requires grad."""
        if isinstance(self._law, LawAtArrays):
            return {**self._law.constants()}
        return dict(zip((constant.name for constant in self._info.constants), self._law.own(), strict=True))

    @property
    def fibres(self) -> NDArray[np.float64] | None:
        """Unit vectors of the fibre families, (..., families, 3), or None."""
        return self._fibres

    @overload
    def energy_density(
        self, F: TensorLike[T], *, displacement_gradient: bool = False, out: TensorLike[T] | None = None
    ) -> T: ...

    @overload
    def energy_density(
        self, F: NDArray[Real], *, displacement_gradient: bool = False, out: NDArray[Real] | None = None
    ) -> NDArray[Real]: ...

    @overload
    def energy_density(
        self, F: RealArray, *, displacement_gradient: bool = False, out: NDArray[np.float64] | None = None
    ) -> Floats: ...

    def energy_density(self, F: Any, *, displacement_gradient: bool = False, out: Any = None) -> Any:
        """Strain energy density Psi [J/m^3].

        Parameters
        ----------
        F : array (..., d, d)
            Deformation gradient.
        displacement_gradient : bool
            Whether `F` holds H = F - I, which keeps all digits at small strain.
        out : array (...), optional
            Array for the result, with the type of F.

        Returns
        -------
        array (...)
            Zero in the reference configuration; inf outside the domain of the law.
        """
        law = self._shared_law if out is None else None
        if law is not None and (psi := law.new_energy_densities(F, displacement_gradient)) is not None:
            return psi
        if is_tensor(F):
            return self._at_tensors().energy_density(F, displacement_gradient, out)
        return self._at_arrays().energy_density(F, displacement_gradient, out)

    @overload
    def first_piola_kirchhoff_stress(
        self, F: TensorLike[T], *, displacement_gradient: bool = False, out: TensorLike[T] | None = None
    ) -> T: ...

    @overload
    def first_piola_kirchhoff_stress(
        self, F: NDArray[Real], *, displacement_gradient: bool = False, out: NDArray[Real] | None = None
    ) -> NDArray[Real]: ...

    @overload
    def first_piola_kirchhoff_stress(
        self, F: RealArray, *, displacement_gradient: bool = False, out: NDArray[np.float64] | None = None
    ) -> Floats: ...

    def first_piola_kirchhoff_stress(self, F: Any, *, displacement_gradient: bool = False, out: Any = None) -> Any:
        """First Piola-Kirchhoff stress P = dPsi/dF [Pa].

        Parameters
        ----------
        F : array (..., d, d)
            Deformation gradient.
        displacement_gradient : bool
            Whether `F` holds H = F - I, which keeps all digits at small strain.
        out : array (..., d, d), optional
            Array for the result, with the type of F.

        Returns
        -------
        array (..., d, d)
            nan outside the domain of the model.
        """
        law = self._shared_law if out is None else None
        if law is not None and (P := law.new_first_piola_kirchhoff_stresses(F, displacement_gradient)) is not None:
            return P
        if is_tensor(F):
            return self._at_tensors().first_piola_kirchhoff_stress(F, displacement_gradient, out)
        return self._at_arrays().first_piola_kirchhoff_stress(F, displacement_gradient, out)

    @overload
    def stress_tangent(
        self,
        F: TensorLike[T],
        projection: Projection = None,
        *,
        displacement_gradient: bool = False,
        out: TensorLike[T] | None = None,
    ) -> T: ...

    @overload
    def stress_tangent(
        self,
        F: NDArray[Real],
        projection: Projection = None,
        *,
        displacement_gradient: bool = False,
        out: NDArray[Real] | None = None,
    ) -> NDArray[Real]: ...

    @overload
    def stress_tangent(
        self,
        F: RealArray,
        projection: Projection = None,
        *,
        displacement_gradient: bool = False,
        out: NDArray[np.float64] | None = None,
    ) -> Floats: ...

    def stress_tangent(
        self, F: Any, projection: Projection = None, *, displacement_gradient: bool = False, out: Any = None
    ) -> Any:
        """Derivative of the stress, dP_ij/dF_kl [Pa], with indices in the order i, j, k, l.

        Parameters
        ----------
        F : array (..., d, d)
            Deformation gradient.
        projection : None, "clamp" or "absolute"
            Projection of negative eigenvalues of the tangent as a matrix of d^2 rows: none, to zero, or to their
            absolute values.
        displacement_gradient, out
            As in `energy_density`.

        Returns
        -------
        array (..., d, d, d, d)
            [Pa]; nan outside the domain of the model.
        """
        if is_tensor(F):
            return self._at_tensors().stress_tangent(F, projection, displacement_gradient, out)
        return self._at_arrays().stress_tangent(F, projection, displacement_gradient, out)

    @overload
    def elastic_forces(
        self,
        F: TensorLike[T],
        Dm_inv: Constant,
        volume: Constant,
        *,
        displacement_gradient: bool = False,
        out: TensorLike[T] | None = None,
    ) -> T: ...

    @overload
    def elastic_forces(
        self,
        F: NDArray[Real],
        Dm_inv: NDArray[Real],
        volume: NDArray[Real],
        *,
        displacement_gradient: bool = False,
        out: NDArray[Real] | None = None,
    ) -> NDArray[Real]: ...

    @overload
    def elastic_forces(
        self,
        F: RealArray,
        Dm_inv: RealArray,
        volume: RealArray,
        *,
        displacement_gradient: bool = False,
        out: NDArray[np.float64] | None = None,
    ) -> Floats: ...

    def elastic_forces(
        self, F: Any, Dm_inv: Any, volume: Any, *, displacement_gradient: bool = False, out: Any = None
    ) -> Any:
        """Forces on the corners of tetrahedra or triangles [N]: f_a = -V P dN_a/dX.

        Parameters
        ----------
        F : array (..., d, d)
            Deformation gradient.
        Dm_inv : array (..., d, d)
            Inverse of the matrix whose columns are the reference edges from corner 0 [1/m].
        volume : array (...)
            Reference volume [m^3]; in 2D the area [m^2], for unit thickness.
        displacement_gradient, out
            As in `energy_density`.

        Returns
        -------
        array (..., d + 1, d)
            One row for each corner; their sum is zero.
        """
        law = self._shared_law if out is None else None
        if law is not None and (f := law.new_elastic_forces(F, displacement_gradient, Dm_inv, volume)) is not None:
            return f
        if is_tensor(F):
            return self._at_tensors().elastic_forces(F, Dm_inv, volume, displacement_gradient, out)
        return self._at_arrays().elastic_forces(F, Dm_inv, volume, displacement_gradient, out)

    @overload
    def constant_derivatives(
        self, F: TensorLike[T], *, displacement_gradient: bool = False
    ) -> dict[str, tuple[T, T]]: ...

    @overload
    def constant_derivatives(
        self, F: NDArray[Real], *, displacement_gradient: bool = False
    ) -> dict[str, tuple[NDArray[Real], NDArray[Real]]]: ...

    @overload
    def constant_derivatives(
        self, F: RealArray, *, displacement_gradient: bool = False
    ) -> dict[str, tuple[Floats, Floats]]: ...

    def constant_derivatives(self, F: Any, *, displacement_gradient: bool = False) -> Any:
        """Derivatives with respect to each constant p of the law's formula.

        Parameters
        ----------
        F : array (..., d, d)
            Deformation gradient.
        displacement_gradient : bool
            Whether `F` holds H = F - I.

        Returns
        -------
        dict
            {name: (dPsi/dp, dP/dp)}, arrays (...) and (..., d, d).
        """
        if is_tensor(F):
            return self._at_tensors().constant_derivatives(F, displacement_gradient)
        return self._at_arrays().constant_derivatives(F, displacement_gradient)

    @overload
    def cauchy_stress(self, F: TensorLike[T], *, displacement_gradient: bool = False) -> T: ...

    @overload
    def cauchy_stress(self, F: NDArray[Real], *, displacement_gradient: bool = False) -> NDArray[Real]: ...

    @overload
    def cauchy_stress(self, F: RealArray, *, displacement_gradient: bool = False) -> Floats: ...

    def cauchy_stress(self, F: Any, *, displacement_gradient: bool = False) -> Any:
        """Cauchy stress sigma = P F^T / J [Pa]. For a small-strain model it is the stress itself.

        Parameters
        ----------
        F : array (..., d, d)
            Deformation gradient.
        displacement_gradient : bool
            Whether `F` holds H = F - I.

        Returns
        -------
        array (..., 3, 3)
            Also in plane strain.
        """
        if is_tensor(F):
            return self._at_tensors().cauchy_stress(F, displacement_gradient)
        return self._at_arrays().cauchy_stress(F, displacement_gradient)

    def curve(self, kind: CurveKind, stretches: RealArray | None = None) -> StretchCurve:
        """Stress-stretch curve of the material, with the traction-free directions solved.

        Parameters
        ----------
        kind : "uniaxial", "equibiaxial", "planar", "shear" or "volumetric"
            F = diag(l, x, y), diag(l, l, x), diag(l, x, 1), I + l e1 (x) e2 or l I; the directions x and y are
            traction-free.
        stretches : array (N,), optional
            Positive numbers l; amounts of shear for "shear". Otherwise 61 from 0.5 to 2, or from 0 to 1.5.

        Returns
        -------
        StretchCurve
            Arrays stretch, nominal_stress, cauchy_stress [Pa], volume_ratio, energy_density [J/m^3], is_stable; plot(),
            to_csv(path), to_json(path). Warns where the model becomes unstable.
        """
        from resilin.curve import stretch_curve

        return stretch_curve(self.law, self.constants, self._fibres, kind, stretches)

    def __repr__(self) -> str:
        parts = [repr(self.law)]
        for name, value in self.constants.items():
            parts.append(f"{name}={value:.6g}" if isinstance(value, float) else f"{name}=<{tuple(value.shape)}>")
        if self._fibres is not None:
            parts.append(f"fibres=<{self._fibres.shape}>")
        return f"Material({', '.join(parts)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self.law, {**self._given, **self.tensors}, self._fibres)

    def _at_arrays(self) -> LawAtArrays:
        if isinstance(self._law, LawAtArrays):
            return self._law
        names = " and ".join(self.tensors)
        refuse("F", f"a torch tensor because {names} requires grad", "a numpy array", "use torch.from_numpy(F)")

    def _at_tensors(self) -> LawAtTensors:
        if self._tensor_law is None:
            from resilin.law_at_tensors import LawAtTensors

            self._tensor_law = LawAtTensors(self._law)
        return self._tensor_law


def number_constants(material: Material) -> dict[str, float | NDArray[np.float64]]:
    """The constants of a material for what autograd cannot follow: a body or a simulation."""
    if isinstance(material._law, LawAtArrays):
        return material._law.constants()
    names = " and ".join(material.tensors)
    refuse(f"material.{names}", "numbers or arrays", "tensors that require grad", "use .detach()")


def _rebuild(law: str, constants: Mapping[str, Any], fibres: NDArray[np.float64] | None) -> Material:
    return Material(law, fibres=fibres, **constants)


if Material.__doc__:  # python -OO leaves none
    Material.__doc__ = HelpWithLaws(Material.__doc__)  # type: ignore[assignment]
