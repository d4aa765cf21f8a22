"""Check of a scene before it is run: its parts, what its loads amount to, and what is odd about it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from resilin import _core
from resilin.arrays import refuse
from resilin.scene import read_scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin.typing import BodyReport, FixReport, LoadReport, Overrides, Scene


@dataclass(frozen=True)
class SceneCheck:
    """A scene without errors, as `resilin check` prints it; `str` gives the lines.

    Attributes
    ----------
    bodies : list of dict
        Entries of report.json: name, law, constants, element, cells, vertices, unknowns, regions.
    boxes : dict of array (2, d)
        Bounding box of each body in the frame of `where` [m]: smallest and largest coordinates.
    fixes, loads : list of dict
        Selection of each [[fix]], [[load]] and of gravity: nodes, facets, area [m^2], center [m]. Loads have `force`
        [N] and `moment` about the centre [N m] at load factor 1 in the reference configuration, None for a spring.
    warnings : list of str
        Lines that a run would give as Python warnings.
    """

    bodies: list[BodyReport]
    boxes: dict[str, NDArray[np.float64]]
    fixes: list[FixReport]
    loads: list[LoadReport]
    warnings: list[str]

    def __str__(self) -> str:
        warnings = f"{len(self.warnings)} {'warning' if len(self.warnings) == 1 else 'warnings'}"
        return "\n".join(
            [f"warning: {line}" for line in self.warnings]
            + [f"no errors, {warnings}"]
            + [self._line_of(body) for body in self.bodies]
            + [f"fix {fix['name']}: {_selection(fix)}" for fix in self.fixes]
            + [f"load {load['name']}: {load['kind']} {_selection(load)}{_resultant(load)}" for load in self.loads]
        )

    def _line_of(self, body: BodyReport) -> str:
        low, high = self.boxes[body["name"]]
        return (
            f"body {body['name']}: {body['law']}, {body['cells']} cells of {body['element']}, "
            f"{body['vertices']} vertices, from {_point(low)} to {_point(high)} m"
        )


def check(scene: Scene, overrides: Overrides = ()) -> SceneCheck:
    """Checks a scene without running it: what it selects, what its loads amount to, what is odd.

    Parameters
    ----------
    scene : path or dict
        A scene file, or the same keys as a dict; see `Simulation`.
    overrides : dict or list of str
        Changes to the scene, as after `--set`.

    Returns
    -------
    SceneCheck

    Raises
    ------
    InputError
        For what cannot be simulated. A mesh has `Mesh.check`.

    Examples
    --------
    >>> found = resilin.check("beam.toml")
    >>> print(found)
    >>> found.loads[0]["force"], found.warnings
    """
    if not isinstance(scene, Mapping) and isinstance(scene, str | os.PathLike):
        suffix = Path(os.fsdecode(scene)).suffix
        if suffix not in ("", ".toml"):
            refuse(
                "scene", "a scene file (.toml) or a dict", f'a file "{suffix}"', "read_mesh(path).check() checks a mesh"
            )
    core = _core.Simulation(read_scene(scene, overrides))
    bodies: list[BodyReport] = json.loads(core.bodies())
    positions = core.rest_positions()
    boxes = {}
    for body in bodies:
        own = positions[slice(*core.vertex_range(body["name"]))]
        boxes[body["name"]] = np.array([own.min(axis=0), own.max(axis=0)])
    return SceneCheck(bodies, boxes, json.loads(core.fixes()), json.loads(core.loads()), list(core.warnings))


def _point(numbers: Sequence[float] | NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{number + 0.0:.6g}" for number in numbers) + ")"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _selection(of: FixReport | LoadReport) -> str:
    nodes = _count(of["nodes"], "node")
    unit = "m" if len(of["center"]) == 2 else "m^2"
    on = f"{_count(of['facets'], 'facet')} ({nodes}, {of['area']:.6g} {unit})" if of["facets"] else nodes
    return f"on {on} about {_point(of['center'])} m"


def _resultant(load: LoadReport) -> str:
    if load["force"] is None:
        return ""
    text = f": force {_point(load['force'])} N"
    moment = np.atleast_1d(np.asarray(load["moment"], dtype=np.float64))
    if not np.any(moment):
        return text
    return f"{text}, moment {_point(moment) if moment.size > 1 else f'{moment[0]:.6g}'} N m"
