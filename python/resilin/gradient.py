"""Exact gradients of static and dynamic simulations (adjoint method)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, overload

from resilin import _core
from resilin.differentiated import Differentiated, differentiated
from resilin.differentiated_batch import DifferentiatedBatch, differentiated_batch
from resilin.scene import read_scene

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from resilin.differentiated import Numbers, Objective
    from resilin.typing import Overrides, RealArray, Scene


def parameter_names(scene: Scene, overrides: Overrides = ()) -> list[str]:
    """Lists all differentiable parameters of a scene.

    Parameters
    ----------
    scene : path or dict
        As for `run`.
    overrides : dict or list of "KEY=VALUE"
        Changes of the scene.

    Returns
    -------
    list of str
        "body.beam.material.youngs_modulus", "load.tip.value", "collider.ground.friction" ...
    """
    return list(_core.parameter_names(read_scene(scene, overrides)))


@overload
def value_and_gradient(
    scene: Scene,
    objective: Objective,
    wrt: Iterable[str],
    *,
    overrides: Overrides = (),
    checkpoints: int = 0,
    values: Mapping[str, RealArray] | None = None,
    batch: Literal[False] = False,
) -> Differentiated: ...


@overload
def value_and_gradient(
    scene: Scene,
    objective: Objective,
    wrt: Iterable[str],
    *,
    overrides: Overrides = (),
    checkpoints: int = 0,
    values: Mapping[str, RealArray] | None = None,
    batch: Literal[True],
) -> DifferentiatedBatch: ...


def value_and_gradient(
    scene: Scene,
    objective: Objective,
    wrt: Iterable[str],
    *,
    overrides: Overrides = (),
    checkpoints: int = 0,
    values: Mapping[str, RealArray] | None = None,
    batch: bool = False,
) -> Differentiated | DifferentiatedBatch:
    """Runs a scene and returns an objective and its exact gradient by parameters of the scene.

    The cost is one adjoint solve for each equilibrium or time step, for any number of parameters; see
    docs/gradients.md.

    Parameters
    ----------
    scene : path or dict
        As for `run`.
    objective : dict or function
        Terms by kind: "position", "displacement" (of markers `at` points of the reference configuration), "probe"
        (`name`), "reaction" (`of` a boundary condition, or of a collider without friction), "volume" (of a `body`),
        "energy" (`kind` "elastic" or "kinetic", of a `body` or of all), "stress" (`at` points, `component` "von_mises",
        "xx", "xy" ...), "section" and "moment" (the force through the section `name` and its moment about the centroid
        of the cut); each with `target` and `sigma`, or a list of them. The value is 1/2 sum ((y - target) / sigma)^2; a
        term without target adds its `component` itself. `frame` is the last by default. Alternatively a function of an
        `Outcome` that returns its value and {"positions": derivatives (T, N, d)}.
    wrt : list of str
        Keys of the scene: "body.beam.material.youngs_modulus"; `resilin.parameter_names(scene)` has them all.
    overrides : dict or list of "KEY=VALUE"
        Changes of the scene.
    checkpoints : int
        Dynamics: 0 stores the positions of all steps; k stores k states and recomputes the steps between them, with
        bitwise equal results.
    values : dict
        Values that replace those of the scene, by parameter name.
    batch : bool
        `values` have a leading dimension B: B runs of one scene on all cores, bitwise equal to single runs.

    Returns
    -------
    Differentiated, or DifferentiatedBatch
        Unpacks as `value, gradients`; for a batch with a leading dimension.

    Raises
    ------
    InputError
        For an unknown parameter, a marker outside the body, an unconverged run, an unstable equilibrium, and for
        unsupported cases.

    Examples
    --------
    >>> objective = {"position": {"at": [4, 0, 0], "target": [3.5, 0, -1], "sigma": 1e-3}}
    >>> value, gradients = resilin.value_and_gradient("beam.toml", objective, ["body.beam.material.youngs_modulus"])
    """
    if batch:
        return differentiated_batch(scene, objective, wrt, overrides, values or {}, checkpoints)
    return differentiated(scene, objective, wrt, overrides, values, checkpoints)


def gradient(
    scene: Scene, objective: Objective, wrt: Iterable[str], *, overrides: Overrides = (), checkpoints: int = 0
) -> dict[str, Numbers]:
    """Runs a scene and returns the exact gradient of an objective by parameters of the scene.

    `value_and_gradient` returns the value of the objective as well.

    Parameters
    ----------
    scene, objective, wrt, overrides, checkpoints
        As for `value_and_gradient`.

    Returns
    -------
    dict
        {key: gradient}, each with the shape of its parameter, in the unit of the objective per unit of the parameter.
    """
    return value_and_gradient(scene, objective, wrt, overrides=overrides, checkpoints=checkpoints).gradients
