"""Simulations as functions of JAX's arrays."""

import sys

import numpy as np
import pytest
from gradient_scenes import FLOOR, E, bar, halved, motion

jax = pytest.importorskip("jax")
jnp = jax.numpy

import resilin.jax  # noqa: E402

PULL, SHIFT = "load.pull.value", "fix.wall.displacement"


@pytest.fixture(autouse=True)
def double_precision():
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", before)


def places(scene):
    def of(modulus, pull, shift):
        return resilin.jax.simulate(scene, **{E: modulus, PULL: pull, SHIFT: shift})

    return of


INPUTS = (1e5, np.array([30.0, 15.0, 6.0]), np.array([0.01, 0.0, 0.02]))


@pytest.mark.parametrize("scene", [bar(), bar(load_steps=3), motion()])
def test_values_and_gradients_have_the_bits_of_the_python_ones_with_and_without_jit(scene):
    run = resilin.value_and_gradient(
        scene, None, [E, PULL, SHIFT], values=dict(zip((E, PULL, SHIFT), INPUTS, strict=True))
    )
    weights = np.random.default_rng(3).normal(size=run.positions.shape)
    expected = list(run.vjp(weights).values())

    def weighted(*inputs):
        return (weights * places(scene)(*inputs)).sum()

    np.testing.assert_array_equal(places(scene)(*INPUTS), run.positions)
    np.testing.assert_array_equal(jax.jit(places(scene))(*INPUTS), run.positions)
    gradient = jax.grad(weighted, argnums=(0, 1, 2))
    for found in (gradient(*INPUTS), jax.jit(gradient)(*INPUTS), jax.jit(gradient)(*INPUTS)):
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("scene", [bar(), motion()])
def test_gradients_agree_with_differences(scene):
    def tip(modulus):
        return resilin.jax.simulate(scene, **{E: modulus})[-1, :, 2].sum()

    step = 50.0
    difference = (tip(1e5 + step) - tip(1e5 - step)) / (2 * step)
    assert jax.grad(tip)(1e5) == pytest.approx(float(difference), rel=1e-6)


def test_fields_and_whole_numbers_and_numbers_of_other_arrays_go_in():
    def tip(log_modulus):
        return resilin.jax.simulate(bar(), **{E: jnp.exp(log_modulus) * jnp.ones(24), PULL: [10, 0, 0]})[-1, :, 2].sum()

    field = jax.jit(jax.grad(tip))(np.log(1e5))
    same = resilin.value_and_gradient(bar(), None, [E])
    seed = np.zeros_like(same.positions)
    seed[-1, :, 2] = 1
    assert field == pytest.approx(1e5 * same.vjp(seed)[E], rel=1e-9)


def test_vmap_runs_a_batch_and_jacrev_one_run():
    moduli = np.array([1e5, 1.5e5, 2e5])

    def of(modulus, pull):
        return resilin.jax.simulate(bar(), **{E: modulus, PULL: pull})

    pull = np.array([10.0, 0.0, 0.0])
    mapped = jax.vmap(of, (0, None))(moduli, pull)
    one_by_one = np.array([of(modulus, pull) for modulus in moduli])
    np.testing.assert_array_equal(mapped, one_by_one)

    def tip(modulus, pull):
        return of(modulus, pull)[-1, :, 2].sum()

    slopes = jax.jit(jax.vmap(jax.grad(tip, (0, 1)), (0, None)))(moduli, pull)
    for i, modulus in enumerate(moduli):
        for found, expected in zip(slopes, jax.grad(tip, (0, 1))(modulus, pull), strict=True):
            np.testing.assert_array_equal(found[i], expected)
    rows = jax.jacrev(lambda pull: of(1e5, pull)[-1, -2:].ravel())(pull)
    assert rows.shape == (6, 3)
    for k in range(6):
        by_row = jax.grad(lambda pull, k=k: of(1e5, pull)[-1, -2:].ravel()[k])(pull)
        np.testing.assert_array_equal(rows[k], by_row)


@pytest.mark.parametrize("is_compiled", [False, True])
def test_load_steps_that_are_halved_change_nothing(is_compiled):
    def place(modulus, frame=-1, **changes):
        return resilin.jax.simulate(halved(**changes), **{E: modulus})[frame, :, 2].sum()

    of = jax.jit(jax.value_and_grad(place), static_argnums=1) if is_compiled else jax.value_and_grad(place)
    run = resilin.value_and_gradient(halved(), None, [E])
    assert len(run.positions) > 4
    for frame, load in ((1, 0.5), (2, 1.0)):
        value, slope = of(1e5, frame)
        (number,) = np.flatnonzero(run.outcome.loads == load)
        seed = np.zeros_like(run.positions)
        seed[number, :, 2] = 1
        # The order of a sum is that of XLA and of numpy.
        assert value == pytest.approx(run.positions[number, :, 2].sum(), rel=1e-13)
        assert slope == run.vjp(seed)[E]
        smooth, same = jax.value_and_grad(place)(1e5, frame, max_iterations=60)
        assert value == pytest.approx(float(smooth), rel=1e-7)
        assert slope == pytest.approx(float(same), rel=1e-6)
    difference = (place(1e5 + 20) - place(1e5 - 20)) / 40
    assert slope == pytest.approx(float(difference), rel=1e-5)


def test_vmap_goes_over_runs_of_different_load_steps():
    moduli = np.array([1e5, 3e4, 1e7])

    def tip(modulus):
        return resilin.jax.simulate(halved(), **{E: modulus})[-1, :, 2].sum()

    assert len({len(resilin.value_and_gradient(halved(modulus), None, []).positions) for modulus in moduli}) > 1
    values, slopes = jax.vmap(jax.value_and_grad(tip))(moduli)
    for modulus, value, slope in zip(moduli, values, slopes, strict=True):
        expected = jax.value_and_grad(tip)(modulus)
        assert value == pytest.approx(float(expected[0]), rel=1e-13)
        assert slope == expected[1]


def test_frames_are_those_of_the_load_factors_that_are_asked_for():
    turned = bar(load_steps=2)
    turned["fix"][0]["rotate"] = {"axis": [1, 0, 0], "center": [0, 0, 0], "degrees": 200}
    run = resilin.value_and_gradient(turned, None, [E])
    assert len(run.positions) > 3  # a support turns by so much in a step
    places = resilin.jax.simulate(turned, **{E: 1e5})
    np.testing.assert_array_equal(places, run.positions[[0, len(run.positions) // 2, -1]])


@pytest.mark.filterwarnings("ignore:.*with friction the load history matters")
def test_load_steps_that_are_halved_are_refused_with_friction():
    with pytest.raises(resilin.InputError, match="with friction the load history matters") as error:
        resilin.jax.simulate(halved(load_steps=1, max_iterations=12, collider=[FLOOR]), **{E: 1e5})
    assert "\n" not in str(error.value)


def test_forward_mode_is_refused():
    with pytest.raises(TypeError, match="custom_vjp"):
        jax.jvp(lambda modulus: resilin.jax.simulate(bar(), **{E: modulus}), (1e5,), (1.0,))


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"load.pul.value": np.zeros(3)}, "load.pull.value"),
        ({PULL: np.zeros(2)}, "load.pull.value: expected 3 numbers, got 2"),
        ({E: 1j}, "expected real numbers, got complex128"),
        ({E: -1.0}, "youngs_modulus"),
    ],
)
def test_wrong_numbers_are_refused_in_one_line(given, text):
    with pytest.raises(resilin.InputError) as error:
        resilin.jax.simulate(bar(), **given)
    assert text in str(error.value)
    assert "\n" not in str(error.value)


def test_within_jit_the_line_is_part_of_jaxs_error():
    with pytest.raises(Exception, match="youngs_modulus: expected"):
        jax.jit(lambda modulus: resilin.jax.simulate(bar(), **{E: modulus}))(-1.0).block_until_ready()


def test_single_precision_is_refused_with_the_name_of_the_switch():
    jax.config.update("jax_enable_x64", False)
    with pytest.raises(resilin.InputError, match="jax_enable_x64"):
        resilin.jax.simulate(bar(), **{E: 1e5})


def test_where_jax_is_missing_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "jax", None)
    monkeypatch.delitem(sys.modules, "resilin.jax_simulation", raising=False)
    with pytest.raises(ImportError, match=r"resilin\[jax\]"):
        resilin.jax.simulate(bar(), **{E: 1e5})
