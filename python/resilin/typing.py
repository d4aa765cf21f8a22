"""Types for annotations of programs that use Resilin; they have no effect at run time.

Results are `numpy.typing.NDArray`. Arguments may be anything that `numpy.asarray` converts to real numbers
(`RealArray`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, Protocol, TypeAlias, TypedDict, TypeVar

import numpy as np
from numpy.typing import NDArray

T_co = TypeVar("T_co", covariant=True)


class HasArray(Protocol):
    """Arrays, numpy's single numbers, and what other packages let numpy read as an array."""

    def __array__(self) -> np.ndarray[Any, np.dtype[np.floating[Any] | np.integer[Any]]]: ...


class TensorLike(Protocol[T_co]):
    """torch.Tensor, with itself as T_co, for a reader of types that has no torch at hand."""

    @property
    def requires_grad(self) -> bool: ...

    def double(self) -> T_co: ...


Number: TypeAlias = "float | HasArray"
RealArray: TypeAlias = "Number | Sequence[Number | Sequence[Number | Sequence[Number | Sequence[Number]]]]"
Constant: TypeAlias = "RealArray | TensorLike[Any]"
IntegerArray: TypeAlias = "HasArray | Sequence[HasArray | Sequence[int]] | Sequence[int]"
AnyPath: TypeAlias = "str | PathLike[str]"

#: A file, or a dict with the keys of docs/scene.md
Scene: TypeAlias = "AnyPath | Mapping[str, object]"
#: {"newton.tolerance": 1e-6} or ["newton.tolerance=1e-6"]
Overrides: TypeAlias = "Mapping[str, object] | Iterable[str]"

Projection: TypeAlias = Literal["clamp", "absolute"] | None
MassKind: TypeAlias = Literal["lumped", "consistent"]
BoxPattern: TypeAlias = Literal["kuhn6", "five", "hexahedra"]
RectanglePattern: TypeAlias = Literal["uniform", "alternating", "quadrilaterals"]
CurveKind: TypeAlias = Literal["uniaxial", "equibiaxial", "planar", "shear", "volumetric"]
ColorMap: TypeAlias = Literal["auto", "viridis", "diverging"]
StressKind: TypeAlias = Literal["nominal", "cauchy"]
Loss: TypeAlias = Literal["stress_drops", "directions_part", "not_elliptic", "no_state"]
#: Value of a control of a LiveScene; vectors are lists of three numbers.
ControlValue: TypeAlias = "bool | float | str | list[float]"
StepStatus: TypeAlias = Literal["converged", "not_converged"]
SweepMethod: TypeAlias = Literal["grid", "list", "latin_hypercube", "sobol"]
#: {"body.beam.scale": [1, 2, 3]} or {"body.beam.scale": {"uniform": [1, 3]}}
SweepParameters: TypeAlias = "Mapping[str, Sequence[object] | NDArray[Any] | Mapping[str, Sequence[object]]]"
#: "probe.tip.displacement.z" or {"name": ..., "of": ..., "over": ...}
SweepQuantity: TypeAlias = "str | Mapping[str, str]"
RunStatus: TypeAlias = Literal["done", "not_converged", "failed", "budget"]
Triplets: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]


class PictureOptions(TypedDict, total=False):
    """Options of pictures; see `Result.plot`."""

    size: Sequence[float]
    view: str | Sequence[float]
    up: Literal["auto", "x", "y", "z"]
    range: Sequence[float] | None
    map: ColorMap
    scale: float
    edges: bool | None
    rest: bool
    colliders: bool
    bar: bool
    caption: bool
    dark: bool
    transparent: bool


class _Mode(TypedDict):
    number: int
    frequency: float
    rigid: bool
    unstable: bool
    effective_mass: list[float]


class ModeReport(_Mode, total=False):
    """A vibration mode; its growth rate if it is unstable."""

    growth_rate: float


class EnergyReport(TypedDict):
    """Energies [J]."""

    elastic: float
    kinetic: float
    external: float
    contact: float
    total: float
    dissipated: float
    friction: float


class MomentumReport(TypedDict):
    linear: list[float]
    angular: list[float]


class ProbeReport(TypedDict):
    displacement: list[float]
    velocity: list[float]


class SectionReport(TypedDict):
    force: list[float]
    moment: list[float]
    center: list[float]


class _Extreme(TypedDict):
    value: float
    body: str
    position: list[float]


class ExtremeReport(_Extreme, total=False):
    """An extreme value at a vertex or in a cell, depending on the field."""

    vertex: int
    cell: int


class ExtremesReport(TypedDict):
    min: ExtremeReport
    max: ExtremeReport


class _Contact(TypedDict):
    bodies: list[str]
    force: list[float]
    gap: float
    pairs: int


class ContactReport(_Contact, total=False):
    """Two bodies in contact; the force is on the second, the first feels the opposite. The rest on its surface."""

    area: float
    reference_area: float
    width: float  # in 2D
    pressure: float
    mean_pressure: float
    normal_force: float
    center: list[float]
    extent: list[float]


class _ColliderContact(TypedDict):
    force: list[float]
    area: float
    reference_area: float
    pressure: float
    mean_pressure: float
    normal_force: float
    center: list[float]
    extent: list[float]


class ColliderContactReport(_ColliderContact, total=False):
    """Contact of a collider: its force [N], areas [m^2], the largest and mean true pressure [Pa]. In 2D its width."""

    width: float


class _Frame(TypedDict):
    step: int
    time: float
    load: float
    newton_iterations: int
    linear_iterations: int
    converged: bool
    residual: float
    residual_newton: float
    failed_attempts: int
    unstable_modes: int | None
    min_volume_ratio: float
    worst_cell: int
    worst_body: int
    energy: EnergyReport
    momentum: MomentumReport
    probes: dict[str, ProbeReport]
    reactions: dict[str, list[float]]
    reaction_moments: dict[str, list[float]]
    sections: dict[str, SectionReport]
    contacts: list[ContactReport]
    extremes: dict[str, ExtremesReport]


class FrameReport(_Frame, total=False):
    """A frame of report.json; these where there is one."""

    step_name: str
    collider_contacts: dict[str, ColliderContactReport]
    mode: ModeReport
    time_step: float
    time_error: float
    inversion_load: float
    jump_energy: float
    regions: dict[str, dict[str, dict[str, float]]]  # by body and region


class RegionReport(TypedDict):
    """A region of a body; the body's own material has an empty name."""

    name: str
    law: str
    constants: dict[str, float]
    density: float
    cells: int
    volume: float
    mass: float


class _Body(TypedDict):
    name: str
    law: str
    constants: dict[str, float]
    element: str
    element_reason: str
    quadrature: str
    mass: str
    cells: int
    vertices: int
    unknowns: int


class BodyReport(_Body, total=False):
    """A body of a simulation; regions where it has some."""

    regions: list[RegionReport]


class ReportedBody(BodyReport):
    """A body in the report; `discretisation_error` is an estimate (docs/theory/discretisation.md).

    By "recovered stress" it may be much too low for mixed elements.
    """

    discretisation_error: float | None
    discretisation_error_by: str | None  # "richer space" or "recovered stress"
    # Volume of the cells by the volume inside the skin; None without a closed skin.
    mesh_volume_ratio: float | None


class _Selection(TypedDict):
    name: str
    nodes: int
    facets: int
    area: float
    center: list[float]


class FixReport(_Selection, total=False):
    """Selection of a boundary condition: its area [m^2], and its centre in the frame of `where` [m].

    A support that asks for it has its tangent stiffness [N/m], and that of its rotation [N m/rad].
    """

    stiffness: list[list[float]]
    rotational_stiffness: float


class LoadReport(_Selection):
    """A load; at load factor 1 its force [N] and its moment about the centre [N m], None of a spring."""

    kind: str
    force: list[float] | None
    moment: list[float] | None


class TimingReport(TypedDict):
    """Durations [s]."""

    total: float
    assembly: float
    solve: float
    estimate: float
    output: float


class SmallestVolumeRatio(TypedDict):
    """The smallest volume ratio of all steps, and where it was."""

    value: float
    body: str
    cell: int
    step: int
    time: float
    load: float


class _Report(TypedDict):
    status: RunStatus
    reason: str
    warnings: list[str]
    title: str
    version: str
    dimension: int
    kind: Literal["static", "dynamic", "modes"]
    is_linear: bool
    frames: list[FrameReport]
    bodies: list[ReportedBody]
    fixes: list[FixReport]
    loads: list[LoadReport]
    solver: str
    timing: TimingReport
    peak_memory_MiB: float
    threads: int


class Report(_Report, total=False):
    """The content of report.json (docs/results.md); modes of a modal analysis."""

    modes: list[ModeReport]
    smallest_volume_ratio: SmallestVolumeRatio
