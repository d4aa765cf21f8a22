"""Stress-stretch curves of materials."""

import json
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from resilin import _core
from resilin.arrays import refuse

NUM_POINTS = 61  # of a curve for which no stretches are asked


@dataclass(frozen=True)
class StabilityLimit:
    """Where a curve stops being stable, or ends."""

    loss: str  #: "stress_drops", "directions_part", "not_elliptic" or "no_state"; see docs/materials.md
    side: str  #: "above" or "below": where it is lost
    stretch: float  #: the last stable one
    volume_ratio: float


@dataclass(frozen=True, eq=False)
class StretchCurve:
    """A stress-stretch curve: arrays (N,) with one entry for each stretch asked for.

    Stresses, energy density and volume ratio are nan where there is no state.
    """

    law: str
    kind: str  #: "uniaxial", "equibiaxial", "planar", "shear" or "volumetric"
    stretch: np.ndarray  #: the amount of shear for "shear"
    nominal_stress: np.ndarray  #: P11; P12 for "shear"; tr P / 3 for "volumetric" [Pa]
    cauchy_stress: np.ndarray  #: the same entry of sigma [Pa]
    volume_ratio: np.ndarray
    energy_density: np.ndarray  #: [J/m^3]
    stretches: np.ndarray  #: (N, 3), the diagonal of F with the free directions solved
    stability: np.ndarray  #: (N,) of str: "stable", or what is lost (StabilityLimit.loss)
    limits: tuple  #: of StabilityLimit, below rest and above
    stability_text: str  #: the limits in words; empty when there are none
    _csv: str = field(repr=False)

    @property
    def is_stable(self):
        """(N,) of bool."""
        return self.stability == "stable"

    def to_csv(self, path):
        """Writes names with units and a line for each point."""
        Path(path).write_text(self._csv, encoding="utf-8")

    def to_json(self, path):
        """Writes what the arrays hold, point by point; null where there is no state."""
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

    def plot(self, ax=None, stress="nominal", **style):
        """Draws the stress over the stretch; unstable states are dashed.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure otherwise.
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


def stretch_curve(material, kind, stretches=None):
    """The curve of a `Material`; see `Material.curve`."""
    if not isinstance(kind, str):
        refuse("kind", "the name of a curve", repr(kind))
    if stretches is None:
        stretches = np.linspace(*_core.usual_range(kind), NUM_POINTS)
    stretches = _stretch_array(stretches)
    constants = [_one_number(material.law, name, value) for name, value in material.constants.items()]
    fibres = np.zeros((0, 3)) if material.fibres is None else np.asarray(material.fibres, dtype=np.float64)
    if fibres.ndim != 2:
        refuse(f"{material.law}.fibres", "one set of directions, (families, 3)", f"{fibres.shape}")
    found = _core.stretch_curve(material.law, constants, np.ascontiguousarray(fibres), kind, stretches)
    limits = tuple(StabilityLimit(**limit) for limit in found.pop("limits"))
    stability, csv = np.array(found.pop("stability"), dtype="<U15"), found.pop("csv")
    curve = StretchCurve(law=material.law, kind=kind, stability=stability, limits=limits, _csv=csv, **found)
    if curve.stability_text:
        warnings.warn(curve.stability_text, stacklevel=3)
    return curve


def _stretch_array(stretches):
    array = np.asarray(stretches)
    if array.ndim != 1 or array.dtype.kind not in "fiu" and array.size > 0:
        refuse("stretches", "a list of numbers, (N,)", f"{array.dtype.name} {array.shape}")
    return np.ascontiguousarray(array, dtype=np.float64)


def _one_number(law, name, value):
    """The constant as a float; refuses one value for each state."""
    if hasattr(value, "detach"):
        value = value.detach().cpu().numpy()
    if np.ndim(value) != 0:
        refuse(f"{law}.{name}", "one number for a curve", f"an array {np.shape(value)}")
    return float(value)


def _without_nan(value):
    if isinstance(value, list):
        return [_without_nan(entry) for entry in value]
    return None if isinstance(value, float) and value != value else value


def _pyplot():
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as error:
        raise ImportError("plots need matplotlib: pip install 'resilin[plot]'") from error
    return pyplot
