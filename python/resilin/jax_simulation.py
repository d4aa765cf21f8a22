"""Simulations that JAX differentiates, compiles and maps over."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np

from resilin import _core
from resilin.array_simulation import ArrayRun
from resilin.arrays import refuse
from resilin.scene import read_scene

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from resilin.typing import Overrides, Scene

    Floats = NDArray[np.float64]

MOST_RUNS = 2  #: runs kept for the adjoint pass, as long as the function is


class _Simulation:
    """Places of all nodes at arrays, and slopes back to them, with the dimensions in front that vmap adds.

    `shapes` are those without; a dimension of 1 in front stands for all of a batch.
    """

    def __init__(
        self, scene: Scene, overrides: Overrides, checkpoints: int, shapes: Mapping[str, tuple[int, ...]]
    ) -> None:
        self._scene, self._overrides, self._checkpoints = scene, overrides, checkpoints
        self._shapes = dict(shapes)
        sizes = {name: math.prod(shape) for name, shape in shapes.items()}
        self.shape: tuple[int, ...] = tuple(_core.simulation_shape(read_scene(scene, overrides), sizes))
        self._runs: OrderedDict[tuple[bytes, ...], ArrayRun] = OrderedDict()
        self._lock = threading.Lock()

    def positions(self, *arrays: Any) -> Floats:
        values, front = self._read(arrays)
        return self._run(values, front).positions.reshape((*front, *self.shape))

    def slopes(self, by_positions: Any, *arrays: Any) -> tuple[Floats, ...]:
        seed = np.asarray(by_positions, dtype=np.float64)
        values, front = self._read(arrays)
        whole = np.broadcast_shapes(self._front(seed, self.shape), front)
        seeds = np.broadcast_to(seed, (*whole, *self.shape)).reshape(-1, *self.shape)
        shapes = list(self._shapes.values())
        if math.prod(front) == 1:
            run = self._run(values, front)
            each = [run.slopes(one, shapes) for one in seeds]
            found = [np.array([of[i] for of in each]) for i in range(len(shapes))]
        else:
            run = self._run(values, whole)
            found = run.slopes(seeds, [(len(seeds), *shape) for shape in shapes])
        return tuple(of.reshape((*whole, *shape)) for of, shape in zip(found, shapes, strict=True))

    @staticmethod
    def _front(array: Floats, shape: Sequence[int]) -> tuple[int, ...]:
        return array.shape[: array.ndim - len(shape)]

    def _read(self, arrays: Sequence[Any]) -> tuple[dict[str, Floats], tuple[int, ...]]:
        values = {name: np.asarray(array, dtype=np.float64) for name, array in zip(self._shapes, arrays, strict=True)}
        fronts = [self._front(value, self._shapes[name]) for name, value in values.items()]
        return values, np.broadcast_shapes(*fronts)

    def _run(self, values: Mapping[str, Floats], front: tuple[int, ...]) -> ArrayRun:
        """Runs one set of arrays, or a batch; keeps the last ones, since derivatives are asked for after."""
        size = math.prod(front)
        flat = {}
        for name, value in values.items():
            shape = self._shapes[name]
            whole = np.ascontiguousarray(np.broadcast_to(value, (*front, *shape)))
            flat[name] = whole.reshape((size, *shape) if size > 1 else shape)
        key = tuple(value.tobytes() for value in flat.values())
        with self._lock:
            if key in self._runs:
                self._runs.move_to_end(key)
                return self._runs[key]
        run = ArrayRun(self._scene, flat, self._overrides, self._checkpoints, size > 1)
        if run.num_steps_beside_way > 0:
            refuse(
                "resilin.jax.simulate",
                "load steps that converge, because with friction the load history matters",
                f"{run.num_steps_beside_way} that were halved",
                "take more simulation.load_steps",
            )
        with self._lock:
            self._runs[key] = run
            while len(self._runs) > MOST_RUNS:
                self._runs.popitem(last=False)
        return run


def _double(value: object, name: str) -> jax.Array:
    array = jnp.asarray(value)
    if not (jnp.issubdtype(array.dtype, jnp.floating) or jnp.issubdtype(array.dtype, jnp.integer)):
        refuse(name, "real numbers", str(array.dtype))
    return array.astype(jnp.float64)


def simulate_at_jax_arrays(
    scene: Scene, overrides: Overrides, checkpoints: int, given: Mapping[str, object]
) -> jax.Array:
    if not jax.config.jax_enable_x64:
        refuse(
            "resilin.jax.simulate",
            "JAX with numbers of double precision",
            "jax_enable_x64 = False",
            'call jax.config.update("jax_enable_x64", True) before arrays are made',
        )
    arrays = [_double(value, name) for name, value in given.items()]
    shapes = {name: array.shape for name, array in zip(given, arrays, strict=True)}
    simulation = _Simulation(scene, overrides, checkpoints, shapes)
    out = jax.ShapeDtypeStruct(simulation.shape, jnp.float64)
    like = tuple(jax.ShapeDtypeStruct(shape, jnp.float64) for shape in shapes.values())

    def call(function: Any, result: Any, *inputs: jax.Array) -> Any:
        if any(isinstance(one, jax.core.Tracer) for one in inputs):
            return jax.pure_callback(function, result, *inputs, vmap_method="expand_dims")
        return jax.tree_util.tree_map(jnp.asarray, function(*inputs))  # nothing is compiled, and errors are plain

    @jax.custom_vjp
    def positions(*inputs: jax.Array) -> jax.Array:
        return call(simulation.positions, out, *inputs)

    def forward(*inputs: jax.Array) -> tuple[jax.Array, tuple[jax.Array, ...]]:
        return positions(*inputs), inputs

    def backward(inputs: tuple[jax.Array, ...], by_positions: jax.Array) -> Any:
        return call(simulation.slopes, like, by_positions, *inputs)

    positions.defvjp(forward, backward)
    places: jax.Array = positions(*arrays)
    return places
