"""Inverse design: the rest shape that becomes what was drawn once its loads act."""

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
    """A rest shape that its loads deform into what was drawn."""

    positions: dict[str, Floats]  #: by body, (V, d) [m]: its vertices at rest, in the order of its mesh
    deformed: dict[str, Floats]  #: likewise, where a run of the scene from that shape leads them
    distance: float  #: the largest of a deformed vertex from where it was drawn, or stands on what bears it [m]
    size: float  #: of the bodies as drawn, along the axes [m]
    iterations: int  #: of Newton's method
    overrides: dict[str, float]  #: what scenes from it have besides: distances from which colliders do not press


def find_rest_shape(scene: Scene, *, overrides: Overrides = (), progress: bool | None = None) -> RestShape:
    """Finds the rest shape of the bodies of a scene whose deformed shape is what the scene draws.

    Newton's method on the balance of forces in the shape as drawn, whose unknowns are the rest places; where the loads
    cannot be taken at once, they are raised in parts. The shape found is judged by a run of the scene from it, in the
    scene's own load steps, which has to end within 1e-8 of the size. What touches in the shape as drawn presses there.
    A body that is borne by what it lies on alone comes to stand where that bears it. A rest shape may lie inside of
    colliders, where no run begins but one that begins as drawn. Where a collider leaves no rest shape, of which the
    scene does not say from how far it is felt, it is felt from nearer than it is drawn: `overrides` has that distance,
    for the scene that is made of the shape. Of each of these a warning is given.

    Parameters
    ----------
    scene : path or dict
        Of statics; its meshes are the target. Loads act as always: a weight is that of the mass at rest, and what was
        selected by place as drawn stays selected.
    overrides : dict or list of str
        As for `run`.
    progress : bool, optional
        As for `run`: a line about a search that lasts. Default: in a terminal and in a notebook only.

    Returns
    -------
    RestShape
        Its positions are places in the scene: they make a mesh that is neither scaled, turned nor moved there.

    Raises
    ------
    InputError
        For motion and for friction, and when no such shape is found: up to which part of the loads there was one, and
        what stopped the search.

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
