"""Fine points carried by coarse cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from resilin import _core
from resilin.arrays import describe, real_array, refuse

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from resilin.mesh import Mesh
    from resilin.typing import RealArray

# The element whose shape functions the cells of a kind have.
ELEMENTS = {
    2: {"triangle": "P1", "triangle6": "P2", "quadrilateral": "Q1"},
    3: {"tetrahedron": "P1", "tetrahedron10": "P2", "hexahedron": "Q1"},
}


def embed(mesh: Mesh, points: RealArray) -> csr_array:
    """Weights that carry points by the vertices of a mesh: `embed(mesh, points) @ positions`.

    A point moves with the shape functions of the cell that contains it, a point outside with those of the nearest cell
    (docs/skin.md). Rows sum to one and reproduce affine maps exactly, also outside.

    Parameters
    ----------
    mesh : Mesh
        With solid cells of one kind, at rest.
    points : array (V, d)
        [m], at rest.

    Returns
    -------
    scipy.sparse.csr_array (V, N)

    Examples
    --------
    >>> weights = resilin.embed(mesh, skin.positions)
    >>> weights @ simulation.positions
    """
    import scipy.sparse

    points = np.asarray(real_array(points, "points"), dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != mesh.dimension:
        refuse("points", f"an array (V, {mesh.dimension})", describe(points.shape))
    kinds = [kind for kind in ELEMENTS[mesh.dimension] if kind in mesh.cells_by_kind]
    if len(kinds) != 1:
        refuse("mesh", f"cells of one kind of {', '.join(ELEMENTS[mesh.dimension])}", ", ".join(kinds) or "none")
    places = np.zeros((len(points), 3))
    places[:, : mesh.dimension] = points
    values, columns, row_begin = _core.embed(
        ELEMENTS[mesh.dimension][kinds[0]],
        np.ascontiguousarray(mesh.positions),
        np.ascontiguousarray(mesh.cells_by_kind[kinds[0]]),
        places,
    )
    return scipy.sparse.csr_array((values, columns, row_begin), shape=(len(points), len(mesh.positions)))
