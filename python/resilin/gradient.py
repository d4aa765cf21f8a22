"""Gradients of simulations: exact derivatives through equilibrium and motion."""

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
    """The names of all parameters by which the results of a scene can be differentiated.

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
    """Runs a scene and gives an objective and its exact gradient by numbers of the scene, all at once.

    One adjoint solution for each equilibrium or time step, whatever the number of parameters; see docs/gradients.md.

    Parameters
    ----------
    scene : path or dict
        As for `run`.
    objective : dict or function
        Terms by kind: "position", "displacement" (of markers `at` places of the rest shape), "probe" (`name`),
        "reaction" (`of` a support, or of a collider without friction), "volume" (of a `body`), "energy" (`kind`
        "elastic" or "kinetic", of a `body` or of all), "stress" (`at` places, `component` "von_mises", "xx", "xy" ...),
        "section" and "moment" (the force through the section `name` and its moment about the middle of the cut); each
        with `target` and `sigma`, or a list of such. The value is
        1/2 sum ((y - target) / sigma)^2; a term without target adds its `component` itself. `frame` is the last unless
        given. Or a function of an `Outcome` that gives its value and {"positions": slopes (T, N, d)}.
    wrt : list of str
        Keys of the scene: "body.beam.material.youngs_modulus"; `resilin.parameter_names(scene)` has them all.
    checkpoints : int
        Motion: 0 keeps the places of all steps; k keeps k states and makes the steps between them again, to the same
        bits.
    values : dict
        Numbers in place of those of the scene, by the names of its parameters.
    batch : bool
        `values` have a leading dimension B: as many runs of the one scene, on all cores, to the bits of one after
        another.

    Returns
    -------
    Differentiated, or DifferentiatedBatch
        Unpacks as `value, gradients`; of a batch they have the leading dimension.

    Raises
    ------
    InputError
        For an unknown parameter, a marker outside the body, a run that does not converge, an equilibrium that is not
        stable, and for what is not differentiable yet.

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
    """The gradients of `value_and_gradient` alone."""
    return value_and_gradient(scene, objective, wrt, overrides=overrides, checkpoints=checkpoints).gradients
