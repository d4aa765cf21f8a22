"""Several sets of numbers for one scene, differentiated side by side."""

import signal
import threading

import numpy as np
import pytest
from gradient_scenes import E, bar, motion

import resilin

PULL = "load.pull.value"
TIP = {"probe": {"name": "tip", "component": "z"}, "position": {"at": [1, 0, 0], "target": [1, 0, -0.1], "sigma": 0.01}}


def numbers(size=5):
    steps = np.linspace(0, 1, size)
    return {E: 1e5 * (1 + steps), PULL: np.outer(1 + steps, [10.0, 3.0, -2.0])}


def runs(scene, objective, wrt, values, **options):
    size = len(next(iter(values.values())))
    each = [{name: array[i] for name, array in values.items()} for i in range(size)]
    return [resilin.value_and_gradient(scene, objective, wrt, values=one, **options) for one in each]


@pytest.mark.parametrize(("scene", "options"), [(bar(), {}), (motion(), {}), (motion(), {"checkpoints": 2})])
def test_a_batch_has_the_bits_of_one_after_another_with_any_number_of_threads(scene, options):
    values = numbers()
    wrt = [*values, "body.bar.rest_positions"]
    before = resilin.num_threads()
    alone = runs(scene, TIP, wrt, values, **options)
    try:
        for threads in (1, 2, 3):
            resilin.set_num_threads(threads)
            batch = resilin.value_and_gradient(scene, TIP, wrt, values=values, batch=True, **options)
            value, gradients = batch
            assert len(batch) == len(alone)
            np.testing.assert_array_equal(value, [one.value for one in alone])
            np.testing.assert_array_equal(batch.positions, [one.positions for one in alone])
            np.testing.assert_array_equal(batch.residuals, [one.residuals for one in alone])
            for name in wrt:
                np.testing.assert_array_equal(gradients[name], [one.gradients[name] for one in alone])
                np.testing.assert_array_equal(batch.parameters[name], [one.parameters[name] for one in alone])
            assert resilin.num_threads() == threads
    finally:
        resilin.set_num_threads(before)
    assert np.ptp(value) > 0


def test_factors_of_several_runs_at_once_have_the_bits_of_each_alone():
    scene = bar()
    scene["body"][0]["mesh"]["box"]["cells"] = [25, 2, 2]  # fronts that a BLAS may share among threads
    values = {E: np.linspace(1e5, 2e5, 12)}
    alone = [one.gradients[E] for one in runs(scene, TIP, [E], values)]
    for _ in range(3):
        batch = resilin.value_and_gradient(scene, TIP, [E], values=values, batch=True)
        np.testing.assert_array_equal(batch.gradients[E], alone)


@pytest.mark.parametrize("scene", [bar(), motion()])
def test_products_of_a_batch_are_those_of_its_runs(scene):
    values = numbers(3)
    batch = resilin.value_and_gradient(scene, TIP, list(values), values=values, batch=True)
    alone = runs(scene, TIP, list(values), values)
    generator = np.random.default_rng(1)
    seeds = generator.normal(size=batch.positions.shape)
    for seed in (seeds, seeds[:, -1], [{"positions": one} for one in seeds]):
        found = batch.vjp(seed)
        for i, one in enumerate(alone):
            expected = one.vjp(seed[i])
            for name in values:
                np.testing.assert_array_equal(found[name][i], expected[name])
    direction = {E: np.array([1e3, -2e3, 5e2])}
    changes, products = batch.jvp(direction), batch.gauss_newton_product(direction)
    for i, one in enumerate(alone):
        expected = one.jvp({E: direction[E][i]})
        np.testing.assert_array_equal(changes["positions"][i], expected["positions"])
        np.testing.assert_array_equal(changes["reactions"]["wall"][i], expected["reactions"]["wall"])
        np.testing.assert_array_equal(changes["residuals"][i], expected["residuals"])
        assert changes["value"][i] == expected["value"]
        np.testing.assert_array_equal(products[PULL][i], one.gauss_newton_product({E: direction[E][i]})[PULL])


def test_moduli_of_each_cell_and_functions_that_are_objectives_come_in_batches():
    field = 1e5 * (1 + np.random.default_rng(2).random((4, 24)))

    def lowest(outcome):
        z = outcome.positions[-1, :, 2]
        slopes = 0 * outcome.positions
        slopes[-1, z.argmin(), 2] = 1
        return z.min(), {"positions": slopes}

    value, gradients = resilin.value_and_gradient(bar(), lowest, [E], values={E: field}, batch=True)
    assert gradients[E].shape == (4, 24)
    for i, one in enumerate(runs(bar(), lowest, [E], {E: field})):
        assert value[i] == one.value
        np.testing.assert_array_equal(gradients[E][i], one.gradients[E])


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({}, "values: expected numbers by the names of parameters"),
        ({E: 1e5}, "the batch as its leading dimension"),
        ({E: [1e5, 2e5], PULL: np.ones((3, 3))}, "the batch as its leading dimension, (3, ...), got (2,)"),
        ({E: [1e5, 2e5, -1.0, -2.0]}, "scene 3 of 4: "),
        ({PULL: np.ones((2, 2))}, "load.pull.value: expected 3 numbers, got 2"),
        ({"load.pul.value": np.ones((2, 3))}, "load.pull.value"),
    ],
)
def test_what_is_no_batch_is_refused_in_one_line(values, text):
    with pytest.raises(resilin.InputError) as error:
        resilin.value_and_gradient(bar(), TIP, [E], values=values, batch=True)
    assert text in str(error.value)
    assert "\n" not in str(error.value)


def test_two_batches_at_once_leave_the_number_of_threads_as_it_was():
    values = numbers(3)
    expected = resilin.value_and_gradient(motion(), TIP, [E], values=values, batch=True).value
    before, found = resilin.num_threads(), []

    def work():
        found.append(resilin.value_and_gradient(motion(), TIP, [E], values=values, batch=True).value)

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert resilin.num_threads() == before
    assert len(found) == 3
    for value in found:
        np.testing.assert_array_equal(value, expected)


def test_ctrl_c_ends_a_batch():
    def end(*_):
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(TimeoutError):
            long = motion(end_time=1000.0)
            resilin.value_and_gradient(long, TIP, [E], values={E: [1e5, 2e5]}, batch=True)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
