"""The elastic energy of a mesh: value, gradient and Hessian as functions of the positions."""

import numpy as np

from resilin import _core
from resilin.arrays import describe, real_array, refuse
from resilin.material import PROJECTIONS, number_constants
from resilin.mesh import warn


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

    def __init__(self, mesh, material, element=None, quadrature="", dimension=None):
        self._dim = mesh.dimension if dimension is None else dimension
        if self._dim not in (2, 3):
            refuse("dimension", "2 or 3", repr(dimension))
        element = element or _element_of(mesh)
        kind = _core.element_cells(element, self._dim)
        core = mesh._core.corners_only() if element == "P1" else mesh._core
        solid = core.prepared(self._dim)
        warn(solid.warnings[len(mesh._core.warnings) :])
        if element.startswith("P2"):
            solid = solid.second_order()
        self._cells = dict(solid.cells()).get(kind)
        if self._cells is None:
            kinds = ", ".join(other.name for other, _ in solid.cells())
            refuse(
                "element", "P1, P2 or P2P0 on triangles and tetrahedra, Q1 or Q1P0 on others", f"{element} on {kinds}"
            )
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
    def rest_positions(self):
        """(N, d) [m]; a copy."""
        return self._rest_positions.copy()

    @property
    def cells(self):
        """Nodes of each cell (M, nodes); a copy, with positive volumes at rest."""
        return self._cells.copy()

    @property
    def material(self):
        """The material that the body was made with."""
        return self._material

    @property
    def element(self):
        """Name of the element, such as "P2"."""
        return self._element

    @property
    def quadrature(self):
        """Name of the quadrature rule, such as "4-point"."""
        return self._core.quadrature

    @property
    def point_volumes(self):
        """Rest volume that each quadrature point stands for [m^3]: (M,), or (M, Q) for Q points in a cell."""
        return self._of_points(self._core.point_volumes())

    @property
    def rest_volumes(self):
        """(M,) [m^3], in 2D areas [m^2]."""
        return self._core.rest_volumes()

    def value(self, x):
        """Energy [J] at positions `x` (N, d); zero at rest, inf outside the law's domain."""
        return self._core.value(self._positions(x))

    def gradient(self, x):
        """Derivative of the energy (N, d) [N]; the elastic forces are its negative."""
        return self._core.gradient(self._positions(x))

    def hessian(self, x, projection=None, as_triplets=False):
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
        if projection not in PROJECTIONS:
            refuse("projection", 'None, "clamp" or "absolute"', repr(projection))
        values, columns, row_begin = self._core.hessian(self._positions(x), PROJECTIONS[projection])
        if as_triplets:
            rows = np.repeat(np.arange(len(row_begin) - 1, dtype=np.int32), np.diff(row_begin))
            return rows, columns, values
        return _csr_matrix(values, columns, row_begin)

    def mass(self, density=1000.0, kind="lumped"):
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

    def max_step(self, x, p):
        """The largest t in (0, 1] such that no cell loses more than nine tenths of its volume along x + t p.

        For laws that need J > 0; others give 1. `x` and `p` are (N, d).
        """
        return self._core.max_step(self._positions(x), self._positions(p, "p"))

    def volume_ratios(self, x):
        """J = det F at each point (M,) or (M, Q)."""
        return self._of_points(self._core.volume_ratios(self._positions(x)))

    def energy_densities(self, x):
        """Psi at each point (M,) or (M, Q) [J/m^3]."""
        return self._of_points(self._core.energy_densities(self._positions(x)))

    def deformation_gradients(self, x):
        """F at each point (M, d, d) or (M, Q, d, d)."""
        gradients = self._of_points(self._core.deformation_gradients(self._positions(x)))
        return gradients[..., : self._dim, : self._dim]

    def cauchy_stresses(self, x):
        """Cauchy stress at each point (M, 3, 3) or (M, Q, 3, 3) [Pa]; in 2D with the stress across the plane."""
        return self._of_points(self._core.cauchy_stresses(self._positions(x)))

    def von_mises(self, x):
        """Von Mises stress at each point (M,) or (M, Q) [Pa]."""
        return self._of_points(self._core.von_mises_stresses(self._positions(x)))

    def _of_points(self, values):
        points = self._core.num_points
        return values if points == 1 else values.reshape(-1, points, *values.shape[1:])

    def _positions(self, x, place="x"):
        x = real_array(x, place)
        if x.shape != self._rest_positions.shape:
            refuse(place, f"an array {describe(self._rest_positions.shape)}", describe(x.shape))
        return x.astype(np.float64, copy=False)

    def __repr__(self):
        return f"<resilin.Elastic {self._material.law}: {len(self._cells)} cells, {self._rest_positions.size} unknowns>"


def _element_of(mesh):
    kinds = mesh.cells_by_kind
    if "hexahedron" in kinds or ("quadrilateral" in kinds and mesh.dimension == 2):
        return "Q1"
    return "P2" if "tetrahedron10" in kinds or ("triangle6" in kinds and mesh.dimension == 2) else "P1"


def _constant_rows(constants, num_cells):
    """The law's constants, (1, C) or (M, C) when some differ from cell to cell."""
    columns = []
    for name, value in constants.items():
        column = np.asarray(real_array(value, f"material.{name}"), dtype=np.float64)
        if column.ndim > 1 or (column.ndim == 1 and len(column) not in (1, num_cells)):
            refuse(f"material.{name}", f"one number, or one for each of {num_cells} cells", describe(column.shape))
        columns.append(column)
    return np.ascontiguousarray(np.stack(np.broadcast_arrays(*map(np.atleast_1d, columns)), axis=-1))


def _fibre_rows(material, num_cells):
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


def _csr_matrix(values, columns, row_begin):
    from scipy.sparse import csr_matrix  # takes longer to import than all else

    size = len(row_begin) - 1
    matrix = csr_matrix((values, columns, row_begin), shape=(size, size))
    matrix.has_canonical_format = True
    return matrix
