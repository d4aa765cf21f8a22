"""Stress-stretch curves of materials."""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from resilin import _core
from resilin.arrays import plain_text, refuse

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType
    from typing import Literal

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from resilin.typing import AnyPath, CurveKind, Loss, RealArray, StressKind

NUM_POINTS = 61  # number of points of a curve for which no stretches are asked


@dataclass(frozen=True)
class StabilityLimit:
    """Stretch at which a curve becomes unstable, or ends."""

    loss: Loss  #: "stress_drops", "directions_part", "not_elliptic" or "no_state"; see docs/materials.md
    side: Literal["above", "below"]  #: "above" or "below": where it is lost
    stretch: float  #: the last stable one
    volume_ratio: float


@dataclass(frozen=True, eq=False)
class StretchCurve:
    """A stress-stretch curve: arrays (N,) with one entry for each stretch asked for.

    Stresses, energy density and volume ratio are nan where there is no state.
    """

    law: str
    kind: CurveKind  #: "uniaxial", "equibiaxial", "planar", "shear" or "volumetric"
    stretch: NDArray[np.float64]  #: the amount of shear for "shear"
    nominal_stress: NDArray[np.float64]  #: P11; P12 for "shear"; tr P / 3 for "volumetric" [Pa]
    cauchy_stress: NDArray[np.float64]  #: the same entry of sigma [Pa]
    volume_ratio: NDArray[np.float64]
    energy_density: NDArray[np.float64]  #: [J/m^3]
    stretches: NDArray[np.float64]  #: (N, 3), the diagonal of F with the free directions solved
    stability: NDArray[np.str_]  #: (N,) of str: "stable", or what is lost (StabilityLimit.loss)
    limits: tuple[StabilityLimit, ...]  #: below rest and above
    stability_text: str  #: the limits in words; empty when there are none
    _csv: str = field(repr=False)

    @property
    def is_stable(self) -> NDArray[np.bool_]:
        """(N,) of bool."""
        is_stable: NDArray[np.bool_] = self.stability == "stable"
        return is_stable

    def to_csv(self, path: AnyPath) -> None:
        """Writes a CSV file: names with units and a line for each point."""
        Path(path).write_text(self._csv, encoding="utf-8")

    def to_json(self, path: AnyPath) -> None:
        """Writes the arrays point by point as JSON; null where there is no state."""
        names = ("stretch", "nominal_stress", "cauchy_stress", "volume_ratio", "energy_density", "stretches")
        columns = [getattr(self, name).tolist() for name in names] + [self.stability.tolist()]
        points = [
            dict(zip((*names, "stability"), map(_without_nan, row), strict=True)) for row in zip(*columns, strict=True)
        ]
        content = {
            "law": self.law,
            "load_case": self.kind,
            "units": {"nominal_stress": "Pa", "cauchy_stress": "Pa", "energy_density": "J/m^3"},
            "points": points,
            "limits": [vars(limit) for limit in self.limits],
        }
        Path(path).write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")

    def plot(self, ax: Axes | None = None, stress: StressKind = "nominal", **style: Any) -> Axes:
        """Plots the stress over the stretch; unstable states are dashed.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes for the plot; by default a new figure.
        stress : "nominal" or "cauchy"
        **style
            Passed on to ``Axes.plot``.

        Returns
        -------
        matplotlib.axes.Axes
        """
        if stress not in ("nominal", "cauchy"):
            refuse("stress", '"nominal" or "cauchy"', repr(stress))
        if ax is None:
            ax = _pyplot().subplots()[1]
        values = self.nominal_stress if stress == "nominal" else self.cauchy_stress
        order = np.argsort(self.stretch, kind="stable")
        x, y, is_stable = self.stretch[order], values[order], self.is_stable[order]
        is_solid = is_stable.copy()
        if is_solid.size > 1:  # a segment is solid when both of its ends are stable
            meets_unstable = np.zeros_like(is_stable)
            meets_unstable[1:] |= ~is_stable[:-1]
            meets_unstable[:-1] |= ~is_stable[1:]
        else:
            meets_unstable = ~is_stable
        line = ax.plot(x, np.where(is_solid, y, np.nan), **{"label": self.law, **style})[0]
        dashed = {**style, "color": line.get_color(), "linestyle": "--", "label": "_unstable"}
        ax.plot(x, np.where(~is_stable | meets_unstable, y, np.nan), **dashed)
        ax.set_xlabel("amount of shear" if self.kind == "shear" else "stretch")
        ax.set_ylabel("nominal stress [Pa]" if stress == "nominal" else "Cauchy stress [Pa]")
        ax.set_title(self.kind)
        return ax


def stretch_curve(
    law: str,
    constants: Mapping[str, Any],
    fibres: NDArray[np.float64] | None,
    kind: CurveKind,
    stretches: RealArray | None,
) -> StretchCurve:
    """The curve of a law; see `Material.curve`."""
    if not isinstance(kind, str):
        refuse("kind", "the name of a curve", repr(kind))
    plain_text(kind, "kind")
    at = _stretch_array(np.linspace(*_core.usual_range(kind), NUM_POINTS) if stretches is None else stretches)
    numbers = [_one_number(law, name, value) for name, value in constants.items()]
    directions = np.zeros((0, 3)) if fibres is None else fibres
    if directions.ndim != 2:
        refuse(f"{law}.fibres", "one set of directions, (families, 3)", f"{directions.shape}")
    found = _core.stretch_curve(law, numbers, directions, kind, at)
    limits = tuple(StabilityLimit(**limit) for limit in found.pop("limits"))
    stability, csv = np.array(found.pop("stability"), dtype="<U15"), found.pop("csv")
    curve = StretchCurve(law=law, kind=kind, stability=stability, limits=limits, _csv=csv, **found)
    if curve.stability_text:
        warnings.warn(curve.stability_text, stacklevel=3)
    return curve


def _stretch_array(stretches: object) -> NDArray[np.float64]:
    array = np.asarray(stretches)
    if array.ndim != 1 or array.dtype.kind not in "fiu" and array.size > 0:
        refuse("stretches", "a list of numbers, (N,)", f"{array.dtype.name} {array.shape}")
    return np.ascontiguousarray(array, dtype=np.float64)


def _one_number(law: str, name: str, value: Any) -> float:
    """The constant as a float; refuses one value for each state."""
    if hasattr(value, "detach"):
        value = value.detach().cpu().numpy()
    if np.ndim(value) != 0:
        refuse(f"{law}.{name}", "one number for a curve", f"an array {np.shape(value)}")
    return float(value)


def _without_nan(value: object) -> object:
    if isinstance(value, list):
        return [_without_nan(entry) for entry in value]
    return None if isinstance(value, float) and value != value else value


def _pyplot() -> ModuleType:
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as error:
        raise ImportError("plots need matplotlib: pip install 'resilin[plot]'") from error
    module: ModuleType = pyplot
    return module
