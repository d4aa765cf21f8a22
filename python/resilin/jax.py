"""JAX: simulations as functions of arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import jax

    from resilin.typing import Overrides, RealArray, Scene

NEEDED = "jax>=0.4.34"


def simulate(
    scene: Scene, *, overrides: Overrides = (), checkpoints: int = 0, **arrays: RealArray | jax.Array
) -> jax.Array:
    """The places of all nodes as a function of numbers of the scene, through which jax.grad and jax.jit go.

    Statics and motion, by the adjoint of `resilin.value_and_gradient`, on the CPU. First derivatives, in reverse
    alone: jax.grad, jax.vjp, jax.jacrev; jax.vmap runs the whole batch on all cores.

    Parameters
    ----------
    scene : path or dict
        As for `resilin.run`.
    checkpoints : int
        As for `resilin.value_and_gradient`.
    **arrays
        By the keys of the scene, given with **: {"body.beam.material.youngs_modulus": E}; they take the place of what
        the scene says. An array (M,) for a constant is one number for each cell.

    Returns
    -------
    array (T, N, d)
        [m], float64; frame 0 is the start, the last is the equilibrium or the end of the motion. At rest those between
        are at load factors k / load_steps; steps that had to be halved on the way do not count.

    Raises
    ------
    InputError
        As `resilin.value_and_gradient`, while jax_enable_x64 is off, and where load steps with friction were halved,
        since there the way matters. Within jax.jit errors of a run come as JAX's own, which hold the line.
    ImportError
        Where JAX is missing.

    Examples
    --------
    >>> jax.config.update("jax_enable_x64", True)
    >>> def tip(E):
    ...     return resilin.jax.simulate("beam.toml", **{"body.beam.material.youngs_modulus": E})[-1, :, 2].min()
    >>> jax.jit(jax.value_and_grad(tip))(1e6)
    """
    try:
        from resilin.jax_simulation import simulate_at_jax_arrays
    except ImportError as error:
        raise ImportError(f"resilin.jax needs {NEEDED}: pip install 'resilin[jax]' ({error})") from error
    return simulate_at_jax_arrays(scene, overrides, checkpoints, arrays)
