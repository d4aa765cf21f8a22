"""Scenes that are pulled, pinned and poked by a program."""

import pickle
import threading

import numpy as np
import pytest
from scenes import cantilever, square

import resilin


def block(**simulation):
    """A block that hangs on a wall without weight."""
    scene = cantilever(gravity=[0, 0, 0], **simulation)
    scene["body"][0]["material"]["density"] = 1000
    return scene


def settled(scene, most=3000):
    for _ in range(most):
        if scene.step().at_rest:
            return scene
    raise AssertionError(scene.step().words)


def test_what_is_let_alone_comes_to_the_equilibrium_of_a_run():
    run = resilin.run(cantilever(), overrides={"newton.tolerance": 1e-10}, progress=False)
    live = resilin.LiveScene(cantilever())
    live.set(damping=5)
    settled(live)
    sag = np.abs(run.positions[-1] - run.positions[0]).max()
    np.testing.assert_allclose(live.positions, run.positions[-1], rtol=0, atol=1e-6 * sag)
    np.testing.assert_allclose(live.fields["von_mises"], run.fields["von_mises"][-1], rtol=1e-5)
    assert live.time > 0
    live.reset()
    np.testing.assert_array_equal(live.positions, live.rest_positions)


def test_a_hand_pulls_a_place_towards_another_with_the_force_that_the_wall_answers():
    live = resilin.LiveScene(block())
    live.set(damping=5)
    tip = live.grab([1, 0.1, 0.1])
    np.testing.assert_allclose(live.rest_positions[tip], [1, 0.1, 0.1], atol=1e-12)
    assert live.is_held
    np.testing.assert_allclose(live.hand_force, 0, atol=1e-9)  # taking hold moves nothing
    live.drag([1, 0.1, 0.3])
    settled(live)
    rise = live.positions[tip, 2] - 0.1
    assert 0.1 < rise < 0.21
    # Forces of the deformed cells at the free vertices, by the energy of the mesh alone.
    mesh = resilin.Mesh.box((1, 0.2, 0.2), (10, 2, 2))
    np.testing.assert_array_equal(mesh.positions, live.rest_positions)
    law = resilin.Material("neo_hookean", youngs_modulus=5e5, poissons_ratio=0.3)
    free = mesh.positions[:, 0] > 0
    pull = resilin.Elastic(mesh, law).gradient(live.positions)[free].sum(axis=0)
    assert live.hand_force[2] > 10
    np.testing.assert_allclose(live.hand_force, pull, rtol=0, atol=1e-4 * np.linalg.norm(pull))
    live.release()
    assert not live.is_held
    np.testing.assert_array_equal(live.hand_force, 0)
    settled(live)
    np.testing.assert_allclose(live.positions, live.rest_positions, atol=1e-6)
    with pytest.raises(resilin.InputError, match="drag: expected something that is held, got nothing; call grab first"):
        live.drag([1, 0, 0])


def test_places_are_those_of_the_scene_wherever_it_stands():
    """Far from the origin, too, and held vertices are where the hand wants them to a fraction of the body."""
    scene = block()
    scene["body"][0]["translate"] = [1e4, -2e4, 5e3]
    del scene["probe"]
    live = resilin.LiveScene(scene)
    start = live.positions
    tip = live.grab(start.max(axis=0))
    np.testing.assert_allclose(start[tip], start.max(axis=0))
    live.drag(start[tip] + [0, 0, 0.1])
    for _ in range(100):
        live.step()
    assert np.linalg.norm(live.positions[tip] - start[tip] - [0, 0, 0.1]) < 0.05
    live.poke(start[tip] + [0, 0, 1], 0.1)
    assert live.ball.shape == (3,)
    assert np.linalg.norm(live.ball - start[tip]) < 2


def test_pins_hold_and_let_go():
    scene = square(gravity=[0, -9.81])
    live = resilin.LiveScene(scene)
    corner = int(np.argmax(live.positions @ [1, 1]))
    live.pin(corner)
    live.pin([0, 1])
    assert sorted(live.pinned) == sorted({corner, 0, 1})
    before = live.positions
    for _ in range(20):
        live.step()
    np.testing.assert_array_equal(live.positions[[corner, 0, 1]], before[[corner, 0, 1]])
    assert np.abs(live.positions - before).max() > 0.01
    live.unpin(corner)
    assert sorted(live.pinned) == [0, 1]
    live.unpin()
    assert live.pinned == []
    for _ in range(20):
        live.step()
    assert live.positions[corner, 1] < before[corner, 1] - 0.1  # it falls
    with pytest.raises(resilin.InputError, match="pin: expected vertices from 0 to"):
        live.pin(len(before))
    with pytest.raises(resilin.InputError, match="numbers of vertices"):
        live.pin([0.5])


def test_a_ball_pushes_what_is_in_its_way():
    live = resilin.LiveScene(block())
    tip = int(np.argmin(np.linalg.norm(live.positions - [1, 0.1, 0.2], axis=1)))
    live.poke([1, 0.1, 0.5], 0.1)
    for height in np.linspace(0.5, 0.2, 40):
        live.poke([1, 0.1, height], 0.1)
        live.step()
    for _ in range(60):
        live.step()
    assert live.positions[tip, 2] < 0.15
    outside = np.linalg.norm(live.positions - live.ball, axis=1)
    assert outside.min() > 0.1 - 1e-3
    live.stop_poking()
    assert live.ball is None


def test_controls_have_names_and_are_taken_whole_or_not_at_all():
    live = resilin.LiveScene(block())
    live.set(youngs_modulus=2e5, gravity=[0, 0, -1.6], law="stable_neo_hookean")
    controls = live.controls
    assert controls["youngs_modulus"] == 2e5
    assert controls["gravity"] == [0, 0, -1.6]
    for wrong, message in {
        "poissons_ratio": "poissons_ratio",
        "youngs_moduls": "did you mean",
        "gravity": "three numbers",
        "law": "a text",
    }.items():
        with pytest.raises(resilin.InputError, match=message):
            live.set(youngs_modulus=9e5, **{wrong: 7})
        assert live.controls == controls
    with pytest.raises(resilin.InputError, match="grab: expected 3 numbers, got 2"):
        live.grab([1, 2])
    with pytest.raises(resilin.InputError, match="grab"):
        live.grab([np.nan, 0, 0])
    for wrong in ("abc", None, [[1, 2, 3]], [1j, 0, 0], [np.inf, 0, 0], 7):
        for take in (live.grab, lambda place: live.poke(place, 0.1)):
            with pytest.raises(resilin.InputError, match=r"^(grab|poke): expected [^\n]*$"):
                take(wrong)
    for wrong in (2**40, -1, "abc", [True]):
        with pytest.raises(resilin.InputError, match="^pin: expected"):
            live.pin(wrong)
    live.pin([])
    assert live.pinned == []
    for wrong in ("x", None, [1, 2], 1j):
        with pytest.raises(resilin.InputError, match="controls: gravity: expected"):
            live.set(gravity=wrong)
    with pytest.raises(resilin.InputError, match="seconds"):
        live.step(float("nan"))


def test_steps_without_haste_have_the_same_bits():
    def played():
        live = resilin.LiveScene(block())
        live.grab([1, 0.1, 0.1])
        for i in range(20):
            live.drag([1, 0.1, 0.1 + 0.02 * i])
            live.step()
        return live.positions

    np.testing.assert_array_equal(played(), played())


def test_threads_take_turns():
    live = resilin.LiveScene(block())
    live.grab([1, 0.1, 0.1])
    faults = []

    def play(height):
        try:
            for _ in range(20):
                live.drag([1, 0.1, height])
                live.step()
                assert np.isfinite(live.positions).all()
        except Exception as error:  # told in the main thread
            faults.append(error)

    threads = [threading.Thread(target=play, args=(height,)) for height in (0, 0.1, 0.3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []
    assert live.time == pytest.approx(60 * live.controls["time_step"])


def test_it_is_drawn_and_not_pickled():
    live = resilin.LiveScene(block())
    assert live.bodies == ["beam"]
    assert live.cells("beam").shape[1] == 4
    assert live.plot(size=(96, 72)).pixels.shape == (72, 96, 3)
    assert "t = 0 s" in repr(live)
    # Up is where it is in pictures of a run, though gravity is a control here.
    scene = cantilever(gravity=[0, -9.81, 0])
    scene["simulation"]["kind"] = "dynamic"
    scene["simulation"] |= {"time_step": 0.01, "end_time": 0.01}
    live = resilin.LiveScene(scene)
    start = resilin.Simulation(scene).plot(None, size=(96, 72)).pixels
    np.testing.assert_array_equal(live.plot(None, size=(96, 72)).pixels, start)
    with pytest.raises(TypeError, match="LiveScene cannot be pickled"):
        pickle.dumps(live)
