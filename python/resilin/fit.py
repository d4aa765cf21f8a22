"""Calibration of constitutive models from tests: constants, confidence intervals, stability (docs/fit.md)."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import refuse
from resilin.material import Material
from resilin.scene import of_file_or_dict, override_lines

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Literal

    from numpy.typing import NDArray

    from resilin.typing import AnyPath, Overrides, Scene


def write_fit(folder: AnyPath, page: str, content: str, material: str) -> None:
    """Writes the files of a fit into a folder, which is made if it does not exist."""
    path = Path(folder)
    path.mkdir(parents=True, exist_ok=True)
    (path / "fit.html").write_text(page, encoding="utf-8")
    (path / "fit.json").write_text(content, encoding="utf-8")
    (path / "material.toml").write_text(material, encoding="utf-8")


@dataclass(frozen=True)
class FittedConstant:
    """Estimate of one constant, in SI units."""

    name: str
    unit: str  #: "Pa", or empty for a pure number
    value: float
    standard_error: float  #: inf where the tests do not determine it, 0 where it was not fitted
    half_width_95: float  #: half width of the interval of 95 % (Student's t)
    origin: Literal["fitted", "given", "assumed", "absent"]
    is_determined: bool

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the 95 % confidence interval."""
        return self.value - self.half_width_95, self.value + self.half_width_95


@dataclass(frozen=True)
class StableRange:
    """Loads between which a model is stable (Drucker's condition) in one mode."""

    mode: str
    unstable_below: float | None  #: None: stable to the end of the search, a stretch of 1/12
    unstable_above: float | None  #: None: to 12


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """The curve of a model in one mode: arrays (N,)."""

    mode: str
    load: NDArray[np.float64]  #: stretch, or amount of shear
    nominal_stress: NDArray[np.float64]  #: [Pa]; nan where there is no state
    is_stable: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FittedLaw:
    """One calibrated constitutive model."""

    name: str  #: as it was asked for, such as "ogden2"
    law: str  #: law of the catalogue
    constants: dict[str, FittedConstant]
    sum_of_squares: float  #: sum of squares of weighted residuals; [Pa^2] where they are absolute
    points: int
    aicc: float  #: Akaike's criterion for few points; inf where there are too few
    akaike_weight: float
    r_squared: dict[str, float]  #: by the name of the test
    stability: tuple[StableRange, ...]
    curves: dict[str, FittedCurve]  #: by mode
    youngs_modulus: float  #: at small strain [Pa]
    poissons_ratio: float
    is_bounded: bool  #: stability or a range holds it away from the free optimum
    remarks: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def material(self) -> Material:
        """The model with these constants, for a scene."""
        return Material(self.law, **{name: constant.value for name, constant in self.constants.items()})


@dataclass(frozen=True, eq=False)
class Fit:
    """The calibrated models, the best first."""

    laws: tuple[FittedLaw, ...]
    not_fitted: dict[str, str]  #: why not, by law
    objective: str  #: the minimised function, in words
    warnings: tuple[str, ...]
    text: str = field(repr=False)  #: the table that ``resilin fit`` prints
    material_toml: str = field(repr=False)
    _page: str = field(repr=False)
    _json: str = field(repr=False)

    @property
    def best(self) -> FittedLaw:
        """The best model by AICc."""
        return self.laws[0]

    def __getitem__(self, name: str) -> FittedLaw:
        """The law of this name."""
        for law in self.laws:
            if law.name == name:
                return law
        refuse("fit", f"one of {', '.join(law.name for law in self.laws)}", repr(name))

    def save(self, folder: AnyPath) -> None:
        """Writes fit.html, fit.json and material.toml.

        Parameters
        ----------
        folder : path
            Made if it does not exist.
        """
        write_fit(folder, page=self._page, content=self._json, material=self.material_toml)


def fit(data: Scene, laws: str | Sequence[str] | None = None, overrides: Overrides = ()) -> Fit:
    """Calibrates constitutive models from tests of a material.

    Parameters
    ----------
    data : path or dict
        The file of ``resilin fit``, or its keys as a dict, whose columns may be lists or arrays (N,): ``{"test":
        [{"mode": "uniaxial", "stretch": x, "nominal_stress": y, "unit": "MPa"}]}``.
    laws : "all" or list of str, optional
        Models to fit, in place of those of `data`.
    overrides : dict or list of str
        As after ``--set``.

    Returns
    -------
    Fit

    Raises
    ------
    InputError
        For wrong data, with one line that says what to do.
    """
    lines = override_lines(overrides)
    if laws is not None:
        names = [laws] if isinstance(laws, str) and laws != "all" else laws
        lines.append(f"fit.laws={json.dumps(names if isinstance(names, str) else list(names))}")
    found = of_file_or_dict(
        data, lambda path: _core.fit_file(path, lines), lambda values: _core.fit_values(values, lines)
    )
    content = json.loads(found["json"])
    return Fit(
        laws=tuple(_law(entry) for entry in content["laws"]),
        not_fitted={entry["name"]: entry["reason"] for entry in content["not_fitted"]},
        objective=content["objective"],
        warnings=tuple(content["warnings"]),
        text=found["text"],
        material_toml=found["material"],
        _page=found["page"],
        _json=found["json"],
    )


def _law(entry: dict[str, Any]) -> FittedLaw:
    constants = {
        constant["name"]: FittedConstant(**{name: _number(value) for name, value in constant.items()})
        for constant in entry["constants"]
    }
    return FittedLaw(
        name=entry["name"],
        law=entry["law"],
        constants=constants,
        sum_of_squares=entry["sum_of_squares"],
        points=entry["points"],
        aicc=_number(entry["aicc"]),
        akaike_weight=entry["akaike_weight"],
        r_squared={test["test"]: _number(test["r_squared"]) for test in entry["tests"]},
        stability=tuple(StableRange(**limits) for limits in entry["stability"]),
        curves={curve["mode"]: _curve(curve) for curve in entry["curves"]},
        youngs_modulus=entry["youngs_modulus"],
        poissons_ratio=entry["poissons_ratio"],
        is_bounded=entry["is_bounded"],
        remarks=tuple(entry["remarks"]),
        warnings=tuple(entry["warnings"]),
    )


def _curve(entry: dict[str, Any]) -> FittedCurve:
    stress = [np.nan if value is None else value for value in entry["nominal_stress"]]
    return FittedCurve(
        entry["mode"], np.array(entry["load"]), np.array(stress, dtype=np.float64), np.array(entry["is_stable"])
    )


def _number(value: Any) -> Any:
    """Number from JSON; null stands for infinity."""
    return np.inf if value is None else value
