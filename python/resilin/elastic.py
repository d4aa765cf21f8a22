"""The elastic energy of a mesh: value, gradient and Hessian as functions of the positions."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

import numpy as np

from resilin import _core
from resilin.arrays import describe, real_array, refuse
from resilin.catalog import projection_named
from resilin.embedding import elements_by_kind
from resilin.material import number_constants
from resilin.mesh import warn

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Literal

    from numpy.typing import NDArray
    from scipy.sparse import csr_matrix

    from resilin.material import Material
    from resilin.mesh import Mesh
    from resilin.typing import MassKind, Projection, RealArray, Triplets


class Elastic:
    """Strain energy of a body as a function of its positions, E(x) = sum over cells of V Psi(F(x)).

    Quantities of points are (M, ...) for M cells, or (M, Q, ...) where the element has Q > 1 quadrature points.
    Positions are arrays (N, d) in metres, d = 3, or 2 for plane strain at unit thickness. A state outside the law's
    domain (J <= 0 under a logarithm) has the energy inf, and nan in gradient and Hessian.

    Parameters
    ----------
    mesh : Mesh
    material : Material
        Its constants may be arrays (M,) and its fibres (M, families, 3), one value for each cell.
    element : "P1", "P2", "P2P0", "Q1" or "Q1P0", optional
        P on triangles and tetrahedra, Q on quadrilaterals and hexahedra. By default the one whose nodes the mesh has:
        P1, P2 or Q1. P2 adds nodes in the middle of the edges of a linear mesh, after its vertices.
    quadrature : str, optional
        Rule of the points at which the energy is sampled, such as "4-point" or "exact"; by default the element's own.
    dimension : 2 or 3, optional
        By default that of the mesh.

    Raises
    ------
    InputError
        When the mesh or a constant cannot be used, with the reason.
    """

    def __init__(
        self,
        mesh: Mesh,
        material: Material,
        element: str | None = None,
        quadrature: str = "",
        dimension: int | None = None,
    ) -> None:
        self._dim = mesh.dimension if dimension is None else dimension
        if self._dim not in (2, 3):
            refuse("dimension", "2 or 3", repr(dimension))
        element = element or _element_of(mesh)
        kind = _core.element_cells(element, self._dim)
        is_second_order = _core.is_second_order(kind)
        core = mesh._core if is_second_order else mesh._core.corners_only()
        solid = core.prepared(self._dim)
        warn(solid.warnings[len(mesh._core.warnings) :])
        if is_second_order:
            solid = solid.second_order()
        cells = dict(solid.cells()).get(kind)
        if cells is None:
            kinds = ", ".join(other.name for other, _ in solid.cells())
            refuse("element", f"{kind.name} cells for {element}", f"{element} on {kinds}")
        self._cells = cells
        self._rest_positions = np.ascontiguousarray(solid.positions()[:, : self._dim])
        constants = _constant_rows(number_constants(material), len(self._cells))
        fibres, num_families = _fibre_rows(material, len(self._cells))
        self._material = material
        self._core = _core.ElasticBody(
            self._dim,
            element,
            quadrature,
            self._rest_positions,
            self._cells,
            material.law,
            constants,
            fibres,
            num_families,
        )
        self._element = element

    @property
    def rest_positions(self) -> NDArray[np.float64]:
        """(N, d) [m]; a copy."""
        return self._rest_positions.copy()

    @property
    def cells(self) -> NDArray[np.int32]:
        """Nodes of each cell (M, nodes); a copy, with positive volumes at rest."""
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
        """Rest volume that each quadrature point stands for [m^3]: (M,), or (M, Q) for Q points in a cell."""
        return self._of_points(self._core.point_volumes())

    @property
    def rest_volumes(self) -> NDArray[np.float64]:
        """(M,) [m^3], in 2D areas [m^2]."""
        return self._core.rest_volumes()

    def value(self, x: RealArray) -> float:
        """Energy [J] at positions `x` (N, d); zero at rest, inf outside the law's domain."""
        return self._core.value(self._positions(x))

    def gradient(self, x: RealArray) -> NDArray[np.float64]:
        """Derivative of the energy (N, d) [N]; the elastic forces are its negative."""
        return self._core.gradient(self._positions(x))

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

    def hessian(self, x: RealArray, projection: Projection = None, as_triplets: bool = False) -> csr_matrix | Triplets:
        """Second derivative of the energy [N/m].

        Parameters
        ----------
        x : array (N, d)
        projection : None, "clamp" or "absolute"
            What becomes of the negative eigenvalues of each cell's Hessian: nothing, zero, or their absolute values.
        as_triplets : bool

        Returns
        -------
        scipy.sparse.csr_matrix (N d, N d)
            Unknowns vertex by vertex, x.ravel(); symmetric, columns ascending. The pattern does not depend on `x`.
        (i, j, v)
            With `as_triplets`: rows, columns and values; each entry once.
        """
        kind = projection_named(projection)
        values, columns, row_begin = self._core.hessian(self._positions(x), kind)
        if as_triplets:
            rows = np.repeat(np.arange(len(row_begin) - 1, dtype=np.int32), np.diff(row_begin))
            return rows, columns, values
        return _csr_matrix(values, columns, row_begin)

    def mass(self, density: float = 1000.0, kind: MassKind = "lumped") -> csr_matrix:
        """Mass matrix [kg].

        Parameters
        ----------
        density : float
            [kg/m^3] of the rest shape.
        kind : "lumped" or "consistent"
            A diagonal matrix, each vertex with its share of its cells; or that of the shape functions.

        Returns
        -------
        scipy.sparse.csr_matrix (N d, N d)
        """
        if kind not in ("lumped", "consistent"):
            refuse("kind", '"lumped" or "consistent"', repr(kind))
        if not (np.isfinite(density) and density > 0):
            refuse("density", "a number above 0 kg/m^3", repr(density))
        matrix = _csr_matrix(*self._core.mass(float(density), kind == "consistent"))
        matrix.eliminate_zeros()
        return matrix

    def max_step(self, x: RealArray, p: RealArray) -> float:
        """The largest t in (0, 1] such that no cell loses more than nine tenths of its volume along x + t p.

        For laws that need J > 0; others give 1. `x` and `p` are (N, d).
        """
        return self._core.max_step(self._positions(x), self._positions(p, "p"))

    def volume_ratios(self, x: RealArray) -> NDArray[np.float64]:
        """J = det F at each point (M,) or (M, Q)."""
        return self._of_points(self._core.volume_ratios(self._positions(x)))

    def energy_densities(self, x: RealArray) -> NDArray[np.float64]:
        """Psi at each point (M,) or (M, Q) [J/m^3]."""
        return self._of_points(self._core.energy_densities(self._positions(x)))

    def deformation_gradients(self, x: RealArray) -> NDArray[np.float64]:
        """F at each point (M, d, d) or (M, Q, d, d)."""
        gradients = self._of_points(self._core.deformation_gradients(self._positions(x)))
        return gradients[..., : self._dim, : self._dim]

    def cauchy_stresses(self, x: RealArray) -> NDArray[np.float64]:
        """Cauchy stress at each point (M, 3, 3) or (M, Q, 3, 3) [Pa]; in 2D with the stress across the plane."""
        return self._of_points(self._core.cauchy_stresses(self._positions(x)))

    def von_mises(self, x: RealArray) -> NDArray[np.float64]:
        """Von Mises stress at each point (M,) or (M, Q) [Pa]."""
        return self._of_points(self._core.von_mises_stresses(self._positions(x)))

    def _of_points(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        points = self._core.num_points
        return values if points == 1 else values.reshape(-1, points, *values.shape[1:])

    def _positions(self, x: object, place: str = "x") -> NDArray[np.float64]:
        positions = real_array(x, place)
        if positions.shape != self._rest_positions.shape:
            refuse(place, f"an array {describe(self._rest_positions.shape)}", describe(positions.shape))
        return positions.astype(np.float64, copy=False)

    def __repr__(self) -> str:
        return f"<resilin.Elastic {self._material.law}: {len(self._cells)} cells, {self._rest_positions.size} unknowns>"


def _element_of(mesh: Mesh) -> str:
    elements = elements_by_kind(mesh.dimension)
    found = [element for kind, element in elements.items() if kind in mesh.cells_by_kind]
    # Of several kinds the last of the catalogue; a mesh without any is refused later, with its own kinds.
    return found[-1] if found else next(iter(elements.values()))


def _constant_rows(constants: Mapping[str, object], num_cells: int) -> NDArray[np.float64]:
    """The law's constants, (1, C) or (M, C) when some differ from cell to cell."""
    columns = []
    for name, value in constants.items():
        column = np.asarray(real_array(value, f"material.{name}"), dtype=np.float64)
        if column.ndim > 1 or (column.ndim == 1 and len(column) not in (1, num_cells)):
            refuse(f"material.{name}", f"one number, or one for each of {num_cells} cells", describe(column.shape))
        columns.append(column)
    return np.ascontiguousarray(np.stack(np.broadcast_arrays(*map(np.atleast_1d, columns)), axis=-1))


def _fibre_rows(material: Material, num_cells: int) -> tuple[NDArray[np.float64], int]:
    """Directions (K, 3), each family once or those of one cell after another, and the number of families."""
    fibres, max_families = material.fibres, material.info.max_fibres
    if fibres is None:
        if max_families > 0:
            refuse("material.fibres", f"1 to {max_families} directions", "none", "for example fibres=[[1, 0, 0]]")
        return np.empty((0, 3)), 0
    if fibres.ndim > 3 or (fibres.ndim == 3 and len(fibres) not in (1, num_cells)):
        expected = f"directions (families, 3), or ({num_cells}, families, 3) for the cells"
        refuse("material.fibres", expected, describe(fibres.shape))
    return fibres.reshape(-1, 3), fibres.shape[-2]


def _csr_matrix(values: NDArray[np.float64], columns: NDArray[np.int32], row_begin: NDArray[np.int32]) -> csr_matrix:
    from scipy.sparse import csr_matrix  # takes longer to import than all else

    size = len(row_begin) - 1
    matrix = csr_matrix((values, columns, row_begin), shape=(size, size))
    matrix.has_canonical_format = True
    return matrix
