"""Gradients of whole runs, against differences of runs."""

import numpy as np
import pytest
from gradient_scenes import E, bar, motion
from numpy.testing import assert_allclose

import resilin

OBJECTIVE = {
    "position": {"at": [[0.9, 0.1, 0.1], [0.5, 0.2, 0.2]], "target": np.ones((2, 3)), "sigma": 0.5},
    "displacement": {"at": [1, 0, 0], "component": "z", "weight": 3},
    "probe": {"name": "tip", "target": [0, 0, -1]},
    "reaction": {"of": "wall", "target": [0, 0, 100], "sigma": 50},
    "volume": {"body": "bar", "target": 0.06, "sigma": 0.01},
    "energy": {"kind": "elastic", "target": 1, "sigma": 3},
    "stress": [
        {"at": [[0.1, 0.1, 0.1], [0.3, 0.1, 0.2]], "component": "von_mises", "target": [1e4, 1e4], "sigma": 1e4},
        {"at": [0.1, 0.1, 0.1], "component": "zx", "weight": 1e-5},
    ],
    "section": {"name": "middle", "target": [0, 0, 400], "sigma": 100},
    "moment": {"name": "middle", "target": [0, 100, 0], "sigma": 100},
}
WRT = [
    E,
    "body.bar.density",
    "load.pull.value",
    "fix.wall.displacement",
    "simulation.gravity",
    "body.bar.rest_positions",
]


@pytest.mark.parametrize("scene", [bar, motion])
def test_value_and_gradient_agree_with_differences(scene):
    run = resilin.value_and_gradient(scene(), OBJECTIVE, WRT)
    value, gradients = run
    assert value == run.value
    assert set(gradients) == set(WRT)
    assert isinstance(gradients[E], float)
    assert gradients["load.pull.value"].shape == (3,)
    assert gradients["body.bar.rest_positions"].shape == run.positions[0].shape

    h = 1e-3
    sides = [resilin.value_and_gradient(scene(modulus=1e5 * (1 + t)), OBJECTIVE, [E]).value for t in (-h, h)]
    assert_allclose(gradients[E], (sides[1] - sides[0]) / (2 * h * 1e5), rtol=1e-5)

    direction = {"load.pull.value": [1.0, 2.0, 3.0], E: 1e3}
    change = run.jvp(direction)
    slope = gradients["load.pull.value"] @ [1, 2, 3] + gradients[E] * 1e3
    assert_allclose(change["value"], slope, rtol=1e-9)
    product = run.gauss_newton_product(direction)
    assert_allclose(
        product["load.pull.value"] @ [1, 2, 3] + product[E] * 1e3, change["residuals"] @ change["residuals"]
    )


def test_kinetic_energy_is_an_objective_of_motion():
    wrt = ["body.bar.density", "body.bar.initial_velocities", "body.bar.rest_positions"]
    objective = {"energy": [{"kind": "kinetic", "body": "bar"}, {"kind": "kinetic", "frame": 2, "weight": 2}]}
    run = resilin.value_and_gradient(motion(), objective, wrt)
    report = resilin.run(motion()).report["frames"]
    assert_allclose(run.value, report[-1]["energy"]["kinetic"] + 2 * report[2]["energy"]["kinetic"], rtol=1e-9)

    def value(density):
        scene = motion()
        scene["body"][0]["material"]["density"] = density
        return resilin.value_and_gradient(scene, objective, wrt).value

    assert_allclose(run.gradients["body.bar.density"], (value(1000.1) - value(999.9)) / 0.2, rtol=1e-6)
    speeds = np.random.default_rng(1).standard_normal(run.gradients["body.bar.initial_velocities"].shape)
    change = run.jvp({"body.bar.initial_velocities": speeds})["value"]
    assert_allclose(change, np.sum(run.gradients["body.bar.initial_velocities"] * speeds), rtol=1e-9)


def test_velocities_are_there_for_functions():
    def energy(outcome):
        slopes = np.zeros_like(outcome.velocities)
        slopes[-1] = outcome.velocities[-1]
        return 0.5 * np.sum(outcome.velocities[-1] ** 2), {"velocities": slopes}

    run = resilin.value_and_gradient(motion(), energy, ["simulation.gravity"])
    assert_allclose(run.outcome.velocities, resilin.run(motion()).velocities, atol=1e-9)
    scene = motion()
    values = []
    for g in (-9.82, -9.80):
        scene["simulation"]["gravity"] = [0, 0, g]
        values.append(resilin.value_and_gradient(scene, energy, []).value)
    assert_allclose(run.gradients["simulation.gravity"][2], (values[1] - values[0]) / 0.02, rtol=1e-5)


def test_a_function_is_an_objective():
    def height(outcome):
        assert outcome.positions.shape == (2, 20, 3)
        assert_allclose(outcome.loads, [0, 1])
        slopes = np.zeros_like(outcome.positions)
        slopes[-1, :, 2] = 1
        return outcome.positions[-1, :, 2].sum() + outcome.reactions["wall"][-1, 2], {
            "positions": slopes,
            "reactions": {"wall": [0, 0, 1]},
        }

    value, gradients = resilin.value_and_gradient(bar(), height, ["simulation.gravity"])
    # The wall carries the weight, whatever the shape.
    without = resilin.gradient(
        bar(), lambda o: (0, {"positions": (o.positions[-1] * 0 + [0, 0, 1])}), ["simulation.gravity"]
    )
    assert_allclose(gradients["simulation.gravity"][2] - without["simulation.gravity"][2], -62.5, rtol=1e-9)


def test_names_may_be_one_or_repeated_and_frames_any():
    first = {"probe": {"name": "tip", "component": "z", "frame": 1}}
    gradients = [resilin.gradient(bar(load_steps=3), first, wrt) for wrt in (E, [E, E], [E, "simulation.gravity"])]
    assert len({gradient[E] for gradient in gradients}) == 1
    full = resilin.gradient(bar(load_steps=3), {"probe": {"name": "tip", "component": "z"}}, [E])
    assert full[E] > 1.5 * gradients[0][E]


def test_checkpoints_change_no_bit():
    whole = resilin.gradient(motion(), OBJECTIVE, WRT)
    parts = resilin.gradient(motion(), OBJECTIVE, WRT, checkpoints=2)
    for name in WRT:
        np.testing.assert_array_equal(whole[name], parts[name])


def test_fields_of_cells_have_gradients_of_cells():
    moduli = np.linspace(1e5, 2e5, 24)
    gradient = resilin.gradient(bar(modulus=moduli), OBJECTIVE, [E])[E]
    assert gradient.shape == (24,)
    uniform = resilin.gradient(bar(modulus=np.full(24, 1e5)), OBJECTIVE, [E])[E]
    assert_allclose(uniform.sum(), resilin.gradient(bar(), OBJECTIVE, [E])[E], rtol=1e-9)


@pytest.mark.parametrize(
    ("objective", "wrt", "text"),
    [
        (OBJECTIVE, ["body.bar.material.young_modulus"], "youngs_modulus"),
        ({"place": {}}, [E], "objective.place: expected one of"),
        ({"position": {"at": [2, 0, 0], "target": [0, 0, 0]}}, [E], "1 m outside"),
        ({"position": {"at": [1, 0, 0], "target": [0, 0]}}, [E], "expected 3 numbers"),
        ({"probe": {"name": "top", "component": "z"}}, [E], "tip"),
        ({"probe": {"name": "tip", "axis": "z"}}, [E], "unknown key"),
        ({"reaction": {"of": "floor", "component": "z"}}, [E], "wall"),
        ({"energy": {"kind": "kinetic"}}, [E], "a dynamic scene"),
        ({"energy": {"kind": "elastic", "body": "rod"}}, [E], "bar"),
        ({"stress": {"at": [2, 0, 0], "component": "xx"}}, [E], "1 m outside"),
        ({"stress": {"at": [0.5, 0.1, 0.1], "component": "mises"}}, [E], "von_mises"),
        ({"section": {"name": "end", "component": "x"}}, [E], "middle"),
        ({"section": {"name": "middle"}}, [E], "a component"),
        (3, [E], "a dict of terms or a function"),
    ],
)
def test_bad_input_is_refused_in_one_line(objective, wrt, text):
    with pytest.raises(resilin.InputError, match=text) as error:
        resilin.value_and_gradient(bar(), objective, wrt)
    assert "\n" not in str(error.value)


def test_bodies_that_are_equally_stiff_are_warned_about():
    scene = bar()
    other = {**scene["body"][0], "name": "other", "translate": [0, 0, 0.3]}
    scene["body"].append(other)
    for part in ("fix", "load", "probe", "section"):
        scene[part][0]["body"] = "bar"
    scene["fix"].append({**scene["fix"][0], "name": "wall of the other", "body": "other"})
    with pytest.warns(UserWarning, match=r"equally stiff.*contact.stiffness = 1e\+?05"):
        resilin.gradient(scene, {"displacement": {"at": [0.9, 0.1, 0.1], "body": "bar", "component": "z"}}, [E])
