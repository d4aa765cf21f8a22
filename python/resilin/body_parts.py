"""Conversion of the data of a body for the core, and of results for scipy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from resilin.arrays import describe, real_array, refuse
from resilin.embedding import elements_by_kind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray
    from scipy.sparse import csr_matrix

    from resilin.material import Material
    from resilin.mesh import Mesh


def element_of(mesh: Mesh) -> str:
    elements = elements_by_kind(mesh.dimension)
    found = [element for kind, element in elements.items() if kind in mesh.cells_by_kind]
    # Among several kinds the last of the catalogue; a mesh without any is refused later, with its own kinds.
    return found[-1] if found else next(iter(elements.values()))


def constant_rows(constants: Mapping[str, object], num_cells: int) -> NDArray[np.float64]:
    """The law's constants, (1, C) or (M, C) when some differ from cell to cell."""
    columns = []
    for name, value in constants.items():
        column = np.asarray(real_array(value, f"material.{name}"), dtype=np.float64)
        if column.ndim > 1 or (column.ndim == 1 and len(column) not in (1, num_cells)):
            refuse(f"material.{name}", f"one number, or one for each of {num_cells} cells", describe(column.shape))
        columns.append(column)
    return np.ascontiguousarray(np.stack(np.broadcast_arrays(*map(np.atleast_1d, columns)), axis=-1))


def fibre_rows(material: Material, num_cells: int) -> tuple[NDArray[np.float64], int]:
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


def csr_matrix_of(values: NDArray[np.float64], columns: NDArray[np.int32], row_begin: NDArray[np.int32]) -> csr_matrix:
    from scipy.sparse import csr_matrix  # takes longer to import than all else

    size = len(row_begin) - 1
    matrix = csr_matrix((values, columns, row_begin), shape=(size, size))
    matrix.has_canonical_format = True
    return matrix
