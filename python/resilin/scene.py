"""Scenes as dicts, made ready for the core: the keys are those of a scene file (docs/scene.md)."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from resilin import _core
from resilin.arrays import describe, file_path, plain_text, refuse
from resilin.material import Material, number_constants
from resilin.mesh import Mesh

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from resilin.typing import Overrides, Scene

    Table = Mapping[str, object]

_T = TypeVar("_T")

LIST_SIZE = 64  # longer arrays of floating-point numbers are handed over as they are
MAX_DEPTH = 16


def read_scene(scene: Scene, overrides: Overrides = ()) -> _core.Scene:
    """The core's scene of a path or of a dict.

    Parameters
    ----------
    scene : path or dict
        A dict may hold numpy arrays, `Mesh` objects and meshes as {"positions": ..., "cells": ..., "groups": ...}; its
        paths are relative to the current folder. The law of a material may be a `Material`, with its fibres.
    overrides : dict or list of str
        As after `--set`: {"newton.tolerance": 1e-6} or ["newton.tolerance=1e-6"].
    """
    overrides = override_lines(overrides)
    if isinstance(scene, Mapping):
        plain = _plain_table(scene, "", _dimension_of(scene), 0)
        return _core.read_scene_from_values(plain, "scene", "", overrides)
    if not isinstance(scene, str | os.PathLike):
        refuse("scene", "a path or a dict", type(scene).__name__)
    return _core.read_scene(file_path(scene, "scene"), overrides)


def override_lines(overrides: Overrides) -> list[str]:
    """Texts of overrides, as they follow each --set."""
    if isinstance(overrides, Mapping):
        overrides = [f"{key}={_toml(value)}" for key, value in overrides.items()]
    return [plain_text(override, "overrides") for override in overrides]


def of_file_or_dict(data: Scene, of_file: Callable[[str], _T], of_values: Callable[[dict[str, object]], _T]) -> _T:
    """Calls `of_file` for a path, or `of_values` for a dict with the keys of such a file."""
    if isinstance(data, Mapping):
        return of_values(plain_values(data))
    if not isinstance(data, str | os.PathLike):
        refuse("data", "a path or a dict", type(data).__name__)
    return of_file(file_path(data, "data"))


def plain_values(table: Table) -> dict[str, object]:
    """A dict with the keys of a file as what the core reads."""
    return _plain_table(table, "", 3, 0)


def plain_value(value: object, path: str) -> object:
    """A value of a scene, or a whole one, as the core takes it; `path` is its key, for messages and meshes."""
    dimension = _dimension_of(value) if isinstance(value, Mapping) else 3
    return _plain(value, "" if path == "base" else path, dimension)


def _dimension_of(scene: Table) -> Any:
    simulation = scene.get("simulation")
    return simulation.get("dimension", 3) if isinstance(simulation, Mapping) else 3


def _plain(value: object, path: str, dimension: int, depth: int = 0) -> object:
    """`value` as dicts, lists, texts, numbers, long float64 arrays (rows, columns) and the core's meshes."""
    if depth > MAX_DEPTH:
        refuse(f"scene: {path}", f"at most {MAX_DEPTH} levels", "more", "does it contain itself?")
    if isinstance(value, Mapping):
        if "positions" in value and path.endswith(".mesh"):
            return _inline_mesh(value, f"scene: {path}")
        return _plain_table(value, path, dimension, depth)
    if isinstance(value, np.ndarray):
        return _plain_array(value, path)
    if isinstance(value, list | tuple):
        return [_plain(entry, f"{path}[{i}]", dimension, depth + 1) for i, entry in enumerate(value)]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        refuse(f"scene: {path}", "a whole number of 64 bits", str(value))
    if isinstance(value, str):
        return plain_text(value, f"scene: {path}")
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, os.PathLike):
        return plain_text(os.fspath(value), f"scene: {path}")
    if isinstance(value, Mesh):
        return value._core
    refuse(f"scene: {path}", "a number, a text, a list, a dict, an array or a mesh", type(value).__name__)


def _plain_table(table: Table, path: str, dimension: int, depth: int) -> dict[str, object]:
    plain = {}
    for key, value in table.items():
        if not isinstance(key, str):
            refuse(f"scene: {path or 'keys'}", "keys that are texts", repr(key))
        plain_text(key, f"scene: {path or 'keys'}")
        if isinstance(value, Material) and key == "law":
            entries = material_entries(value, dimension)
            for name in table.keys() & entries.keys() - {"law"}:
                refuse(f"scene: {path}.{name}", "a value in the Material or beside it", "both")
            plain.update(_plain_table(entries, path, dimension, depth + 1))
        else:
            plain[key] = _plain(value, f"{path}.{key}" if path else key, dimension, depth + 1)
    return plain


def _inline_mesh(table: Mapping[str, Any], place: str) -> _core.Mesh:
    for key in table:
        if key not in ("positions", "cells", "groups"):
            refuse(f"{place}.{key}", "positions, cells and groups", "an unknown key")
    if "cells" not in table:
        refuse(f"{place}.cells", "positions, cells and groups", "nothing", "add cells")
    return Mesh(table["positions"], table["cells"], table.get("groups"), name=place)._core


def _plain_array(array: NDArray[Any], path: str) -> object:
    if array.dtype.kind not in "biuf" or array.ndim > 2:
        refuse(
            f"scene: {path}",
            "an array of real numbers with one or two axes",
            f"{array.dtype.name} {describe(array.shape)}",
        )
    if array.dtype.kind == "f" and array.size > LIST_SIZE:
        return np.ascontiguousarray(array.reshape(len(array), -1), dtype=np.float64)
    return array.tolist()


def material_entries(material: Material, dimension: int = 3) -> dict[str, Any]:
    """The entries of a scene's material: law, constants and fibres, for each family (d,) or (M, d)."""
    entries: dict[str, Any] = {"law": material.law, **number_constants(material)}
    if material.fibres is not None:
        fibres = material.fibres
        if fibres.ndim > 3:
            refuse("material.fibres", "directions (families, 3) or (M, families, 3)", describe(fibres.shape))
        if dimension == 2 and np.any(fibres[..., 2]):
            refuse("material.fibres", "directions in the plane, with two components", "one that leaves it")
        entries["fibres"] = list(np.moveaxis(fibres, -2, 0)[..., :dimension])
    return entries


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple | np.ndarray):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)
