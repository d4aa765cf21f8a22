"""A sweep as it travels between processes, and as the core takes it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from resilin import _core
from resilin.arrays import refuse
from resilin.scene import plain_value


class Definition(NamedTuple):
    """A sweep as it travels to other processes: a file, or values."""

    path: str  #: path of SWEEP.toml, absolute; empty where there are values
    values: dict[str, Any]  #: as in SWEEP.toml, with arrays and meshes
    folder: str  #: absolute; that relative paths of a dict start at


def make_sweep(definition: Definition) -> _core.Sweep:
    """The core's sweep. Raises InputError for parameters that do not fit the scene."""
    if definition.path:
        return _core.read_sweep(definition.path)
    values = dict(definition.values)
    if isinstance(values["base"], Mapping):
        values["base"] = plain_value(values["base"], "base")
    values["parameters"] = {key: _plain_parameter(key, value) for key, value in values["parameters"].items()}
    return _core.read_sweep_from_values(values, "sweep", definition.folder)


def _plain_parameter(key: str, values: object) -> object:
    place = f"parameters: {key}"
    if isinstance(values, Mapping):
        return {form: _plain_values(place, entries) for form, entries in values.items()}
    return _plain_values(place, values)


def _plain_values(place: str, values: object) -> list[object]:
    if isinstance(values, np.ndarray) and values.ndim > 0:
        values = list(values)
    if isinstance(values, range):
        values = list(values)
    if not isinstance(values, list | tuple):
        refuse(place, "a list of values or a dict such as {'uniform': [1, 2]}", repr(values)[:60])
    return [plain_value(value, place) for value in values]
