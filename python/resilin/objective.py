"""Objectives of gradients: sums of measured terms, or a function of the results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from resilin.arrays import plain_text, real_array, refuse

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin import _core

    Floats = NDArray[np.float64]
    #: changes of positions, velocities (None at rest), reactions, and of each parameter
    FrameChange = tuple[Floats, Floats | None, Floats, list[Floats]]

AXES = "xyz"


class FrameSlopes(NamedTuple):
    """Slopes of a number by what comes out at a frame, and by the parameters with that held."""

    frame: int
    positions: Floats | None = None  #: (N, d)
    velocities: Floats | None = None  #: (N, d)
    reactions: Floats | None = None  #: (S, 3)
    parameters: list[Floats] | None = None  #: each flat


class Outcome(NamedTuple):
    """Argument of an objective function: T frames, the first is the start."""

    positions: Floats  #: (T, N, d) [m], all nodes, one body after another
    times: Floats  #: (T,) [s]
    loads: Floats  #: (T,) load factors of a static run
    reactions: dict[str, Floats]  #: (T, 3) [N] of each support
    velocities: Floats | None = None  #: (T, N, d) [m/s]; None at rest


class Measure:
    """Numbers y of one frame, linear in what comes out or nearly so: r = (y - target) / sigma, or one of y itself."""

    def __init__(self, frame: int, entries: Mapping[str, Any], place: str, size: int, dim: int) -> None:
        self.frame = frame
        self.size = size
        sigma = np.asarray(real_array(entries.get("sigma", 1.0), f"{place}.sigma"), dtype=np.float64)
        if not np.all(sigma > 0):
            refuse(f"{place}.sigma", "positive numbers", str(sigma.min()))
        if sigma.size > 1 and sigma.size * dim == size:  # one for each marker
            sigma = np.repeat(sigma, dim)
        if sigma.size not in (1, size):
            refuse(f"{place}.sigma", f"1 number, or {size}", str(sigma.size))
        self.scale: Floats = np.broadcast_to(1 / sigma.ravel(), (size,))
        self.target: Floats = np.zeros(size)
        self.weights: Floats = np.zeros(size)  # without a target
        self.has_target = "target" in entries
        if self.has_target:
            target = np.asarray(real_array(entries["target"], f"{place}.target"), dtype=np.float64)
            if target.size != size:
                refuse(f"{place}.target", f"{size} numbers", str(target.size))
            self.target = target.ravel()
            return
        weight = float(entries.get("weight", 1.0))
        component = entries.get("component")
        if dim == 1:
            self.weights[:] = weight
        elif isinstance(component, str) and component in tuple(AXES[:dim]):
            self.weights[AXES.index(component) :: dim] = weight
        else:
            refuse(f"{place}.component", 'a target, or a component such as "z"', repr(component))

    def numbers(self, run: _core.DifferentiatedRun) -> Floats:
        raise NotImplementedError

    def slopes(self, by: Floats) -> FrameSlopes:
        raise NotImplementedError

    def change(self, of: FrameChange) -> Floats:
        raise NotImplementedError


class PlaceMeasure(Measure):
    """Places of markers, or their displacements."""

    def __init__(
        self,
        frame: int,
        entries: Mapping[str, Any],
        place: str,
        markers: list[tuple[Any, Any]],
        offset: Floats,
        num_nodes: int,
    ) -> None:
        dim = offset.shape[1]
        super().__init__(frame, entries, place, len(markers) * dim, dim)
        self.markers, self.offset, self.num_nodes = markers, offset, num_nodes

    def _at(self, nodes: Floats) -> Floats:
        return np.array([np.asarray(weights) @ nodes[np.asarray(ids)] for ids, weights in self.markers])

    def numbers(self, run: _core.DifferentiatedRun) -> Floats:
        return (self._at(run.positions(self.frame)) - self.offset).ravel()

    def slopes(self, by: Floats) -> FrameSlopes:
        nodes = np.zeros((self.num_nodes, self.offset.shape[1]))
        for (ids, weights), row in zip(self.markers, by.reshape(self.offset.shape), strict=True):
            np.add.at(nodes, np.asarray(ids), np.outer(weights, row))
        return FrameSlopes(self.frame, nodes)

    def change(self, of: FrameChange) -> Floats:
        return self._at(of[0]).ravel()


class ReactionMeasure(Measure):
    """The force of a support on the body."""

    def __init__(self, frame: int, entries: Mapping[str, Any], place: str, support: int, count: int, dim: int) -> None:
        super().__init__(frame, entries, place, dim, dim)
        self.support, self.count, self.dim = support, count, dim

    def numbers(self, run: _core.DifferentiatedRun) -> Floats:
        return run.reactions(self.frame)[self.support, : self.dim]

    def slopes(self, by: Floats) -> FrameSlopes:
        rows = np.zeros((self.count, 3))
        rows[self.support, : self.dim] = by
        return FrameSlopes(self.frame, reactions=rows)

    def change(self, of: FrameChange) -> Floats:
        return of[2][self.support, : self.dim]


class DirectMeasure(Measure):
    """Numbers that come with all their slopes, those by the parameters with the places held included.

    `measured`: for each its value and its slopes by positions, velocities (None: by none) and parameters.
    """

    def __init__(
        self,
        frame: int,
        entries: Mapping[str, Any],
        place: str,
        measured: Sequence[tuple[float, Floats | None, Floats | None, list[Floats]]],
        dim: int = 1,
    ) -> None:
        super().__init__(frame, entries, place, len(measured), dim)
        self.measured = measured

    def numbers(self, run: _core.DifferentiatedRun) -> Floats:  # noqa: ARG002
        return np.array([value for value, *_ in self.measured])

    def slopes(self, by: Floats) -> FrameSlopes:
        return FrameSlopes(
            self.frame,
            self._sum(by, [one[1] for one in self.measured]),
            self._sum(by, [one[2] for one in self.measured]),
            None,
            [weighted(by, of_one) for of_one in zip(*(one[3] for one in self.measured), strict=True)],
        )

    @staticmethod
    def _sum(by: Floats, slopes: Sequence[Floats | None]) -> Floats | None:
        given = [one for one in slopes if one is not None]
        return weighted(by, given) if given else None

    def change(self, of: FrameChange) -> Floats:
        changes = []
        for _, by_positions, by_velocities, by_parameters in self.measured:
            change = sum((slopes @ d for slopes, d in zip(by_parameters, of[3], strict=True)), 0.0)
            if by_positions is not None:
                change += np.sum(by_positions * of[0])
            if by_velocities is not None and of[1] is not None:
                change += np.sum(by_velocities * of[1])
            changes.append(change)
        return np.array(changes)


def weighted(by: Floats, arrays: Sequence[Floats]) -> Floats:
    """sum_i by_i arrays_i"""
    total: Floats = np.zeros_like(arrays[0])
    for weight, array in zip(by, arrays, strict=True):
        total += weight * array
    return total


def _tables(objective: Mapping[str, Any]) -> list[tuple[str, str, Mapping[str, Any]]]:
    """(kind, place, entries) of each term; a kind may have a list of them."""
    tables = []
    for kind, entries in objective.items():
        if kind not in KEYS:
            refuse(f"objective.{kind}", "one of " + ", ".join(sorted(KEYS)), "an unknown term")
        for i, one in enumerate(entries if isinstance(entries, Sequence) else [entries]):
            place = f"objective.{kind}" + (f"[{i}]" if isinstance(entries, Sequence) else "")
            if not isinstance(one, Mapping):
                refuse(place, "a dict", type(one).__name__)
            tables.append((kind, place, one))
    return tables


KEYS = {
    "position": {"body", "at"},
    "displacement": {"body", "at"},
    "probe": {"name"},
    "reaction": {"of"},
    "volume": {"body"},
    "energy": {"kind", "body"},
    "stress": {"body", "at"},
    "section": {"name"},
    "moment": {"name"},
}
COMMON_KEYS = {"target", "sigma", "frame", "component", "weight"}


def measures_of(objective: Mapping[str, Any], run: _core.DifferentiatedRun) -> list[Measure]:
    """The terms of an objective that is a dict."""
    measures: list[Measure] = []
    for kind, place, entries in _tables(objective):
        for key in entries:
            if key not in KEYS[kind] | COMMON_KEYS:
                refuse(f"{place}.{key}", "one of " + ", ".join(sorted(KEYS[kind] | COMMON_KEYS)), "an unknown key")
        number = int(entries.get("frame", -1))
        frame = number + run.num_frames if number < 0 else number
        if not 0 <= frame < run.num_frames:
            refuse(f"{place}.frame", f"a frame from 0 to {run.num_frames - 1}", str(number))
        start = run.positions(0)
        dim = start.shape[1]
        if kind in ("position", "displacement"):
            at = _places(entries, place, dim)
            body = plain_text(entries.get("body", ""), f"{place}.body")
            markers = run.markers(body, at.tolist())
            offset = at if kind == "displacement" else np.zeros_like(at)
            measures.append(PlaceMeasure(frame, entries, place, list(markers), offset, len(start)))
        elif kind == "probe":
            node = run.probe(plain_text(entries.get("name", ""), f"{place}.name"))
            rest = run.rest_position(node)[np.newaxis, :dim]
            measures.append(PlaceMeasure(frame, entries, place, [([node], [1.0])], rest, len(start)))
        elif kind == "reaction":
            names = run.supports()
            name = plain_text(entries.get("of", ""), f"{place}.of")
            if name in run.colliders() and name not in names:
                force = run.collider_force(name, frame)
                measures.append(DirectMeasure(frame, entries, place, force, dim))
                continue
            if name not in names:
                refuse(f"{place}.of", "one of " + ", ".join(names + run.colliders()), repr(name))
            measures.append(ReactionMeasure(frame, entries, place, names.index(name), len(names), dim))
        else:
            measures.append(_direct_measure(kind, frame, entries, place, run, dim))
    return measures


def _places(entries: Mapping[str, Any], place: str, dim: int) -> Floats:
    at = np.atleast_2d(np.asarray(real_array(entries.get("at", ()), f"{place}.at"), dtype=np.float64))
    if at.shape[1] != dim:
        refuse(f"{place}.at", f"places of {dim} numbers, in the reference configuration", f"{at.shape[1]} numbers")
    return at


def _direct_measure(
    kind: str, frame: int, entries: Mapping[str, Any], place: str, run: _core.DifferentiatedRun, dim: int
) -> DirectMeasure:
    body = plain_text(entries.get("body", ""), f"{place}.body")
    if kind == "volume":
        volume, by_positions = run.volume(body, frame)
        none: list[NDArray[np.float64]] = [np.zeros(numbers.size) for _, _, numbers in run.parameters()]
        return DirectMeasure(frame, entries, place, [(volume, by_positions, None, none)])
    if kind == "energy":
        which = plain_text(entries.get("kind", ""), f"{place}.kind")
        return DirectMeasure(frame, entries, place, run.energy(which, body or None, frame))
    if kind == "section":
        name = plain_text(entries.get("name", ""), f"{place}.name")
        return DirectMeasure(frame, entries, place, run.section(name, frame), dim)
    if kind == "moment":
        name = plain_text(entries.get("name", ""), f"{place}.name")
        return DirectMeasure(frame, entries, place, run.moment(name, frame), 3)
    component = plain_text(entries.get("component", ""), f"{place}.component")
    stresses = run.stress(body, _places(entries, place, dim).tolist(), component, frame)
    return DirectMeasure(frame, entries, place, stresses)


class Sum:
    """An objective that is a sum of terms: 1/2 |r|^2 over those with a target, the numbers themselves without."""

    def __init__(self, objective: Mapping[str, Any], run: _core.DifferentiatedRun) -> None:
        self.measures = measures_of(objective, run)
        numbers = [measure.numbers(run) for measure in self.measures]
        self.residuals = self._joined(
            [(y - m.target) * m.scale for m, y in zip(self.measures, numbers, strict=True) if m.has_target]
        )
        linear = [m.weights @ y for m, y in zip(self.measures, numbers, strict=True) if not m.has_target]
        self.value = float(0.5 * self.residuals @ self.residuals + sum(linear))

    @staticmethod
    def _joined(parts: list[Floats]) -> Floats:
        return np.concatenate(parts) if parts else np.zeros(0)

    def slopes(self) -> list[FrameSlopes]:
        linear = [m.slopes(m.weights) for m in self.measures if not m.has_target]
        return self.slopes_of_residuals(self.residuals) + linear

    def slopes_of_residuals(self, by: Floats) -> list[FrameSlopes]:
        slopes, first = [], 0
        for measure in self.measures:
            if measure.has_target:
                slopes.append(measure.slopes(by[first : first + measure.size] * measure.scale))
                first += measure.size
        return slopes

    def change_of_residuals(self, frames: Sequence[FrameChange]) -> Floats:
        return self._joined([m.scale * m.change(frames[m.frame]) for m in self.measures if m.has_target])

    def change(self, frames: Sequence[FrameChange]) -> float:
        linear = [m.weights @ m.change(frames[m.frame]) for m in self.measures if not m.has_target]
        return float(self.residuals @ self.change_of_residuals(frames) + sum(linear))


class Seeds:
    """Slopes of a number by what comes out, as a caller gives them."""

    def __init__(self, seed: object, run: _core.DifferentiatedRun) -> None:
        table = seed if isinstance(seed, Mapping) else {"positions": seed}
        start = run.positions(0)
        self.parts: list[FrameSlopes] = []
        for key, value in table.items():
            if key == "reactions":
                self._add_reactions(value, run)
            elif key in ("positions", "velocities"):
                shape = (run.num_frames, *start.shape)
                array = np.asarray(real_array(value, f"seed.{key}"), dtype=np.float64)
                if array.shape == start.shape:
                    rows = [(run.num_frames - 1, array)]
                elif array.shape == shape:
                    rows = [(frame, array[frame]) for frame in range(len(array)) if np.any(array[frame])]
                else:
                    refuse(f"seed.{key}", f"an array {shape} or, of the last frame, {start.shape}", str(array.shape))
                for frame, row in rows:
                    whole = np.ascontiguousarray(row)
                    is_position = key == "positions"
                    self.parts.append(
                        FrameSlopes(frame, positions=whole) if is_position else FrameSlopes(frame, velocities=whole)
                    )
            else:
                refuse(f"seed.{key}", "positions, velocities or reactions", "an unknown key")

    def _add_reactions(self, value: object, run: _core.DifferentiatedRun) -> None:
        names = run.supports()
        if not isinstance(value, Mapping):
            refuse("seed.reactions", "a dict by the names of boundary conditions", type(value).__name__)
        for name, array in value.items():
            if name not in names:
                refuse(f"seed.reactions.{name}", "one of " + ", ".join(names), "an unknown boundary condition")
            rows = np.asarray(real_array(array, f"seed.reactions.{name}"), dtype=np.float64)
            if rows.shape == (3,):
                rows = np.vstack([np.zeros((run.num_frames - 1, 3)), rows])
            if rows.shape != (run.num_frames, 3):
                refuse(f"seed.reactions.{name}", f"an array ({run.num_frames}, 3) or (3,)", str(rows.shape))
            for frame, row in enumerate(rows):
                if np.any(row):
                    all_rows = np.zeros((len(names), 3))
                    all_rows[names.index(name)] = row
                    self.parts.append(FrameSlopes(frame, reactions=all_rows))

    def slopes(self) -> list[FrameSlopes]:
        return self.parts


class Function(Seeds):
    """An objective that is a function: it gives its value and its slopes by what comes out."""

    def __init__(
        self, objective: Callable[[Outcome], tuple[float, Any]], outcome: Outcome, run: _core.DifferentiatedRun
    ) -> None:
        answer = objective(outcome)
        if not (isinstance(answer, tuple) and len(answer) == 2):
            refuse(
                "objective",
                "(value, slopes) from the function",
                type(answer).__name__,
                'such as (value, {"positions": dvalue_dpositions})',
            )
        self.value = float(answer[0])
        super().__init__(answer[1], run)
