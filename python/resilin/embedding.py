"""Fine points embedded in coarse cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from resilin import _core
from resilin.arrays import describe, real_array, refuse, require_instance
from resilin.mesh import Mesh

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from resilin.typing import RealArray


def elements_by_kind(dimension: int) -> dict[str, str]:
    """The element whose shape functions the cells of a kind have, by the name of the kind."""
    return {kind.name: element for kind, element in _core.kinds_with_elements(dimension)}


def embed(mesh: Mesh, points: RealArray) -> csr_array:
    """Interpolation weights of points embedded in a mesh: `embed(mesh, points) @ positions`.

    A point moves with the shape functions of the cell that contains it; a point outside uses the nearest cell
    (docs/skin.md). Rows sum to one and reproduce affine maps exactly, also outside.

    Parameters
    ----------
    mesh : Mesh
        Reference configuration, with solid cells of one kind.
    points : array (V, d)
        Reference positions [m].

    Returns
    -------
    scipy.sparse.csr_array (V, N)

    Examples
    --------
    >>> weights = resilin.embed(mesh, skin.positions)
    >>> weights @ simulation.positions
    """
    import scipy.sparse

    require_instance(mesh, Mesh, "mesh")
    points = np.asarray(real_array(points, "points"), dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != mesh.dimension:
        refuse("points", f"an array (V, {mesh.dimension})", describe(points.shape))
    elements = elements_by_kind(mesh.dimension)
    kinds = [kind for kind in elements if kind in mesh.cells_by_kind]
    if len(kinds) != 1:
        refuse("mesh", f"cells of one kind of {', '.join(elements)}", ", ".join(kinds) or "none")
    places = np.zeros((len(points), 3))
    places[:, : mesh.dimension] = points
    values, columns, row_begin = _core.embed(
        elements[kinds[0]],
        np.ascontiguousarray(mesh.positions),
        np.ascontiguousarray(mesh.cells_by_kind[kinds[0]]),
        places,
    )
    return scipy.sparse.csr_array((values, columns, row_begin), shape=(len(points), len(mesh.positions)))
