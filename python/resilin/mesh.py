"""Meshes from arrays, files, meshio objects and generators."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from resilin import _core
from resilin.arrays import describe, file_path, plain_text, real_array, refuse

if TYPE_CHECKING:
    from collections.abc import Iterable

    import meshio
    from numpy.typing import NDArray
    from typing_extensions import Self  # noqa: UP035 - not in typing of Python 3.10

    from resilin.typing import AnyPath, BoxPattern, IntegerArray, RealArray, RectanglePattern

    Kind = TypeVar("Kind", _core.TetPattern, _core.TrianglePattern)

# Names of meshio's cells; its order of nodes is ours but in second-order tetrahedra, whose last two are exchanged.
MESHIO_KINDS = {
    "vertex": "point",
    "line": "line",
    "triangle": "triangle",
    "quad": "quadrilateral",
    "tetra": "tetrahedron",
    "hexahedron": "hexahedron",
    "wedge": "prism",
    "pyramid": "pyramid",
    "line3": "line3",
    "triangle6": "triangle6",
    "tetra10": "tetrahedron10",
}


class MeshReport:
    """Findings about a mesh, one line each: `errors` prevent a simulation, `warnings` do not."""

    def __init__(self, errors: list[str], warnings: list[str]) -> None:
        self.errors = errors
        self.warnings = warnings

    def __bool__(self) -> bool:
        """True when there is no error."""
        return not self.errors

    def __repr__(self) -> str:
        lines = [f"error: {line}" for line in self.errors] + [f"warning: {line}" for line in self.warnings]
        return "\n".join(lines) or "nothing is wrong"


SPATIAL_KINDS = ("tetrahedron", "tetrahedron10", "hexahedron")
PLANE_KINDS = ("triangle", "triangle6", "quadrilateral")


class Mesh:
    """Vertices and cells: triangles or quadrilaterals in 2D, tetrahedra or hexahedra in 3D.

    Parameters
    ----------
    positions : array (N, 2) or (N, 3)
        [m]. Two columns for a mesh in the plane.
    cells : array (M, n), or dict
        Vertices of each cell, from 0, in the order of MSH: n = 3 triangles, 6 second-order triangles, 4 tetrahedra (in
        the plane: quadrilaterals), 8 hexahedra, 10 second-order tetrahedra; or such arrays by the kind of cell,
        {"tetrahedron": ..., "triangle": ...}. Triangles of a mesh of tetrahedra are facets.
    groups : dict, optional
        Vertices of each group, by its name; boundary conditions and loads of a scene refer to it.
    name : str
        Name in messages about the mesh.
    """

    def __init__(
        self,
        positions: RealArray,
        cells: IntegerArray | Mapping[str, IntegerArray],
        groups: Mapping[str, IntegerArray] | None = None,
        name: str = "mesh",
    ) -> None:
        name = plain_text(name, "mesh: name")
        points = np.ascontiguousarray(real_array(positions, f"{name}: positions"), dtype=np.float64)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            refuse(f"{name}: positions", "an array (N, 2) or (N, 3)", describe(points.shape))
        count, dimension = points.shape
        by_kind = cells if isinstance(cells, Mapping) else {_kind_of(cells, dimension, name): cells}
        blocks = [(_kind(kind, name), _cell_array(kind, nodes, count, name)) for kind, nodes in by_kind.items()]
        lists = []
        for group, list_ in (groups or {}).items():
            group_name = plain_text(str(group), f"{name}: groups")
            lists.append((group_name, _vertices(list_, count, f"{name}: group {repr(group_name)[1:-1]}")))
        self._take(_core.make_mesh(points, blocks, lists, name), dimension)

    def _take(self, core: _core.Mesh, dimension: int | None = None) -> Self:
        """Keeps the core's mesh. Without a dimension: 2 for a mesh without solid cells that lies in the plane."""
        self._core = core
        self._positions = core.positions()
        self._cells = {kind.name: nodes for kind, nodes in core.cells()}
        if dimension is None:
            is_flat = not np.any(self._positions[:, 2]) and not set(SPATIAL_KINDS) & self._cells.keys()
            dimension = 2 if is_flat else 3
        self._positions = np.ascontiguousarray(self._positions[:, :dimension])
        self._positions.flags.writeable = False
        for nodes in self._cells.values():
            nodes.flags.writeable = False
        return self

    @classmethod
    def _of(cls, core: _core.Mesh, dimension: int | None = None) -> Self:
        return cls.__new__(cls)._take(core, dimension)

    @classmethod
    def read(cls, path: AnyPath) -> Self:
        """Reads a mesh file unchanged.

        Parameters
        ----------
        path : path
            Any format of docs/mesh_formats.md; the first bytes tell which.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            For a file that is damaged or of an unknown format, with the line.
        """
        core = _core.read_mesh(file_path(path, "path"))
        warn(core.warnings)
        return cls._of(core)

    @classmethod
    def from_meshio(cls, mesh: meshio.Mesh, name: str = "mesh") -> Self:
        """Converts a meshio.Mesh; cell sets, point sets and physical groups become groups.

        Parameters
        ----------
        mesh : meshio.Mesh
        name : str
            Name of the mesh in messages.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            For kinds of cells that resilin does not know.
        """
        blocks: dict[str, list[NDArray[Any]]] = {}
        for block in mesh.cells:
            if block.type not in MESHIO_KINDS:
                refuse(f"{name}: cells", f"one of {', '.join(MESHIO_KINDS)}", f'"{block.type}"')
            blocks.setdefault(MESHIO_KINDS[block.type], []).append(other_order(block.type, np.asarray(block.data)))
        positions = np.asarray(mesh.points, dtype=np.float64)
        is_flat = positions.ndim == 2 and positions.shape[1] == 3 and not np.any(positions[:, 2])
        if is_flat and blocks.keys() & set(PLANE_KINDS) and not blocks.keys() & set(SPATIAL_KINDS):
            positions = positions[:, :2]
        cells = {kind: np.concatenate(arrays) for kind, arrays in blocks.items()}
        return cls(positions, cells, _meshio_groups(mesh), name)

    @classmethod
    def box(
        cls, size: RealArray, cells: IntegerArray, origin: RealArray = (0, 0, 0), pattern: BoxPattern = "kuhn6"
    ) -> Self:
        """A box of tetrahedra with the groups body, x_min, x_max, y_min, ...

        Parameters
        ----------
        size : (3,)
            Edge lengths [m].
        cells : (3,)
            Number of cubes along x, y, z.
        origin : (3,)
            Corner with the smallest coordinates [m].
        pattern : "kuhn6", "five" or "hexahedra"
            Tetrahedra of a cube: six around a diagonal, or five; or the cube as it is.
        """
        size, cells, origin = _recipe(size, cells, origin, 3, "box")
        if pattern == "hexahedra":
            return cls._of(_core.make_hexahedron_box(size, cells, origin), 3)
        return cls._of(_core.make_box(size, cells, origin, _choice(_core.TetPattern, pattern, "box")), 3)

    @classmethod
    def rectangle(
        cls, size: RealArray, cells: IntegerArray, origin: RealArray = (0, 0), pattern: RectanglePattern = "uniform"
    ) -> Self:
        """A rectangle of triangles with the groups body, x_min, x_max, y_min, y_max.

        Parameters
        ----------
        size : (2,)
            Edge lengths [m].
        cells : (2,)
            Number of squares along x and y.
        origin : (2,)
            Corner with the smallest coordinates [m].
        pattern : "uniform", "alternating" or "quadrilaterals"
            Two triangles in each square with parallel diagonals, or with every other diagonal turned; or the square
            as it is.
        """
        size, cells, origin = _recipe(size, cells, origin, 2, "rectangle")
        if pattern == "quadrilaterals":
            return cls._of(_core.make_quadrilateral_rectangle(size, cells, origin), 2)
        diagonals = _choice(_core.TrianglePattern, pattern, "rectangle")
        return cls._of(_core.make_rectangle(size, cells, origin, diagonals), 2)

    @property
    def positions(self) -> NDArray[np.float64]:
        """Reference positions (N, 2) or (N, 3) [m]; read-only."""
        return self._positions

    @property
    def dimension(self) -> int:
        """Number of coordinates of a vertex, 2 or 3."""
        columns: int = self._positions.shape[1]
        return columns

    @property
    def cells(self) -> NDArray[np.int32]:
        """Nodes of the tetrahedra or hexahedra, or of the cells of a plane where there are none (M, n); read-only."""
        for kind in SPATIAL_KINDS + PLANE_KINDS:
            if kind in self._cells:
                return self._cells[kind]
        return np.empty((0, self.dimension + 1), dtype=np.int32)

    @property
    def cells_by_kind(self) -> dict[str, NDArray[np.int32]]:
        """All cells, {"tetrahedron": (M, 4), "triangle": (F, 3), ...}."""
        return dict(self._cells)

    @property
    def groups(self) -> dict[str, NDArray[np.int32]]:
        """Vertices of each group, {name: (K,)}, ascending."""
        return dict(self._core.groups())

    @property
    def cell_fields(self) -> dict[str, NDArray[np.float64]]:
        """Cell fields of a mesh file, {name: (M,)}."""
        return {name: values for name, _, values in self._core.cell_fields()}

    def check(self) -> MeshReport:
        """Checks the mesh for errors and warnings, as `resilin check` does.

        Returns
        -------
        MeshReport
            True as a condition when there is no error.
        """
        return MeshReport(*self._core.check())

    def write(self, path: AnyPath) -> None:
        """Writes a mesh file.

        Parameters
        ----------
        path : path
            The extension tells the format: .msh, .vtu, .mesh (Medit) or .obj (surface).
        """
        self._core.write(file_path(path, "path"))

    def __getstate__(self) -> dict[str, Any]:
        made_anew = ("_positions", "_cells")
        return {**{name: value for name, value in vars(self).items() if name not in made_anew}, "_dim": self.dimension}

    def __setstate__(self, state: dict[str, Any]) -> None:
        dimension = state.pop("_dim")
        self.__dict__.update(state)
        self._take(state["_core"], dimension)

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(nodes)} {kind}" for kind, nodes in self._cells.items())
        return f"<resilin.Mesh {self._core.name}: {len(self._positions)} vertices, cells: {cells}>"


def read_mesh(path: AnyPath) -> Mesh:
    """Reads a mesh file, as `Mesh.read` does.

    Parameters
    ----------
    path : path
        Any format of docs/mesh_formats.md.

    Returns
    -------
    Mesh
    """
    return Mesh.read(path)


def warn(lines: Iterable[str]) -> None:
    """Gives each line as a Python warning at the place of the caller's caller."""
    for line in lines:
        warnings.warn(line, stacklevel=3)


def _kind_of(cells: Any, dimension: int, name: str) -> str:
    shape = np.shape(cells)
    kinds = {3: "triangle", 6: "triangle6", 4: "quadrilateral" if dimension == 2 else "tetrahedron"}
    kinds |= {8: "hexahedron", 10: "tetrahedron10"} if dimension == 3 else {}
    if len(shape) != 2 or shape[1] not in kinds:
        expected = "an array (M, 3) of triangles or (M, 4) of tetrahedra (in the plane: of quadrilaterals), ..."
        refuse(f"{name}: cells", expected, describe(shape))
    return kinds[shape[1]]


def _kind(kind: str, name: str) -> _core.CellKind:
    kinds = _core.CellKind.__members__
    if kind not in kinds:
        refuse(f"{name}: cells", f"one of {', '.join(kinds)}", repr(kind))
    return kinds[kind]


def _cell_array(kind: str, nodes: object, num_vertices: int, name: str) -> NDArray[np.int32]:
    nodes = _indices(nodes, num_vertices, f"{name}: {kind} cells")
    columns = _core.num_nodes(_kind(kind, name))
    if nodes.ndim != 2 or nodes.shape[1] != columns:
        refuse(f"{name}: {kind} cells", f"an array (M, {columns})", describe(nodes.shape))
    return nodes


def _vertices(list_: object, num_vertices: int, place: str) -> NDArray[np.int32]:
    list_ = _indices(list_, num_vertices, place)
    if list_.ndim != 1:
        refuse(place, "a list of vertices", f"an array {describe(list_.shape)}")
    return list_


def _indices(values: object, count: int, place: str) -> NDArray[np.int32]:
    array = np.asarray(values)
    if array.size == 0:
        return np.empty(array.shape, dtype=np.int32)
    if array.dtype.kind not in "iu":
        refuse(place, "whole numbers", array.dtype.name)
    outside = (array < 0) | (array >= count)
    if np.any(outside):
        refuse(place, f"vertices from 0 to {count - 1}", str(array[outside][0]))
    return np.ascontiguousarray(array, dtype=np.int32)


def _recipe(
    size: object, cells: object, origin: object, dim: int, name: str
) -> tuple[list[float], list[int], list[float]]:
    size, origin = np.asarray(size, dtype=np.float64), np.asarray(origin, dtype=np.float64)
    cells = np.asarray(cells)
    for key, array in (("size", size), ("cells", cells), ("origin", origin)):
        if array.shape != (dim,):
            refuse(f"{name}.{key}", f"{dim} numbers", f"an array {describe(array.shape)}")
    if not np.all(np.isfinite(size) & (size > 0)):
        refuse(f"{name}.size", "lengths above 0", str(size.tolist()))
    if not np.all(np.isfinite(origin)):
        refuse(f"{name}.origin", "finite numbers", str(origin.tolist()))
    if cells.dtype.kind not in "iu" or np.any(cells < 1):
        refuse(f"{name}.cells", "whole numbers of at least 1", str(cells.tolist()))
    if 6 * np.prod(cells.astype(float)) > np.iinfo(np.int32).max:
        refuse(f"{name}.cells", "fewer than 2^31 triangles or tetrahedra", str(cells.tolist()))
    return size.tolist(), cells.tolist(), origin.tolist()


def _choice(kinds: type[Kind], name: str, place: str) -> Kind:
    if name not in kinds.__members__:
        refuse(f"{place}.pattern", f"one of {', '.join(kinds.__members__)}", repr(name))
    return kinds.__members__[name]


def other_order(kind: str, nodes: NDArray[Any]) -> NDArray[Any]:
    """From meshio's (and VTK's) order of the nodes to ours, or back; `kind` is meshio's name."""
    return nodes[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]] if kind == "tetra10" else nodes


def _meshio_groups(mesh: meshio.Mesh) -> dict[str, NDArray[Any]]:
    groups = {name: np.asarray(vertices) for name, vertices in mesh.point_sets.items() if vertices is not None}
    for name, cells_of_blocks in mesh.cell_sets.items():
        parts = [
            np.asarray(block.data)[np.asarray(chosen, dtype=np.int64)].ravel()
            for block, chosen in zip(mesh.cells, cells_of_blocks, strict=True)
            if chosen is not None and len(chosen)
        ]
        groups[name] = np.unique(np.concatenate(parts)) if parts else np.empty(0, dtype=np.int64)
    return groups
