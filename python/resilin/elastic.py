"""The elastic energy of a mesh: value, gradient and Hessian as functions of the positions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy as np

from resilin import _core
from resilin.arrays import describe, is_tensor, plain_text, real_array, refuse, require_instance
from resilin.body_parts import constant_rows, csr_matrix_of, element_of, fibre_rows
from resilin.catalog import projection_named
from resilin.law_at_arrays import LawAtArrays
from resilin.material import Material
from resilin.mesh import Mesh, warn

if TYPE_CHECKING:
    from typing import Literal, TypeVar

    from numpy.typing import NDArray
    from scipy.sparse import csr_matrix

    from resilin.elastic_at_tensors import ElasticAtTensors
    from resilin.typing import MassKind, Projection, RealArray, TensorLike, Triplets

    T = TypeVar("T")  # the class of the tensors
    Floats = NDArray[np.float64]


class Elastic:
    """Strain energy of a body as a function of its positions, E(x) = sum over cells of V Psi(F(x)).

    Positions are arrays (N, d) in metres, d = 3, or 2 for plane strain at unit thickness. Quantities at quadrature
    points have the shape (M, ...) for M cells, or (M, Q, ...) for elements with Q > 1 points. A state outside the
    domain of the model (J <= 0 under a logarithm) has the energy inf, and nan in gradient and Hessian.

    Torch tensors give tensors. Autograd differentiates `value` twice and `gradient` once, by positions and by material
    constants that require grad. It also differentiates quantities at quadrature points. For mixed elements (P2P0, Q1P0)
    only `value` and `gradient` are differentiable, by positions. `hessian` and `max_step` are not.

    Parameters
    ----------
    mesh : Mesh
    material : Material
        Its constants may be arrays (M,) and its fibres (M, families, 3), one value for each cell.
    element : "P1", "P2", "P2P0", "Q1" or "Q1P0", optional
        P on triangles and tetrahedra, Q on quadrilaterals and hexahedra. The default is the element with the nodes of
        the mesh: P1, P2 or Q1. P2 appends mid-edge nodes of a linear mesh after its vertices.
    quadrature : str, optional
        Quadrature rule, such as "4-point" or "exact"; by default that of the element.
    dimension : 2 or 3, optional
        By default that of the mesh.

    Raises
    ------
    InputError
        If the mesh or a constant cannot be used, with the reason.
    """

    def __init__(
        self,
        mesh: Mesh,
        material: Material,
        element: str | None = None,
        quadrature: str = "",
        dimension: int | None = None,
    ) -> None:
        require_instance(mesh, Mesh, "mesh")
        require_instance(material, Material, "material")
        self._dim = mesh.dimension if dimension is None else dimension
        if self._dim not in (2, 3):
            refuse("dimension", "2 or 3", repr(dimension))
        self._element = plain_text(element or element_of(mesh), "element")
        self._quadrature = plain_text(quadrature, "quadrature")
        kind = _core.element_cells(self._element, self._dim)
        is_second_order = _core.is_second_order(kind)
        core = mesh._core if is_second_order else mesh._core.corners_only()
        solid = core.prepared(self._dim)
        warn(solid.warnings[len(mesh._core.warnings) :])
        if is_second_order:
            solid = solid.second_order()
        cells = dict(solid.cells()).get(kind)
        if cells is None:
            kinds = ", ".join(other.name for other, _ in solid.cells())
            refuse("element", f"{kind.name} cells for {self._element}", f"{self._element} on {kinds}")
        self._material = material
        self._cells = cells
        self._rest_positions = np.ascontiguousarray(solid.positions()[:, : self._dim])
        self._make_core()

    def _make_core(self) -> None:
        self._tensor_body: ElasticAtTensors | None = None  # made when it is needed
        self._versions: list[int] = []  # versions of the constants that `_core` was made with
        law = self._material._law
        if isinstance(law, LawAtArrays):
            self._core = self._core_with(law.own)
            return
        from resilin.tensor_constants import constants_of_a_unit_solid

        numbers = law.numbers()
        self._core = self._core_with(constants_of_a_unit_solid(law.info) if numbers is None else numbers)
        if numbers is not None:
            self._versions = law.versions()
        self._at_tensors()

    def _core_with(self, constants: dict[str, Floats]) -> _core.ElasticBody:
        fibres, num_families = fibre_rows(self._material, len(self._cells))
        return _core.ElasticBody(
            self._dim,
            self._element,
            self._quadrature,
            self._rest_positions,
            self._cells,
            self._material.law,
            constant_rows(constants, len(self._cells)),
            fibres,
            num_families,
        )

    def _core_of_numbers(self) -> _core.ElasticBody:
        """The core's body with the constants as they are now: an optimiser may have changed those that are tensors."""
        law = self._material._law
        if not isinstance(law, LawAtArrays) and law.versions() != self._versions:
            numbers = law.numbers()
            if numbers is not None:
                self._core, self._versions = self._core_with(numbers), law.versions()
        return self._core

    @property
    def rest_positions(self) -> NDArray[np.float64]:
        """Reference positions (N, d) [m]; a copy."""
        return self._rest_positions.copy()

    @property
    def cells(self) -> NDArray[np.int32]:
        """Nodes of each cell (M, nodes); a copy, with positive reference volumes."""
        return self._cells.copy()

    @property
    def material(self) -> Material:
        """The material that the body was made with."""
        return self._material

    @property
    def element(self) -> str:
        """Name of the element, such as "P2"."""
        return self._element

    @property
    def quadrature(self) -> str:
        """Name of the quadrature rule, such as "4-point"."""
        return self._core.quadrature

    @property
    def point_volumes(self) -> NDArray[np.float64]:
        """Reference volume of each quadrature point [m^3]: (M,), or (M, Q) for Q points in a cell."""
        return self._of_points(self._core.point_volumes())

    @property
    def rest_volumes(self) -> NDArray[np.float64]:
        """Reference volume of each cell (M,) [m^3], in 2D area [m^2]."""
        return self._core.rest_volumes()

    @overload
    def value(self, x: TensorLike[T]) -> T: ...

    @overload
    def value(self, x: RealArray) -> float: ...

    def value(self, x: Any) -> Any:
        """Strain energy of the body.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        float, or a tensor of one number
            [J]; zero in the reference configuration, inf outside the domain of the model.
        """
        if is_tensor(x):
            return self._at_tensors().value(x)
        return self._core_at_arrays().value(self._positions(x))

    @overload
    def gradient(self, x: TensorLike[T]) -> T: ...

    @overload
    def gradient(self, x: RealArray) -> Floats: ...

    def gradient(self, x: Any) -> Any:
        """Derivative of the energy by the positions.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        array or tensor (N, d)
            [N]; the elastic forces are its negative.
        """
        if is_tensor(x):
            return self._at_tensors().gradient(x)
        return self._core_at_arrays().gradient(self._positions(x))

    @overload
    def hessian(self, x: TensorLike[T], projection: Projection = None, as_triplets: Literal[False] = False) -> T: ...

    @overload
    def hessian(
        self, x: TensorLike[T], projection: Projection = None, *, as_triplets: Literal[True]
    ) -> tuple[T, T, T]: ...

    @overload
    def hessian(
        self, x: RealArray, projection: Projection = None, as_triplets: Literal[False] = False
    ) -> csr_matrix: ...

    @overload
    def hessian(self, x: RealArray, projection: Projection = None, *, as_triplets: Literal[True]) -> Triplets: ...

    @overload
    def hessian(self, x: RealArray, projection: Projection, as_triplets: Literal[True]) -> Triplets: ...

    @overload
    def hessian(
        self, x: RealArray, projection: Projection = None, as_triplets: bool = False
    ) -> csr_matrix | Triplets: ...

    def hessian(self, x: Any, projection: Projection = None, as_triplets: bool = False) -> Any:
        """Second derivative of the energy [N/m].

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].
        projection : None, "clamp" or "absolute"
            Projection of negative eigenvalues of each cell's Hessian: none, to zero, or to their absolute values.
        as_triplets : bool
            Whether to return rows, columns and values.

        Returns
        -------
        scipy.sparse.csr_matrix (N d, N d), or for tensors torch.sparse_coo
            DOFs vertex by vertex, x.ravel(); symmetric, columns ascending. The pattern does not depend on `x`.
        (i, j, v)
            With `as_triplets`: rows, columns and values; each entry once.
        """
        kind = projection_named(projection)
        if is_tensor(x):
            body = self._at_tensors()
            return body.hessian(x, kind) if as_triplets else body.hessian_matrix(x, kind)
        values, columns, row_begin = self._core_at_arrays().hessian(self._positions(x), kind)
        if as_triplets:
            rows = np.repeat(np.arange(len(row_begin) - 1, dtype=np.int32), np.diff(row_begin))
            return rows, columns, values
        return csr_matrix_of(values, columns, row_begin)

    def mass(self, density: float = 1000.0, kind: MassKind = "lumped") -> csr_matrix:
        """Mass matrix [kg].

        Parameters
        ----------
        density : float
            [kg/m^3] in the reference configuration.
        kind : "lumped" or "consistent"
            Diagonal with a share of each adjacent cell, or consistent with the shape functions.

        Returns
        -------
        scipy.sparse.csr_matrix (N d, N d)
        """
        if kind not in ("lumped", "consistent"):
            refuse("kind", '"lumped" or "consistent"', repr(kind))
        if not (np.isfinite(density) and density > 0):
            refuse("density", "a number above 0 kg/m^3", repr(density))
        matrix = csr_matrix_of(*self._core.mass(float(density), kind == "consistent"))
        matrix.eliminate_zeros()
        return matrix

    @overload
    def max_step(self, x: TensorLike[T], p: TensorLike[T]) -> T: ...

    @overload
    def max_step(self, x: RealArray, p: RealArray) -> float: ...

    def max_step(self, x: Any, p: Any) -> Any:
        """Largest t in (0, 1] such that no cell loses more than nine tenths of its volume along x + t p.

        Applies to models that need J > 0; for others it is 1.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].
        p : array or tensor (N, d)
            Step of the positions [m].

        Returns
        -------
        float, or a tensor of one number
            Factor on `p`, without a unit.
        """
        if is_tensor(x):
            return self._at_tensors().max_step(x, p)
        return self._core_at_arrays().max_step(self._positions(x), self._positions(p, "p"))

    @overload
    def volume_ratios(self, x: TensorLike[T]) -> T: ...

    @overload
    def volume_ratios(self, x: RealArray) -> Floats: ...

    def volume_ratios(self, x: Any) -> Any:
        """Volume ratio J = det F at each quadrature point.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        array or tensor (M,), or (M, Q) for Q points in a cell
            Deformed over reference volume, without a unit.
        """
        if is_tensor(x):
            return self._at_tensors().volume_ratios(x)
        return self._of_points(self._core_at_arrays().volume_ratios(self._positions(x)))

    @overload
    def energy_densities(self, x: TensorLike[T]) -> T: ...

    @overload
    def energy_densities(self, x: RealArray) -> Floats: ...

    def energy_densities(self, x: Any) -> Any:
        """Strain energy density Psi at each quadrature point.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        array or tensor (M,) or (M, Q)
            [J/m^3] of reference volume.
        """
        if is_tensor(x):
            return self._at_tensors().energy_densities(x)
        return self._of_points(self._core_at_arrays().energy_densities(self._positions(x)))

    @overload
    def deformation_gradients(self, x: TensorLike[T]) -> T: ...

    @overload
    def deformation_gradients(self, x: RealArray) -> Floats: ...

    def deformation_gradients(self, x: Any) -> Any:
        """Deformation gradient F = dx/dX at each quadrature point.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        array or tensor (M, d, d) or (M, Q, d, d)
            Without a unit.
        """
        if is_tensor(x):
            return self._at_tensors().deformation_gradients(x)
        gradients = self._of_points(self._core_at_arrays().deformation_gradients(self._positions(x)))
        return gradients[..., : self._dim, : self._dim]

    @overload
    def cauchy_stresses(self, x: TensorLike[T]) -> T: ...

    @overload
    def cauchy_stresses(self, x: RealArray) -> Floats: ...

    def cauchy_stresses(self, x: Any) -> Any:
        """Cauchy stress at each quadrature point.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        array or tensor (M, 3, 3) or (M, Q, 3, 3)
            [Pa]; in 2D with the out-of-plane stress.
        """
        if is_tensor(x):
            return self._at_tensors().cauchy_stresses(x)
        return self._of_points(self._core_at_arrays().cauchy_stresses(self._positions(x)))

    @overload
    def von_mises(self, x: TensorLike[T]) -> T: ...

    @overload
    def von_mises(self, x: RealArray) -> Floats: ...

    def von_mises(self, x: Any) -> Any:
        """Von Mises stress at each quadrature point.

        Parameters
        ----------
        x : array or tensor (N, d)
            Positions [m].

        Returns
        -------
        array or tensor (M,) or (M, Q)
            [Pa]
        """
        if is_tensor(x):
            return self._at_tensors().von_mises(x)
        return self._of_points(self._core_at_arrays().von_mises_stresses(self._positions(x)))

    def _of_points(self, values: Floats) -> Floats:
        points = self._core.num_points
        return values if points == 1 else values.reshape(-1, points, *values.shape[1:])

    def _positions(self, x: object, place: str = "x") -> Floats:
        positions = real_array(x, place)
        if positions.shape != self._rest_positions.shape:
            refuse(place, f"an array {describe(self._rest_positions.shape)}", describe(positions.shape))
        return positions.astype(np.float64, copy=False)

    def _core_at_arrays(self) -> _core.ElasticBody:
        if self._material.tensors:
            names = " and ".join(self._material.tensors)
            cure = "use torch.from_numpy(x)"
            refuse("x", f"a torch tensor because the material's {names} requires grad", "a numpy array", cure)
        return self._core

    def _at_tensors(self) -> ElasticAtTensors:
        if self._tensor_body is None:
            from resilin.elastic_at_tensors import ElasticAtTensors

            self._tensor_body = ElasticAtTensors(
                self._core_of_numbers, self._core, self._rest_positions, self._cells, self._material._law
            )
        return self._tensor_body

    def __getstate__(self) -> dict[str, Any]:
        made_anew = ("_core", "_tensor_body", "_versions")
        return {name: value for name, value in vars(self).items() if name not in made_anew}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._make_core()

    def __repr__(self) -> str:
        return f"<resilin.Elastic {self._material.law}: {len(self._cells)} cells, {self._rest_positions.size} DOFs>"
