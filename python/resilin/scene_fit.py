"""Parameter identification: parameters of scenes from markers, reactions and probes (docs/fit.md)."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import file_path, refuse
from resilin.scene import of_file_or_dict, override_lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from resilin.typing import AnyPath, Overrides, Scene


@dataclass(frozen=True)
class FittedParameter:
    """Estimate of one parameter of the scenes, in SI units."""

    name: str
    key: str  #: key of the scenes
    unit: str
    start: float
    value: float
    standard_error: float  #: inf where the measurements do not determine it
    interval: tuple[float, float]  #: interval of 95 %, by the logarithm of what is positive
    is_held: bool  #: by a bound, against which the data would have it go on


@dataclass(frozen=True, eq=False)
class FittedField:
    """A constant with cell values: arrays (M,), in SI units."""

    name: str
    key: str  #: key of the scenes
    unit: str
    values: NDArray[np.float64]
    interval: tuple[
        NDArray[np.float64], NDArray[np.float64]
    ]  #: interval of 95 %: of noise and of what the prior leaves open
    resolution: NDArray[np.float64]  #: the data tell a mean over about such a length [m]


@dataclass(frozen=True, eq=False)
class Regularisation:
    """Settings and result of the regularisation of a field."""

    strength: float  #: the weight of the prior that was taken
    corner: float  #: corner of the L-curve; 0 without one
    discrepancy: float  #: ratio of the misfit to that of the sigmas; 0 where there are none
    cross_validated: float
    freedom: float  #: so many combinations of the unknowns the data determine
    l_curve: NDArray[np.float64]  #: (P, 3): strength, sum of squares, roughness


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """One table of measurements and the values of the scenes: arrays (N,), component by component of each row."""

    name: str
    unit: str
    measured: NDArray[np.float64]
    model: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SceneFit:
    """Identified parameters of scenes."""

    parameters: dict[str, FittedParameter]  #: by name
    fields: dict[str, FittedField]  #: by name: constants that were sought for each cell
    regularisation: Regularisation | None  #: regularisation of fields
    sum_of_squares: float  #: sum of squares of residuals over sigma, where there are sigmas
    degrees_of_freedom: int
    solves: int  #: solves of each scene
    #: the sum of squares, of fields with the prior, where each start of the search has ended; inf: no solution
    starts: tuple[float, ...]
    is_converged: bool
    correlation: NDArray[np.float64]  #: (P, P) between the estimates
    tables: tuple[MeasuredTable, ...]
    warnings: tuple[str, ...]
    text: str = field(repr=False)  #: output of ``resilin fit``
    material_toml: str = field(repr=False)
    _report: _core.SceneFitReport = field(repr=False)

    def save(self, folder: AnyPath) -> None:
        """Writes the files of ``resilin fit``: fit.html, fit.json, material.toml, BODY_CONSTANT.csv for cell values and
        BODY_CONSTANT.vtu for fields.

        Parameters
        ----------
        folder : path
            Made if it does not exist.
        """
        self._report.save(file_path(folder, "folder"))

    def __getitem__(self, name: str) -> FittedParameter:
        """The parameter of this name."""
        if name not in self.parameters:
            refuse("fit", f"one of {', '.join(self.parameters)}", repr(name))
        return self.parameters[name]


def fit_scenes(data: Scene, overrides: Overrides = (), on_solve: Callable[[str], object] | None = None) -> SceneFit:
    """Identifies parameters of scenes from displacements of markers, reactions of boundary conditions and probes.

    Parameters
    ----------
    data : path or dict
        The file of ``resilin fit`` with ``[[experiment]]`` and ``[[parameter]]``, or its keys as a dict. A scene may be
        a dict too, and markers may be arrays (N, d): ``{"at": X, "displacement": u, "sigma": 1e-3}``.
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
        For wrong data, with one line that says what to do.
    """
    lines = override_lines(overrides)
    found = of_file_or_dict(
        data,
        lambda path: _core.fit_scenes_file(path, lines, on_solve),
        lambda values: _core.fit_scenes_values(values, lines, on_solve),
    )
    content = json.loads(found["json"])
    size = int(np.sqrt(len(content["correlation_matrix"])))
    return SceneFit(
        parameters={entry["name"]: _parameter(entry) for entry in content["parameters"]},
        fields={entry["name"]: _field(entry) for entry in content["fields"]},
        regularisation=_regularisation(content["regularise"]) if "regularise" in content else None,
        sum_of_squares=content["sum_of_squares"],
        degrees_of_freedom=content["degrees_of_freedom"],
        solves=content["solves"],
        starts=tuple(_number(entry["objective"], np.inf) for entry in content["starts"]),
        is_converged=content["is_converged"],
        correlation=np.array(content["correlation_matrix"]).reshape(size, size),
        tables=tuple(
            MeasuredTable(table["name"], table["unit"], np.array(table["measured"]), np.array(table["model"]))
            for table in content["tables"]
        ),
        warnings=tuple(content["warnings"]),
        text=found["text"],
        material_toml=found["material"],
        _report=found["report"],
    )


def _number(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value


def _array(values: list[float | None], otherwise: float) -> NDArray[np.float64]:
    return np.array([_number(value, otherwise) for value in values])


def _field(entry: dict[str, Any]) -> FittedField:
    return FittedField(
        name=entry["name"],
        key=entry["key"],
        unit=entry["unit"],
        values=np.array(entry["values"]),
        interval=(_array(entry["lower_95"], -np.inf), _array(entry["upper_95"], np.inf)),
        resolution=_array(entry["resolution"], np.inf),
    )


def _regularisation(entry: dict[str, Any]) -> Regularisation:
    curve = [[point["strength"], point["sum_of_squares"], point["roughness"]] for point in entry["l_curve"]]
    return Regularisation(
        strength=entry["strength"],
        corner=entry["corner"],
        discrepancy=entry["discrepancy"],
        cross_validated=entry["cross_validated"],
        freedom=entry["freedom"],
        l_curve=np.array(curve).reshape(-1, 3),
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
