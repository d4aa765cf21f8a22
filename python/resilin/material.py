"""Laws of hyperelastic solids at arrays of deformation gradients."""

# ruff: noqa: N803, N806 - F, P, A and J are the letters of the field

import inspect
import sys

import numpy as np

from resilin import _core
from resilin.arrays import is_tensor, real_array, refuse, result_array, square_matrices
from resilin.constants import batch_law, common_shape, number_array, own_constants, unit_fibres

PROJECTIONS = {
    None: _core.Projection.none,
    "clamp": _core.Projection.clamp,
    "absolute": _core.Projection.absolute,
}


def laws():
    """Every law by name, {name: LawInfo}: formula, source, constants with units, behaviour under inversion."""
    return {law.name: law for law in _core.laws()}


class Material:
    """A hyperelastic law with its constants.

    Methods take deformation gradients F of any leading shape, ``(..., d, d)`` with d = 3, or 2 for plane strain, as
    numpy arrays or torch tensors in float64 or float32, and give the same kind back. In between everything is computed
    in double. C-contiguous arrays are read where they lie; all others are copied first. Whole numbers are read as
    float64. A state outside the law's domain (J <= 0 under a logarithm, nan) gives inf or nan for itself alone.

    Parameters
    ----------
    law : str
        A name from the table below.
    youngs_modulus, poissons_ratio : float or array or tensor
        [Pa], [-]. Those of the small-strain solid, whatever the law; they become the constants of its formula.
    fibres : array (families, 3) or (..., families, 3), optional
        Directions at rest, for laws that have fibres; two components lie in the plane.
    **constants : float or array or tensor
        Constants of the law's formula by name, instead of youngs_modulus and poissons_ratio, or beside them where the
        table says so. An array holds one value for every state; its shape broadcasts against the leading shape of F.
        Tensors that require grad are differentiated through.

    Raises
    ------
    InputError
        A ValueError that says in one line what was expected and what came.

    Examples
    --------
    >>> law = resilin.Material("neo_hookean", youngs_modulus=1e6, poissons_ratio=0.45)
    >>> P = law.first_piola_kirchhoff_stress(F)
    """

    def __init__(self, law, *, youngs_modulus=None, poissons_ratio=None, fibres=None, **constants):
        if not isinstance(law, str):
            refuse("law", "a name", repr(law))
        self._info = _core.require_law(law, "law")
        given = {"youngs_modulus": youngs_modulus, "poissons_ratio": poissons_ratio, **constants}
        given = {name: value for name, value in given.items() if value is not None}
        self.tensors = {}  # the given constants that autograd follows
        if any(is_tensor(value) for value in (*given.values(), fibres)):
            given, self.tensors, fibres = _for_tensors().split_constants(law, given, fibres)
        self._given = {name: number_array(value, f"{law}.{name}") for name, value in given.items()}
        self._fibres = unit_fibres(fibres, self._info)
        self._own = self._law = self._checked_versions = None
        if self.tensors:
            self.states_shape = () if self._fibres is None else self._fibres.shape[:-2]
            self._conversion = None
            if "youngs_modulus" in given or "youngs_modulus" in self.tensors:
                self._conversion = _for_tensors().conversion_from_young_poisson(self._given, self.tensors, self._info)
            self.tensor_constants()
            return
        self._own = own_constants(self._info, self._given)
        for array in self._own.values():
            array.flags.writeable = False
        self.states_shape = _states_shape(self._own, self._fibres, law)
        self._law = batch_law(self._info, self._own.values(), self._fibres, self.states_shape)

    @property
    def law(self):
        """The law's name."""
        return self._info.name

    @property
    def info(self):
        """Formula, source, constants with units and bounds, behaviour under inversion (LawInfo)."""
        return self._info

    @property
    def constants(self):
        """The constants of the law's formula in its order: floats, arrays, or tensors where one requires grad."""
        if self.tensors:
            names = (constant.name for constant in self._info.constants)
            return dict(zip(names, self.tensor_constants(), strict=True))
        return {name: float(array) if array.ndim == 0 else array for name, array in self._own.items()}

    @property
    def fibres(self):
        """Unit vectors of the fibre families, (..., families, 3), or None."""
        return self._fibres

    def energy_density(self, F, *, displacement_gradient=False, out=None):
        """Strain energy density Psi [J/m^3].

        Parameters
        ----------
        F : array (..., d, d)
        displacement_gradient : bool
            Whether `F` holds H = F - I, which keeps all digits at small strain.
        out : array (...), optional
            Where the result goes; its type is that of F.

        Returns
        -------
        array (...)
            Zero at rest; inf outside the law's domain.
        """
        if is_tensor(F):
            return _for_tensors().energy_density(self, F, displacement_gradient, out)
        F, batch, law = self._states(F)
        psi = result_array(out, batch, F)
        law.energy_densities(F, displacement_gradient, psi)
        return psi if batch else psi[()]

    def first_piola_kirchhoff_stress(self, F, *, displacement_gradient=False, out=None):
        """First Piola-Kirchhoff stress P = dPsi/dF [Pa].

        Parameters are those of `energy_density`; the result and `out` are (..., d, d), nan outside the law's domain.
        """
        if is_tensor(F):
            return _for_tensors().first_piola_kirchhoff_stress(self, F, displacement_gradient, out)
        F, _, law = self._states(F)
        P = result_array(out, F.shape, F)
        law.first_piola_kirchhoff_stresses(F, displacement_gradient, P)
        return P

    def stress_tangent(self, F, projection=None, *, displacement_gradient=False, out=None):
        """Derivative of the stress, dP_ij/dF_kl [Pa], with indices in the order i, j, k, l.

        Parameters
        ----------
        F : array (..., d, d)
        projection : None, "clamp" or "absolute"
            What becomes of the negative eigenvalues of the tangent as a matrix of d^2 rows: nothing, zero, or their
            absolute values.
        displacement_gradient, out
            As in `energy_density`.

        Returns
        -------
        array (..., d, d, d, d)
        """
        if is_tensor(F):
            return _for_tensors().stress_tangent(self, F, projection, displacement_gradient, out)
        kind = projection_named(projection)
        F, _, law = self._states(F)
        A = result_array(out, F.shape + F.shape[-2:], F)
        law.stress_tangents(F, displacement_gradient, kind, A)
        return A

    def elastic_forces(self, F, Dm_inv, volume, *, displacement_gradient=False, out=None):
        """Forces on the corners of tetrahedra or triangles [N]: f_a = -V P dN_a/dX.

        Parameters
        ----------
        F : array (..., d, d)
        Dm_inv : array (..., d, d)
            Inverse of the matrix whose columns are the edges at rest from corner 0 [1/m].
        volume : array (...)
            At rest [m^3]; in 2D the area [m^2], for unit thickness.
        displacement_gradient, out
            As in `energy_density`.

        Returns
        -------
        array (..., d + 1, d)
            One row for each corner, which sum to zero.
        """
        if is_tensor(F):
            return _for_tensors().elastic_forces(self, F, Dm_inv, volume, displacement_gradient, out)
        arrays = (square_matrices(F, "F"), square_matrices(Dm_inv, "Dm_inv"), real_array(volume, "volume"))
        (F, Dm_inv, volume), batch, law = self._cells(*arrays)
        dim = F.shape[-1]
        forces = result_array(out, (*batch, dim + 1, dim), F, (Dm_inv, volume))
        law.elastic_forces(F, displacement_gradient, Dm_inv, volume, forces)
        return forces

    def constant_derivatives(self, F, *, displacement_gradient=False):
        """Derivatives with respect to each constant p of the law's formula.

        Returns
        -------
        dict
            {name: (dPsi/dp, dP/dp)}, arrays (...) and (..., d, d).
        """
        if is_tensor(F):
            return _for_tensors().constant_derivatives(self, F, displacement_gradient)
        F, batch, law = self._states(F)
        derivatives = {}
        for place, constant in enumerate(self._info.constants):
            dpsi, dP = np.empty(batch, F.dtype), np.empty_like(F)
            law.constant_derivatives(F, displacement_gradient, place, dpsi, dP)
            derivatives[constant.name] = (dpsi if batch else dpsi[()], dP)
        return derivatives

    def cauchy_stress(self, F, *, displacement_gradient=False):
        """Cauchy stress sigma = P F^T / J [Pa], (..., 3, 3) also in plane strain.

        For a small-strain law it is the stress itself.
        """
        if is_tensor(F):
            return _for_tensors().cauchy_stress(self, F, displacement_gradient)
        F = square_matrices(F, "F")
        in_space = (
            np.zeros((*F.shape[:-2], 3, 3)) if displacement_gradient else np.tile(np.eye(3), (*F.shape[:-2], 1, 1))
        )
        in_space[..., : F.shape[-1], : F.shape[-1]] = F
        sigma = self.first_piola_kirchhoff_stress(in_space, displacement_gradient=displacement_gradient)
        if not self._info.is_small_strain:
            if displacement_gradient:
                in_space += np.eye(3)
            with np.errstate(all="ignore"):  # nan and inf are results here
                sigma = sigma @ in_space.swapaxes(-1, -2) / np.linalg.det(in_space)[..., None, None]
        return sigma.astype(F.dtype, copy=False)

    def curve(self, kind, stretches=None):
        """Stress over stretch of a block of the material, with the free directions solved.

        Parameters
        ----------
        kind : "uniaxial", "equibiaxial", "planar", "shear" or "volumetric"
            F = diag(l, x, y), diag(l, l, x), diag(l, x, 1), I + l e1 (x) e2 or l I; the directions x and y are free
            of stress.
        stretches : array (N,), optional
            Positive numbers l; amounts of shear for "shear". Otherwise 61 from 0.5 to 2, or from 0 to 1.5.

        Returns
        -------
        StretchCurve
            Arrays stretch, nominal_stress, cauchy_stress [Pa], volume_ratio, energy_density [J/m^3], is_stable;
            plot(), to_csv(path), to_json(path). Warns where stability is lost.
        """
        from resilin.curve import stretch_curve

        return stretch_curve(self, kind, stretches)

    def __repr__(self):
        parts = [repr(self.law)]
        for name, value in self.constants.items():
            parts.append(f"{name}={value:.6g}" if isinstance(value, float) else f"{name}=<{tuple(value.shape)}>")
        if self._fibres is not None:
            parts.append(f"fibres=<{self._fibres.shape}>")
        return f"Material({', '.join(parts)})"

    def __reduce__(self):
        return _rebuild, (self.law, {**self._given, **self.tensors}, self._fibres)

    def tensor_constants(self):
        """The law's own constants as tensors that depend on the given ones; none when nothing requires grad."""
        if not self.tensors:
            return []
        versions = [tensor._version for tensor in self.tensors.values()]
        if versions != self._checked_versions:  # an optimiser has been at work
            _for_tensors().check_constants(self._given, self.tensors, self._info)
            self._checked_versions = versions
        return _for_tensors().own_tensors(self._given, self.tensors, self._conversion, self._info)

    def law_for(self, batch):
        """The core's law for states of the leading shape `batch`."""
        if not self.states_shape or batch == self.states_shape:
            return self._law
        return batch_law(self._info, self._own.values(), self._fibres, batch)

    def _states(self, F):
        """F ready for the core, its leading shape, and the law for it."""
        F = square_matrices(F, "F")
        batch = F.shape[:-2]
        if self._law is None:
            self._refuse_array()
        if not self.states_shape or batch == self.states_shape:
            return F, batch, self._law
        batch = self._batch({"F": batch})
        return np.ascontiguousarray(np.broadcast_to(F, (*batch, *F.shape[-2:]))), batch, self.law_for(batch)

    def _cells(self, F, Dm_inv, volume):
        """The same for three arrays, which take one type and one leading shape."""
        if self._law is None:
            self._refuse_array()
        if Dm_inv.shape[-1] != F.shape[-1]:
            refuse("Dm_inv", f"matrices as large as those of F, {F.shape[-2:]}", f"{Dm_inv.shape[-2:]}")
        batch = F.shape[:-2]
        is_one_type = F.dtype is Dm_inv.dtype is volume.dtype
        if is_one_type and F.shape == Dm_inv.shape and batch == volume.shape and self.states_shape in ((), batch):
            return (F, Dm_inv, volume), batch, self._law
        batch = self._batch({"F": batch, "Dm_inv": Dm_inv.shape[:-2], "volume": volume.shape})
        dtype = np.result_type(F, Dm_inv, volume)
        cells = [(F, (*batch, *F.shape[-2:])), (Dm_inv, (*batch, *F.shape[-2:])), (volume, batch)]
        cells = tuple(np.ascontiguousarray(np.broadcast_to(array, shape), dtype) for array, shape in cells)
        return cells, batch, self.law_for(batch)

    def _batch(self, shapes):
        """The leading shape that arguments, {name: leading shape}, and the constants take together."""
        try:
            return np.broadcast_shapes(*shapes.values(), self.states_shape)
        except ValueError:
            got = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
            refuse("F", f"leading shapes that go together and with the constants' {self.states_shape}", got)

    def _refuse_array(self):
        names = " and ".join(self.tensors)
        refuse("F", f"a torch tensor because {names} requires grad", "a numpy array", "use torch.from_numpy(F)")


def _states_shape(own, fibres, law):
    shapes = dict(own)
    if fibres is not None:
        shapes["fibres"] = fibres[..., 0, 0]
    return common_shape(shapes, law)


def number_constants(material):
    """The constants of a material for what autograd cannot follow: a body or a simulation."""
    if material.tensors:
        names = " and ".join(material.tensors)
        refuse(f"material.{names}", "numbers or arrays", "tensors that require grad", "use .detach()")
    return material.constants


def projection_named(name):
    """The core's Projection of this name."""
    if name not in PROJECTIONS:
        refuse("projection", 'None, "clamp" or "absolute"', repr(name))
    return PROJECTIONS[name]


_tensors = None


def _for_tensors():
    """The part for torch, imported when the first tensor comes."""
    global _tensors  # noqa: PLW0603 - asked for at every call: an import statement costs half a microsecond
    if _tensors is None:
        from resilin import tensors as _tensors
    return _tensors


def _rebuild(law, constants, fibres):
    return Material(law, fibres=fibres, **constants)


def _law_table():
    """What help(Material) says about each law."""
    lines = ["Laws", "----"]
    for law in laws().values():
        lines += [law.name, f"    Psi = {law.formula}", *(f"    {_described(constant)}" for constant in law.constants)]
        if law.max_fibres > 0:
            lines.append(f"    Fibres: up to {law.max_fibres} families.")
        if law.only_poissons_ratio is not None:
            lines.append(f"    Poisson's ratio: {law.only_poissons_ratio:g} only.")
        lines += [f"    Inversion: {law.inversion}.", f"    Source: {law.source}."]
    return "\n".join(lines) + "\n"


def _described(constant):
    text = f"{constant.name} = {constant.meaning}: {constant.range}"
    if constant.is_free:
        text += ", also beside youngs_modulus and poissons_ratio"
    return text if constant.fallback is None else text + f"; {constant.fallback:g} unless given"


if sys.flags.optimize < 2:  # there are docstrings
    Material.__doc__ = inspect.cleandoc(Material.__doc__) + "\n\n" + _law_table()
