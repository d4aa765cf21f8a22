import json
import os
import re
import signal
import threading
import time

import numpy as np
import pytest
from scenes import cantilever, square

import resilin


def test_a_static_run_gives_the_reference_tip():
    """README's cantilever on its coarse mesh, by two finite-element codes that are not ours: -0.364847 m."""
    result = resilin.run(cantilever())
    assert result.status == "done"
    tip = result.report["frames"][-1]["probes"]["tip"]["displacement"]
    assert tip[2] == pytest.approx(-0.364847, abs=2e-6)  # the reference has six digits
    weight = 1000 * 1 * 0.2 * 0.2 * 9.81
    assert result.report["frames"][-1]["reactions"]["wall"][2] == pytest.approx(weight, rel=1e-6)


def test_results_are_arrays_of_all_frames():
    result = resilin.run(square(end_time=0.05))
    assert result.positions.shape == result.velocities.shape == (6, 25, 2)
    np.testing.assert_allclose(result.times, np.arange(6) * 0.01, rtol=1e-12)
    assert result.fields["displacement"].shape == (6, 25, 2)
    assert result.fields["von_mises"].shape == (6, 32)
    assert result.fields["cauchy_stress"].shape == (6, 32, 3, 3)
    np.testing.assert_allclose(result.fields["volume_ratio"][0], 1.4, rtol=1e-12)
    assert set(result.fields) >= {
        "displacement",
        "velocity",
        "cauchy_stress",
        "von_mises",
        "volume_ratio",
        "energy_density",
        "nodal_von_mises",
    }
    frames = result.report["frames"]
    assert [frame["step"] for frame in frames] == [0, 1, 2, 3, 4, 5]
    rest = resilin.Mesh.rectangle((1, 1), (4, 4), pattern="alternating").positions
    np.testing.assert_array_equal(result.positions[0], rest * [1.4, 1])
    np.testing.assert_allclose(result.fields["displacement"], result.positions - rest, atol=1e-15)


def test_stepping_by_hand_gives_the_same_bits_as_a_run():
    result = resilin.run(square())
    simulation = resilin.Simulation(square())
    while not simulation.is_finished:
        assert simulation.step()
    np.testing.assert_array_equal(simulation.positions, result.positions[-1])
    np.testing.assert_array_equal(simulation.velocities, result.velocities[-1])
    assert simulation.time == pytest.approx(0.2)
    assert simulation.frame == result.report["frames"][-1]
    np.testing.assert_array_equal(simulation.fields["von_mises"], result.fields["von_mises"][-1])


def test_files_and_dicts_mean_the_same(tmp_path):
    scene = tmp_path / "beam.toml"
    scene.write_text("""
        simulation = { kind = "static", gravity = [0, 0, -9.81] }
        fix = [{ name = "wall", where = { group = "x_min" } }]
        [[body]]
        element = "P1"
        mesh = { box = { size = [1, 0.2, 0.2], cells = [10, 2, 2] } }
        material = { law = "neo_hookean", youngs_modulus = 5e5, poissons_ratio = 0.3 }
    """)
    np.testing.assert_array_equal(resilin.run(scene).positions, resilin.run(cantilever()).positions)
    stiff = resilin.run(str(scene), overrides={"body.0.material.youngs_modulus": 5e7})
    assert np.abs(stiff.positions[-1] - stiff.positions[0]).max() < 0.01


def test_a_run_leaves_the_files_of_the_command_line(tmp_path):
    result = resilin.run(square(end_time=0.03), out=tmp_path / "out")
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["frames"] == result.report["frames"]
    assert report["status"] == "done"
    assert len(list((tmp_path / "out" / "frames").glob("*.vtu"))) == 4
    result.save(tmp_path / "saved")
    for name in ("checkpoint.bin", "frames.pvd", *(f"frames/000{i}.vtu" for i in range(4))):
        assert (tmp_path / "saved" / name).read_bytes() == (tmp_path / "out" / name).read_bytes()
    saved = json.loads((tmp_path / "saved" / "report.json").read_text())
    assert saved["frames"] == report["frames"]
    assert saved["timing"]["solve"] == report["timing"]["solve"] > 0


def test_a_run_that_was_stopped_is_resumed_to_the_same_bits(tmp_path):
    whole = resilin.run(square())
    stopped = resilin.run(square(), out=tmp_path, steps=7)
    assert stopped.status == "budget"
    resumed = resilin.run(square(), out=tmp_path, resume=True)
    np.testing.assert_array_equal(resumed.positions[-1], whole.positions[-1])


@pytest.mark.parametrize(
    ("override", "named"),
    [
        ("body.square.material.youngs_modulus=1e6", "body.square.material.youngs_modulus"),
        ("simulation.time_step=0.005", "simulation.time_step is 0.01, not 0.005"),
        ("simulation.gravity=[0, -1]", "simulation.gravity"),
    ],
)
def test_a_run_is_resumed_in_another_scene_only_when_that_is_meant(tmp_path, override, named):
    resilin.run(square(), out=tmp_path, steps=3)
    before = (tmp_path / "checkpoint.bin").read_bytes()
    with pytest.raises(resilin.InputError, match=re.escape(named)):
        resilin.run(square(), out=tmp_path, overrides=[override], resume=True)
    assert (tmp_path / "checkpoint.bin").read_bytes() == before
    result = resilin.run(square(), out=tmp_path, overrides=[override], resume="anyway")
    assert result.status == "done"
    assert result.times[0] == pytest.approx(0.03)
    with pytest.raises(resilin.InputError, match="resume: expected True, False or"):
        resilin.run(square(), out=tmp_path, resume="always")


def test_what_is_no_folder_is_refused():
    with pytest.raises(resilin.InputError, match="out: expected a path, got int"):
        resilin.run(square(), out=7)
    with pytest.raises(resilin.InputError, match="out: expected a folder .* overrides"):
        resilin.run(square(), {"simulation.gravity": [0, 0]})


def test_a_folder_that_another_simulation_writes_into_is_refused(tmp_path):
    fcntl = pytest.importorskip("fcntl")
    with (tmp_path / "run.lock").open("w") as lock:
        lock.write("process 12345 on here since 2025-01-01 00:00:00")
        lock.flush()
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(resilin.InputError, match="process 12345 on here"):
            resilin.run(square(), out=tmp_path)
    assert resilin.run(square(), out=tmp_path).status == "done"


def test_damaged_files_are_refused_when_a_run_is_resumed(tmp_path):
    resilin.run(square(), out=tmp_path, steps=3)
    for name in ("report.json", "checkpoint.bin"):
        kept = (tmp_path / name).read_bytes()
        for damaged in (b"", kept[: len(kept) // 2], b"[" * 100000, b'{"frames": [1]}'):
            (tmp_path / name).write_bytes(damaged)
            with pytest.raises(resilin.InputError, match=re.escape(name)):
                resilin.run(square(), out=tmp_path, resume=True)
        (tmp_path / name).write_bytes(kept)


@pytest.mark.parametrize("key", ["a." * 40000 + "a=1", "simulation." + "x." * 100 + "x=1", "title=" + "[" * 40000])
def test_overrides_that_are_nested_too_deep_are_refused(key):
    with pytest.raises(resilin.InputError):
        resilin.Simulation(square(), overrides=[key])


def test_a_scene_file_that_is_nested_too_deep_is_refused(tmp_path):
    for text in ("a." * 40000 + "a = 1", "[" + "a." * 40000 + "a]", "a = " + "[" * 40000, "a = " + "{a=" * 40000):
        (tmp_path / "deep.toml").write_text(text)
        with pytest.raises(resilin.InputError, match="at most 64 levels"):
            resilin.Simulation(tmp_path / "deep.toml")


def test_fewer_frames_are_recorded_when_asked():
    scene = square() | {"output": {"every": 8}}
    assert [frame["step"] for frame in resilin.run(scene).report["frames"]] == [0, 8, 16, 20]


def test_a_scene_holds_arrays_for_each_cell_and_vertex():
    mesh = resilin.Mesh.rectangle((1, 1), (6, 6))
    young = np.linspace(1e5, 3e5, len(mesh.cells))
    scene = square(end_time=0.02)
    scene["body"][0] |= {"mesh": mesh, "initial_positions": mesh.positions * 1.1, "initial_velocities": -mesh.positions}
    scene["body"][0]["material"]["youngs_modulus"] = young
    simulation = resilin.Simulation(scene)
    np.testing.assert_array_equal(simulation.velocities, -mesh.positions)
    law = resilin.Material("neo_hookean", youngs_modulus=young, poissons_ratio=0.4)
    body = resilin.Elastic(mesh, law)
    energy = simulation.frame["energy"]["elastic"]
    assert energy == pytest.approx(body.value(simulation.positions), rel=1e-12)
    scene["body"][0]["mesh"] = {"positions": mesh.positions, "cells": mesh.cells, "groups": mesh.groups}
    scene["body"][0]["material"] = {"law": law, "density": 1000}
    assert resilin.Simulation(scene).frame["energy"]["elastic"] == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bod": []}, 'scene: bod: unknown key "bod"; did you mean "body"?'),
        ({"body": []}, "scene: there is no [[body]]"),
        ({"title": None}, "scene: title: expected a number, a text, a list, a dict, an array or a mesh, got NoneType"),
        ({"title": 2**63}, "scene: title: expected a whole number of 64 bits"),
        ({"newton": {"tolerance": -1}}, "scene: newton.tolerance: expected a number"),
        ({"newton": {1: 2}}, "scene: newton: expected keys that are texts, got 1"),
        ({1: 2}, "scene: keys: expected keys that are texts, got 1"),
        ({"fix": [{"where": {"group": "x_mn"}}]}, 'did you mean "x_min"?'),
        ({"newton": {"tolerance": np.ones((2, 2, 2))}}, "expected an array of real numbers with one or two axes"),
        ({"newton": {"tolerance": np.ones(100)}}, "expected a number > 0, got an array of 100 x 1"),
    ],
)
def test_wrong_scenes_are_refused_in_one_line(change, message):
    with pytest.raises(resilin.InputError) as caught:
        resilin.run(cantilever() | change)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_scene_that_contains_itself_is_refused():
    scene = cantilever()
    scene["body"].append(scene)
    with pytest.raises(resilin.InputError, match="does it contain itself"):
        resilin.run(scene)


@pytest.mark.parametrize(("rows", "message"), [(24, "got 24 rows of 2"), (26, "got 26 rows of 2")])
def test_initial_positions_of_another_size_are_refused(rows, message):
    scene = square()
    scene["body"][0]["initial_positions"] = np.ones((rows, 2))
    with pytest.raises(resilin.InputError, match=message):
        resilin.Simulation(scene)


def test_a_missing_scene_is_an_input_error(tmp_path):
    with pytest.raises(resilin.InputError, match="no-such.toml"):
        resilin.run(tmp_path / "no-such.toml")
    with pytest.raises(resilin.InputError, match="scene: expected a path or a dict, got int"):
        resilin.run(3)
    with pytest.raises(ValueError, match="steps: expected a whole number"):
        resilin.run(square(), steps=0)


def test_not_converging_is_a_result():
    result = resilin.run(cantilever() | {"newton": {"max_iterations": 1}})
    assert result.status == "not_converged"
    assert "no equilibrium was found" in result.report["reason"]
    step = resilin.Simulation(square() | {"newton": {"max_iterations": 1}}).step()
    assert not step
    assert step.status == "not_converged"
    assert step.reason


def test_another_material_changes_the_rest_of_the_motion():
    simulation = resilin.Simulation(cantilever())
    assert simulation.step()
    soft = simulation.frame["probes"]["tip"]["displacement"][2]
    law = resilin.Material("neo_hookean", youngs_modulus=np.full(240, 5e7), poissons_ratio=0.3)
    simulation.set_material("beam", law)
    assert simulation.step()
    stiff = simulation.frame["probes"]["tip"]["displacement"][2]
    expected = resilin.run(cantilever(), overrides={"body.beam.material.youngs_modulus": 5e7})
    assert stiff == pytest.approx(expected.report["frames"][-1]["probes"]["tip"]["displacement"][2], rel=1e-6)
    assert abs(stiff) < 0.1 * abs(soft)
    with pytest.raises(resilin.InputError, match='expected one of beam, got "bar"'):
        simulation.set_material("bar", law)


def test_bodies_know_their_vertices_and_cells():
    scene = square()
    scene["body"].append({**scene["body"][0], "name": "other", "translate": [3, 0]})
    scene["body"][1].pop("initial_positions")
    simulation = resilin.Simulation(scene)
    rows = simulation.vertices("other")
    assert (rows.start, rows.stop) == (25, 50)
    assert simulation.positions[rows, 0].min() == pytest.approx(3)
    assert simulation.cells("other").min() == 25
    assert [body["name"] for body in simulation.bodies] == ["square", "other"]


def long_scene():
    return square(end_time=1e6)


def interrupt_when_there_is(path):
    """From another thread, as Ctrl-C comes; a busy machine may take its time until then."""

    def interrupt():
        while not path.exists():
            time.sleep(0.001)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt, daemon=True)
    thread.start()
    return thread


def test_ctrl_c_stops_a_run_and_keeps_the_state(tmp_path):
    simulation = resilin.Simulation(long_scene())
    thread = interrupt_when_there_is(tmp_path / "frames" / "0005.vtu")
    with pytest.raises(KeyboardInterrupt):
        simulation.run(out=tmp_path)
    thread.join()
    assert 0 < simulation.time < 1e6
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["status"] == "budget"
    assert report["frames"][-1] == simulation.frame
    assert simulation.step()


def test_an_exception_of_a_signal_handler_passes_through(tmp_path):
    def leave(*_):
        raise OSError("enough")

    previous = signal.signal(signal.SIGINT, leave)
    try:
        thread = interrupt_when_there_is(tmp_path / "frames" / "0005.vtu")
        with pytest.raises(OSError, match="enough"):
            resilin.run(long_scene(), out=tmp_path)
        thread.join()
    finally:
        signal.signal(signal.SIGINT, previous)


def test_other_threads_go_on_during_a_run():
    counted = 0
    is_over = threading.Event()

    def count():
        nonlocal counted
        while not is_over.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    resilin.run(long_scene(), steps=5000)
    during = counted - before
    is_over.set()
    thread.join()
    assert during > 2


def test_progress_is_one_line_when_asked_and_none_otherwise(capsys):
    resilin.run(square(end_time=0.02))
    assert capsys.readouterr().out == ""
    resilin.run(square(end_time=0.02), progress=True)
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1].startswith("100 %  step 2/2, t = 0.02 s")


def test_progress_tells_of_a_step_that_lasts(capsys, monkeypatch):
    for name in ("LONG_STEP", "BETWEEN_LINES_OF_A_STEP"):
        monkeypatch.setattr(f"resilin.progress.{name}", 0)
    resilin.run(square(end_time=0.02), progress=True)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("  0 %  step 1, from t = 0 s, Newton iteration 1, residual ")
    assert lines[-1].startswith("100 %  step 2/2, t = 0.02 s")


def test_oddities_are_python_warnings():
    scene = square()
    scene["body"][0] |= {"mesh": {"positions": [[0, 0], [1, 0], [0, 1]], "cells": [[0, 2, 1]]}}
    del scene["body"][0]["initial_positions"]
    with pytest.warns(UserWarning, match="inverted"):
        resilin.Simulation(scene)


def test_results_do_not_depend_on_the_number_of_threads():
    """The dense parts of the direct solver included, which OpenBLAS would share between threads of its own."""
    before = resilin.num_threads()
    scene = cantilever() | {"solver": {"kind": "multifrontal"}}
    scene["body"][0]["mesh"]["box"]["cells"] = [20, 6, 6]
    results = []
    try:
        for count in (1, 2, 5):
            resilin.set_num_threads(count)
            results.append(resilin.run(scene).positions.tobytes())
    finally:
        resilin.set_num_threads(before)
    assert results[0] == results[1] == results[2]
