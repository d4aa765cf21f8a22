"""Frames of a result for other packages: meshio, pyvista, pandas. None of them is needed otherwise."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin.arrays import plain_text, refuse
from resilin.mesh import MESHIO_KINDS, other_order

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    import meshio
    import pandas as pd
    import pyvista as pv
    from numpy.typing import NDArray

    from resilin import _core
    from resilin.typing import Report

    Floats = NDArray[np.float64]

USUAL_FIELDS = ("displacement", "von_mises", "averaged_von_mises", "volume_ratio")

OUR_KINDS = {ours: theirs for theirs, ours in MESHIO_KINDS.items()}  # to meshio's
VTK_TYPES = {"triangle": 5, "triangle6": 22, "quad": 9, "tetra": 10, "tetra10": 24, "hexahedron": 12}


def body_name(core: _core.History, body: str | None) -> str:
    """The body that is meant; without a name the only one."""
    names = core.body_names()
    if body is None and len(names) != 1:
        refuse("body", f"one of {', '.join(names)}", "no name")
    return names[0] if body is None else plain_text(body, "body")


def _optional(module: str, function: str) -> Any:
    """A package that not everybody has. Its name is that of the extra of ours that brings it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(f"{function} needs {module}: pip install 'resilin[{module}]' ({error})") from error


class _Frame:
    """One frame in the terms of VTK, which meshio has as well."""

    def __init__(self, core: _core.History, frame: int, fields: Sequence[str]) -> None:
        number = int(frame)
        if isinstance(fields, str):
            refuse("fields", "a list of names", repr(fields), f"[{fields!r}]")
        self.points = _in_space(core.positions_of_frame(number))
        names = core.body_names()
        kinds = [OUR_KINDS[core.cell_kind(name).name] for name in names]
        self.blocks = [(kind, other_order(kind, core.cells(name))) for kind, name in zip(kinds, names, strict=True)]
        sizes = [len(nodes) for _, nodes in self.blocks]
        self.point_data: dict[str, NDArray[Any]] = {}
        self.cell_data: dict[str, NDArray[Any]] = {"body": np.repeat(np.arange(len(sizes)), sizes)}
        for name in fields:
            values = core.field_of_frame(plain_text(name, "fields"), number)
            values = values.reshape(len(values), 9) if values.ndim == 3 else _in_space(values)
            (self.cell_data if core.is_by_cell(name) else self.point_data)[name] = values
        self.cuts = np.cumsum(sizes)[:-1]  # between the bodies


def _in_space(values: Floats) -> Floats:
    """Vectors of the plane with a third component."""
    return np.pad(values, ((0, 0), (0, 1))) if values.ndim == 2 and values.shape[1] == 2 else values


def to_meshio(core: _core.History, frame: int, fields: Sequence[str]) -> meshio.Mesh:
    package = _optional("meshio", "to_meshio")
    shown = _Frame(core, frame, fields)
    cell_data = {name: np.split(values, shown.cuts) for name, values in shown.cell_data.items()}
    mesh: meshio.Mesh = package.Mesh(shown.points, shown.blocks, point_data=shown.point_data, cell_data=cell_data)
    return mesh


def to_pyvista(core: _core.History, frame: int, fields: Sequence[str]) -> pv.UnstructuredGrid:
    package = _optional("pyvista", "to_pyvista")
    shown = _Frame(core, frame, fields)
    cells = [np.insert(nodes, 0, nodes.shape[1], axis=1).ravel() for _, nodes in shown.blocks]
    types = [np.full(len(nodes), VTK_TYPES[kind], dtype=np.uint8) for kind, nodes in shown.blocks]
    grid: pv.UnstructuredGrid = package.UnstructuredGrid(np.concatenate(cells), np.concatenate(types), shown.points)
    for data, values in ((grid.point_data, shown.point_data), (grid.cell_data, shown.cell_data)):
        for name, array in values.items():
            data[name] = array
    return grid


def _entries(value: object, name: str) -> Iterator[tuple[str, object]]:
    """Numbers and words of a report with their names; lists of two or three numbers are vectors."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from _entries(entry, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        is_vector = 1 < len(value) <= 3 and all(isinstance(entry, int | float) for entry in value)
        for key, entry in zip("xyz" if is_vector else map(str, range(len(value))), value, strict=False):
            yield from _entries(entry, f"{name}.{key}")
    else:
        yield name, value


def to_dataframe(report: Report) -> pd.DataFrame:
    package = _optional("pandas", "to_dataframe")
    frames: Sequence[Mapping[str, object]] = report["frames"]
    table: pd.DataFrame = package.DataFrame([dict(_entries(frame, "")) for frame in frames])
    table.index.name = "frame"
    return table
