"""Inverse design: the stress-free shape that deforms into the drawn shape under its loads."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from resilin import _core
from resilin.mesh import warn
from resilin.progress import SearchProgress
from resilin.scene import read_scene

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from resilin.typing import Overrides, Scene

    Floats = NDArray[np.float64]


class RestShape(NamedTuple):
    """A stress-free shape that its loads deform into the drawn shape."""

    positions: dict[str, Floats]  #: by body (V, d) [m]: stress-free positions of its mesh vertices
    deformed: dict[str, Floats]  #: likewise, after a run of the scene from that shape
    distance: float  #: largest distance of a deformed vertex from its target [m]
    size: float  #: largest extent of the drawn bodies along an axis [m]
    iterations: int  #: number of Newton iterations
    overrides: dict[str, float]  #: overrides of the new scene: activation distances of colliders


def find_rest_shape(scene: Scene, *, overrides: Overrides = (), progress: bool | None = None) -> RestShape:
    """Inverse design: finds the stress-free shape whose deformed shape is the one drawn in the scene.

    The method is Newton's method on the equilibrium of the drawn shape, with the reference positions as unknowns. If
    the full load does not converge, the loads are applied in increments. A final run from the found shape, with the
    scene's load steps, must end within 1e-8 of the size.

    Contact in the drawn shape presses as usual. A body that only its contact carries moves until the contact carries
    it. A stress-free shape may overlap colliders; a run must then start from the drawn shape. A collider with a default
    activation distance may leave no stress-free shape. It then gets a smaller activation distance, which `overrides`
    has for the new scene. Each of these cases gives a warning.

    Parameters
    ----------
    scene : path or dict
        A static scene; its meshes are the target shape. Loads act as usual: weights use the reference mass, and
        selections by position in the drawn shape stay selected.
    overrides : dict or list of str
        As for `run`.
    progress : bool, optional
        Whether to show a progress line of a long search; by default in a terminal and in a notebook.

    Returns
    -------
    RestShape
        Its positions are scene coordinates: their mesh is neither scaled, rotated nor translated.

    Raises
    ------
    InputError
        For dynamics and friction, and if no such shape is found: with the fraction of the load reached and the reason.

    Examples
    --------
    >>> found = resilin.find_rest_shape(scene)
    >>> rest = resilin.Mesh(found.positions["beam"], mesh.cells, mesh.groups)
    >>> resilin.run(scene_with(rest), overrides=found.overrides)
    """
    line = SearchProgress(progress)
    try:
        bodies, distance, size, iterations, kept_off, warnings = _core.find_rest_shape(
            read_scene(scene, overrides), line.show if line.is_shown else None
        )
    finally:
        line.end()
    warn(warnings)
    return RestShape(
        {name: rest for name, rest, _ in bodies},
        {name: moved for name, _, moved in bodies},
        distance,
        size,
        iterations,
        {f'collider."{name}".activation_distance': reach for name, reach in kept_off},
    )
