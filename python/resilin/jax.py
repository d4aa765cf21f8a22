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
    """Nodal positions as a function of parameters of the scene, for jax.grad and jax.jit.

    Static and dynamic runs with the adjoint of `resilin.value_and_gradient`, on the CPU. First derivatives in reverse
    mode only: jax.grad, jax.vjp, jax.jacrev; jax.vmap runs the whole batch on all cores.

    Parameters
    ----------
    scene : path or dict
        As for `resilin.run`.
    overrides : dict or list of "KEY=VALUE"
        Changes of the scene.
    checkpoints : int
        As for `resilin.value_and_gradient`.
    **arrays
        Parameters by key, given with **: {"body.beam.material.youngs_modulus": E}; they replace values of the scene. An
        array (M,) for a constant has one value for each cell.

    Returns
    -------
    array (T, N, d)
        [m], float64; frame 0 is the start, the last is the equilibrium or the end of the dynamic run. In statics the
        others are at load factors k / load_steps; cutbacks are left out.

    Raises
    ------
    InputError
        As for `resilin.value_and_gradient`; if jax_enable_x64 is off; and for load cutbacks with friction, because then
        the load history matters. Within jax.jit an error of a run arrives as a JAX error that contains our line.
    ImportError
        If JAX is missing.

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
