"""Rest shapes whose loads deform them into what was drawn."""

import pathlib

import numpy as np
import pytest

import resilin

ROOT = pathlib.Path(__file__).resolve().parents[2]


def body(name, mesh, modulus, element, **more):
    material = {"law": "neo_hookean", "youngs_modulus": modulus, "poissons_ratio": 0.35, "density": 1000}
    return {"name": name, "mesh": mesh, "element": element, "material": material, **more}


def beam(mesh=None, modulus=5e5, element="P1", gravity=9.81):
    return {
        "simulation": {"kind": "static", "gravity": [0, 0, -gravity]},
        "body": [body("beam", mesh or resilin.Mesh.box(size=(0.8, 0.2, 0.1), cells=(8, 2, 2)), modulus, element)],
        "fix": [{"name": "wall", "where": {"group": "x_min"}}],
    }


def cook(mesh=None, element="P1"):
    """Cook's membrane [m], held at the left, under its weight and a shear load at its right."""
    if mesh is None:
        square = resilin.Mesh.rectangle(size=(1, 1), cells=(12, 12))
        s, t = square.positions.T
        places = np.stack([48e-3 * s, (44 * s + t * (44 - 28 * s)) * 1e-3], axis=1)
        mesh = resilin.Mesh(places, square.cells, square.groups)
    return {
        "simulation": {"kind": "static", "dimension": 2, "gravity": [0, -9.81]},
        "body": [body("membrane", mesh, 8e3, element)],
        "fix": [{"name": "wall", "where": {"group": "x_min"}}],
        "load": [{"name": "shear", "kind": "traction", "value": [0, 60], "where": {"group": "x_max"}}],
    }


def spot(mesh=None):
    mesh = mesh or resilin.read_mesh(ROOT / "data" / "spot_coarse.msh")
    if np.ptp(mesh.positions[:, 1]) > 1.2:  # as it is in the file
        mesh = resilin.Mesh(0.582 * mesh.positions + [0, 0.429, 0], mesh.cells)
    feet = np.flatnonzero(np.abs(mesh.positions[:, 1]) < 0.03)
    return {
        "simulation": {"kind": "static", "gravity": [0, -9.81, 0]},
        "body": [body("spot", mesh, 2e5, "P1")],
        "fix": [{"name": "feet", "where": {"vertices": feet}}],
    }


def check(scene_of, **options):
    """A run of its own from the shape found, to 1e-8 of the size."""
    scene = scene_of(**options)
    drawn = scene["body"][0]["mesh"]
    found = resilin.find_rest_shape(scene)
    (rest,) = found.positions.values()
    again = scene_of(mesh=resilin.Mesh(rest, drawn.cells, drawn.groups), **options)
    if "feet" in str(scene["fix"]):
        again["fix"] = scene["fix"]  # the same vertices
    again["newton"] = {"tolerance": 1e-11}
    result = resilin.run(again)
    assert result.status == "done"
    size = np.ptp(drawn.positions, axis=0).max()
    off = np.linalg.norm(result.positions[-1][: len(drawn.positions)] - drawn.positions, axis=1).max()
    moved = np.linalg.norm(rest - drawn.positions, axis=1).max()
    print(f"{found.iterations} iterations, moved by {moved / size:.3g} of the size, off by {off / size:.2g}")
    assert off < 1e-8 * size
    assert found.distance < 1e-8 * size
    assert moved > 0.02 * size  # it was worth the search
    return found


@pytest.mark.parametrize("element", ["P1", "P2", "P2P0"])
def test_cooks_membrane_meets_its_target(element):
    check(cook, element=element)


@pytest.mark.parametrize(("element", "modulus"), [("P1", 5e5), ("P2", 1.5e6), ("P2", 1e6)])
def test_a_hanging_beam_is_straight(element, modulus):
    check(beam, element=element, modulus=modulus)


def test_spot_stands_as_she_was_drawn():
    check(spot)


def test_a_moved_and_scaled_body_with_a_moving_support_under_pressure_is_found_where_it_stands():
    scene = beam(modulus=2e5, gravity=2)
    scene["body"][0] |= {"scale": 2, "rotate": {"axis": [0, 0, 1], "degrees": 90}, "translate": [0, 3, 0]}
    scene["fix"][0] |= {"displacement": [0.02, 0, 0.01], "gradient": [[0.1, 0, 0], [0, 0, 0.2], [0, 0, 0]]}
    scene["load"] = [{"name": "air", "kind": "pressure", "value": 300, "where": {"group": "z_max"}}]
    found = resilin.find_rest_shape(scene)
    assert found.distance < 1e-8 * found.size
    target = resilin.value_and_gradient(
        {**scene, "load": [], "simulation": {"kind": "static"}}, {}, ["body.beam.rest_positions"]
    ).parameters["body.beam.rest_positions"]
    np.testing.assert_allclose(found.deformed["beam"], target, rtol=0, atol=1e-8 * found.size)
    assert np.abs(found.positions["beam"] - target).max() > 0.01


def test_two_bodies_are_found_together():
    scene = beam()
    other = {**scene["body"][0], "name": "other", "translate": [0, 1, 0]}
    scene["body"].append(other)
    scene["fix"][0]["body"] = "beam"
    scene["fix"].append({"name": "other wall", "body": "other", "where": {"group": "x_min"}})
    scene["contact"] = {"enabled": False}
    found = resilin.find_rest_shape(scene)
    alone = resilin.find_rest_shape(beam()).positions["beam"]
    for name, shift in (("beam", 0), ("other", 1)):
        np.testing.assert_allclose(found.positions[name], alone + [0, shift, 0], rtol=0, atol=1e-9)


def floor(height, **more):
    return {"collider": [{"name": "floor", "kind": "half_space", "point": [0, 0, height], "normal": [0, 0, 1], **more}]}


def test_a_floor_that_nothing_touches_changes_nothing():
    free, above = resilin.find_rest_shape(beam()), resilin.find_rest_shape(beam() | floor(-1))
    np.testing.assert_allclose(above.positions["beam"], free.positions["beam"], rtol=0, atol=1e-9)


def end_of(scene, rest, **more):
    drawn = scene["body"][0]["mesh"]
    body = {**scene["body"][0], "mesh": resilin.Mesh(rest, drawn.cells, drawn.groups), **more.pop("body", {})}
    result = resilin.run({**scene, "body": [body], "newton": {"tolerance": 1e-11}}, progress=False, **more)
    assert result.status == "done"
    return result.positions[-1][: len(drawn.positions)]


@pytest.mark.parametrize("gap", [1e-4, 3e-3])
def test_a_beam_drawn_just_above_a_floor_is_not_pressed_by_it(gap):
    scene = beam() | floor(-gap)
    with pytest.warns(UserWarning, match="times the weight"):
        found = resilin.find_rest_shape(scene)
    assert list(found.overrides) == ['collider."floor".activation_distance']
    np.testing.assert_allclose(found.positions["beam"], resilin.find_rest_shape(beam()).positions["beam"], atol=1e-8)
    end = end_of(scene, found.positions["beam"], overrides=found.overrides)
    np.testing.assert_allclose(end, scene["body"][0]["mesh"].positions, rtol=0, atol=1e-8)


def block(**fix):
    mesh = resilin.Mesh.rectangle(size=(0.2, 0.1), cells=(4, 2))
    return {
        "simulation": {"kind": "static", "dimension": 2, "gravity": [0, -9.81]},
        "body": [body("block", mesh, 5e4, "P2")],
        "fix": [{"name": "held", **fix}],
        "collider": [
            {"name": "floor", "kind": "half_space", "point": [0, -6e-4], "normal": [0, 1], "activation_distance": 1e-3}
        ],
    }


def test_a_block_held_pressed_on_a_floor_reaches_through_it_at_rest():
    scene = block(where={"group": "y_max"})
    drawn = scene["body"][0]["mesh"].positions
    with pytest.warns(UserWarning, match='inside of the collider "floor"'):
        found = resilin.find_rest_shape(scene)
    assert found.positions["block"][:, 1].min() < -6e-4
    end = end_of(scene, found.positions["block"], body={"initial_positions": drawn})
    np.testing.assert_allclose(end, drawn, rtol=0, atol=1e-8)


def test_a_block_that_stands_on_a_floor_is_as_drawn_where_the_floor_bears_it():
    scene = block(where={"group": "x_min"}, components="x")
    drawn = scene["body"][0]["mesh"].positions
    with pytest.warns(UserWarning, match="from the drawn position"):
        found = resilin.find_rest_shape(scene)
    moved = found.deformed["block"] - drawn
    assert 1e-5 < np.abs(moved).max() < 1e-3
    np.testing.assert_allclose(moved, np.broadcast_to([0, moved[0, 1]], moved.shape), rtol=0, atol=1e-9)
    np.testing.assert_allclose(end_of(scene, found.positions["block"]), drawn + moved, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"simulation": {"kind": "dynamic", "gravity": [0, 0, -9.81], "time_step": 0.01, "end_time": 0.1}}, "static"),
        (floor(-1, friction=0.3), "contact without friction"),
    ],
)
def test_what_cannot_be_sought_is_refused_in_one_line(change, text):
    with pytest.raises(resilin.InputError, match=text) as error:
        resilin.find_rest_shape(beam() | change)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("gravity", "modulus", "element"),
    [
        ([0, 0, -9.81], 5e5, "P2"),  # straight it would balance, but roll over and hang down
        ([-9.81, 0, 0], 3e4, "P2"),  # a column that buckles
    ],
)
def test_where_there_is_no_such_shape_it_is_refused_in_one_line(gravity, modulus, element):
    scene = beam(modulus=modulus, element=element)
    scene["simulation"]["gravity"] = gravity
    with pytest.raises(resilin.InputError, match="stress-free shape: expected") as error:
        resilin.find_rest_shape(scene)
    assert "\n" not in str(error.value)
    print(error.value)


def test_a_search_that_lasts_is_shown(capsys, monkeypatch):
    monkeypatch.setattr("resilin.progress.LONG_STEP", 0)
    with pytest.raises(resilin.InputError):
        resilin.find_rest_shape(beam(modulus=2e4), progress=True)
    assert "%  a shape for 0 % of the loads, towards 100 %, iteration" in capsys.readouterr().out
    resilin.find_rest_shape(beam(), progress=False)
    assert not capsys.readouterr().out
