"""The result table of a sweep, by columns."""

from __future__ import annotations

import csv
import importlib
import json
import pathlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import file_path, refuse

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from resilin.typing import AnyPath

TEXTS = ("hash", "status", "reason")


class SweepTable(Mapping[str, "NDArray[Any]"]):
    """Results of a sweep: a row for each finished scene, a column for each parameter and quantity.

    A mapping of arrays by the names of the columns: scene, hash, the parameters, status, the quantities, steps,
    newton_iterations, unknowns [free], seconds, kept, reason. Numbers are float64 (NaN where there is none), lists
    arrays of their own. The file is read when a column is first asked for.

    Attributes
    ----------
    folder : pathlib.Path
    """

    def __init__(self, folder: pathlib.Path, owner: object = None) -> None:
        self.folder = folder
        self._owner = owner  # owner of a folder that goes with this table
        self._columns: dict[str, NDArray[Any]] | None = None

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Names of all columns."""
        if self._columns is None:
            self._columns = _read_columns(self.folder)
        return self._columns

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def num_rows(self) -> int:
        """Number of finished scenes."""
        return len(self["scene"])

    @property
    def failed(self) -> dict[int, str]:
        """Reason of each failed scene, by its number."""
        rows = zip(self["scene"], self["status"], self["reason"], strict=True)
        return {int(scene): f"{status}: {reason}" for scene, status, reason in rows if status != "done"}

    def result_folder(self, scene: int) -> pathlib.Path:
        """Result folder of a scene whose results were kept, as `resilin run` writes it.

        Parameters
        ----------
        scene : int
            Number of the scene.

        Returns
        -------
        pathlib.Path

        Raises
        ------
        InputError
            If they were not kept.
        """
        (row,) = np.nonzero(self["scene"] == scene)
        if not len(row) or not self["kept"][row[0]]:
            refuse("scene", "the number of a scene whose results were kept", repr(scene), 'keep = "all" keeps them')
        return self.folder / "kept" / str(self["hash"][row[0]])

    def field(self, scene: int, name: str, frame: int = -1) -> NDArray[np.float64]:
        """A field of one frame of a scene whose results were kept.

        Parameters
        ----------
        scene : int
            Number of the scene, its row in the table.
        name : str
            Name of the field, as in `Result.fields`.
        frame : int
            Number of the frame; -1 is the last.

        Returns
        -------
        array
            With the shape and unit of the field (docs/results.md).
        """
        array: NDArray[np.float64] = _core.kept_field(str(self.result_folder(scene)), name, frame)[0]
        return array

    def rest_positions(self, scene: int) -> NDArray[np.float64]:
        """Reference positions of a scene whose results were kept.

        Parameters
        ----------
        scene : int
            Number of the scene.

        Returns
        -------
        array (N, d)
            [m]
        """
        return _core.kept_rest_positions(str(self.result_folder(scene)))

    def to_parquet(self, path: AnyPath | None = None) -> pathlib.Path:
        """Writes the table as Parquet, by pyarrow.

        Parameters
        ----------
        path : path, optional
            The file; by default results.parquet in the folder.

        Returns
        -------
        pathlib.Path
            The file.
        """
        try:
            pyarrow: Any = importlib.import_module("pyarrow")
            parquet: Any = importlib.import_module("pyarrow.parquet")
        except ModuleNotFoundError as error:
            raise ImportError("Parquet needs pyarrow: pip install 'resilin[parquet]'") from error
        target = self.folder / "results.parquet" if path is None else pathlib.Path(file_path(path, "path"))
        arrays = {name: pyarrow.array(_plain_list(column)) for name, column in self.columns.items()}
        partial = target.with_name(target.name + ".partial")
        parquet.write_table(pyarrow.table(arrays), str(partial))
        partial.replace(target)  # beside and renamed: whole or not at all
        return target

    def __repr__(self) -> str:
        return f"<resilin.SweepTable {self.folder}: {self.num_rows} scenes, {len(self.failed)} failed>"


def read_sweep(folder: AnyPath) -> SweepTable:
    """Reads the table of a finished or running sweep of `resilin sweep` or `resilin.sweep`.

    Parameters
    ----------
    folder : path
        Folder of the sweep, with results.csv.

    Returns
    -------
    SweepTable

    Raises
    ------
    InputError
        If there is none.
    """
    path = pathlib.Path(file_path(folder, "folder"))
    if not (path / "results.csv").is_file():
        refuse(str(path), "the folder of a sweep, with results.csv", "none", "resilin sweep SWEEP.toml --out FOLDER")
    return SweepTable(path)


def _read_columns(folder: pathlib.Path) -> dict[str, NDArray[Any]]:
    with (folder / "results.csv").open(newline="", encoding="utf-8") as stream:
        rows = csv.reader(stream)
        names = next(rows)
        cells: list[list[str]] = [[] for _ in names]
        for row in rows:
            for column, cell in zip(cells, row, strict=True):
                column.append(cell)
    quantities = {
        column["name"]
        for column in json.loads((folder / "sweep.json").read_text(encoding="utf-8"))["columns"]
        if column["kind"] == "quantity"
    }
    return {name: _column(name, column, name in quantities) for name, column in zip(names, cells, strict=True)}


def _column(name: str, cells: list[str], is_quantity: bool) -> NDArray[Any]:
    if name in TEXTS:
        return np.array(cells, dtype=object)
    if name in ("scene", "steps", "newton_iterations", "unknowns"):
        return np.array([int(cell) for cell in cells], dtype=np.int64)
    if name == "kept":
        return np.array([cell == "true" for cell in cells], dtype=bool)
    values = [_value(cell) for cell in cells]
    if all(isinstance(value, float) for value in values):
        return np.array(values, dtype=np.float64)
    column = np.empty(len(values), dtype=object)
    for i, value in enumerate(values):
        is_list = is_quantity and isinstance(value, list)
        column[i] = np.array([np.nan if x is None else x for x in value]) if is_list else value
    return column


def _value(cell: str) -> Any:
    if not cell:
        return float("nan")
    try:
        return float(cell)
    except ValueError:
        pass
    if cell[0] in "[{" or cell in ("true", "false"):
        try:
            return json.loads(cell)
        except json.JSONDecodeError:
            pass
    return cell


def _plain_list(column: NDArray[Any]) -> list[Any]:
    if column.dtype != object:
        plain: list[Any] = column.tolist()
        return plain
    is_mixed = len({type(value) for value in column}) > 1
    # One type for a column: lists that are missing are none, other mixtures texts.
    values = [value.tolist() if isinstance(value, np.ndarray) else value for value in column]
    if is_mixed and any(isinstance(value, list) for value in values):
        return [value if isinstance(value, list) else None for value in values]
    return [value if isinstance(value, str) else json.dumps(value) for value in values] if is_mixed else values
