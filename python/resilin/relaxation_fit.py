"""Prony series from relaxation tests and dynamic tests (docs/fit.md#relaxation)."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from resilin import _core
from resilin.fit import write_fit
from resilin.scene import of_file_or_dict, override_lines

if TYPE_CHECKING:
    from resilin.typing import AnyPath, Overrides, Scene


@dataclass(frozen=True, eq=False)
class RelaxationFit:
    """A Prony series E(t) = E_inf + sum_i E_i exp(-t / tau_i) of measured moduli."""

    g: tuple[float, ...]  #: shares of the instantaneous modulus
    tau: tuple[float, ...]  #: relaxation times [s]
    instantaneous_modulus: float  #: in the unit of the data
    long_term_modulus: float  #: in the unit of the data
    rms_error: float  #: root mean square of the errors relative to the modulus
    largest_error: float  #: relative to the modulus
    text: str = field(repr=False)  #: the table that ``resilin fit`` prints
    material_toml: str = field(repr=False)
    _page: str = field(repr=False)
    _json: str = field(repr=False)

    @property
    def viscoelastic(self) -> dict[str, Any]:
        """Value of ``viscoelastic`` in a material whose constants are those under a sudden load."""
        return {"g": list(self.g), "tau": list(self.tau)}

    def save(self, folder: AnyPath) -> None:
        """Writes fit.html, fit.json and material.toml.

        Parameters
        ----------
        folder : path
            Made if it does not exist.
        """
        write_fit(folder, page=self._page, content=self._json, material=self.material_toml)


def fit_relaxation(data: Scene, overrides: Overrides = ()) -> RelaxationFit:
    """Finds the Prony series of a relaxation test or of a dynamic test.

    Parameters
    ----------
    data : path or dict
        A file of ``resilin fit`` with ``[relaxation]``, or its keys as a dict, whose columns may be lists or arrays
        (N,): ``{"relaxation": {"time": t, "modulus": E}}``, or frequency, storage and loss.
    overrides : dict or list of str
        As after ``--set``.

    Returns
    -------
    RelaxationFit

    Raises
    ------
    InputError
        For wrong data, with one line that says what to do.
    """
    lines = override_lines(overrides)
    found = of_file_or_dict(
        data,
        lambda path: _core.fit_relaxation_file(path, lines),
        lambda values: _core.fit_relaxation_values(values, lines),
    )
    content = json.loads(found["json"])
    return RelaxationFit(
        g=tuple(content["g"]),
        tau=tuple(content["tau"]),
        instantaneous_modulus=content["instantaneous_modulus"],
        long_term_modulus=content["long_term_modulus"],
        rms_error=content["rms_error"],
        largest_error=content["largest_error"],
        text=found["text"],
        material_toml=found["material"],
        _page=found["page"],
        _json=found["json"],
    )
