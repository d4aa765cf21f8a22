"""Parameters of whole scenes, found from markers, reactions and probes (docs/fit.md)."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import refuse
from resilin.scene import of_file_or_dict, override_lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from resilin.typing import Overrides, Scene


@dataclass(frozen=True)
class FittedParameter:
    """What the measurements say about one number of the scenes; SI."""

    name: str
    key: str  #: of the scenes
    unit: str
    start: float
    value: float
    standard_error: float  #: inf where the measurements do not determine it
    interval: tuple[float, float]  #: of 95 %, by the logarithm of what is positive
    is_held: bool  #: by a bound, against which the data would have it go on


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """One table of measurements beside what the scenes give: arrays (N,), component by component of each row."""

    name: str
    unit: str
    measured: NDArray[np.float64]
    model: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SceneFit:
    """Parameters of scenes, fitted."""

    parameters: dict[str, FittedParameter]  #: by name
    sum_of_squares: float  #: of residuals over sigma, where there are sigmas
    degrees_of_freedom: int
    solves: int  #: of each scene
    is_converged: bool
    correlation: NDArray[np.float64]  #: (P, P) between the estimates
    tables: tuple[MeasuredTable, ...]
    warnings: tuple[str, ...]
    text: str = field(repr=False)  #: what ``resilin fit`` prints
    material_toml: str = field(repr=False)

    def __getitem__(self, name: str) -> FittedParameter:
        """The parameter of this name."""
        if name not in self.parameters:
            refuse("fit", f"one of {', '.join(self.parameters)}", repr(name))
        return self.parameters[name]


def fit_scenes(data: Scene, overrides: Overrides = (), on_solve: Callable[[str], object] | None = None) -> SceneFit:
    """Fits numbers of scenes to displacements of markers, reactions of supports and probes.

    Parameters
    ----------
    data : path or dict
        The file of ``resilin fit`` with ``[[experiment]]`` and ``[[parameter]]``, or its keys as a dict.
    overrides : dict or list of str
        As after ``--set``, of the fit's own keys.
    on_solve : function, optional
        Called with a line of text after each solve, such as ``print``.

    Returns
    -------
    SceneFit

    Raises
    ------
    InputError
        For data that are wrong, in one line with what to do.
    """
    lines = override_lines(overrides)
    found = of_file_or_dict(
        data,
        lambda path: _core.fit_scenes_file(path, lines, on_solve),
        lambda values: _core.fit_scenes_values(values, lines, on_solve),
    )
    content = json.loads(found["json"])
    size = len(content["parameters"])
    return SceneFit(
        parameters={entry["name"]: _parameter(entry) for entry in content["parameters"]},
        sum_of_squares=content["sum_of_squares"],
        degrees_of_freedom=content["degrees_of_freedom"],
        solves=content["solves"],
        is_converged=content["is_converged"],
        correlation=np.array(content["correlation_matrix"]).reshape(size, size),
        tables=tuple(
            MeasuredTable(table["name"], table["unit"], np.array(table["measured"]), np.array(table["model"]))
            for table in content["tables"]
        ),
        warnings=tuple(content["warnings"]),
        text=found["text"],
        material_toml=found["material"],
    )


def _parameter(entry: dict[str, Any]) -> FittedParameter:
    numbers = {key: np.inf if entry[key] is None else entry[key] for key in ("standard_error", "upper_95")}
    lower = entry["lower_95"] if entry["lower_95"] is not None else -np.inf
    return FittedParameter(
        name=entry["name"],
        key=entry["key"],
        unit=entry["unit"],
        start=entry["start"],
        value=entry["value"],
        standard_error=numbers["standard_error"],
        interval=(lower, numbers["upper_95"]),
        is_held=entry["is_held"],
    )
