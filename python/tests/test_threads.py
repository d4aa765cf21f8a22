"""One simulation in several threads: whoever comes waits for a turn, and sees whole states."""

import os
import signal
import socket
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import cantilever, square

import resilin

NUM_STEPS = 20  # number of steps of `square`


@pytest.fixture(scope="module")
def alone():
    """The same motion in one thread."""
    return resilin.run(square())


@pytest.mark.parametrize("num_threads", [2, 3, 8])
def test_steps_of_several_threads_are_the_steps_of_one(num_threads, alone):
    simulation = resilin.Simulation(square())
    with ThreadPoolExecutor(num_threads) as pool:
        steps = list(pool.map(lambda _: simulation.step(), range(NUM_STEPS)))
    assert all(steps)
    assert simulation.is_finished
    np.testing.assert_array_equal(simulation.positions, alone.positions[-1])
    np.testing.assert_array_equal(simulation.velocities, alone.velocities[-1])


LOOKS = {
    "positions": lambda s: s.positions,
    "velocities": lambda s: s.velocities,
    "frame": lambda s: s.frame,
    "field": lambda s: s.fields["nodal_von_mises"],
    "picture": lambda s: s.plot(size=(80, 64)).pixels,
    "time": lambda s: s.time,
    "cells": lambda s: s.cells("square"),
    "text": repr,
}


@pytest.mark.parametrize("look", LOOKS)
@pytest.mark.parametrize("works", ["step", "run"])
def test_a_look_during_the_work_sees_a_whole_state(look, works, alone):
    """Positions are those of some frame; the motion stays the same."""
    simulation = resilin.Simulation(square())
    seen, is_done = [], threading.Event()

    def watch():
        while True:
            LOOKS[look](simulation)
            seen.append(simulation.positions)
            if is_done.is_set():
                break

    watchers = [threading.Thread(target=watch) for _ in range(3)]
    for watcher in watchers:
        watcher.start()
    if works == "run":
        simulation.run()
    else:
        while not simulation.is_finished:
            simulation.step()
    is_done.set()
    for watcher in watchers:
        watcher.join()
    np.testing.assert_array_equal(simulation.positions, alone.positions[-1])
    frames = {frame.tobytes() for frame in alone.positions}
    assert {positions.tobytes() for positions in seen} <= frames
    assert len(seen) > 0


def test_looks_come_between_the_steps_of_a_run():
    """And do not wait for its end."""
    simulation = resilin.Simulation(square(end_time=1e6))  # takes hours
    times, runs = [], 0
    while len(set(times)) <= 3 and runs < 50:  # on a busy machine a run may be over before this thread comes to look
        runner = threading.Thread(target=lambda: simulation.run(steps=400))
        runner.start()
        while runner.is_alive():
            times.append(simulation.time)
        runner.join()
        runs += 1
    assert len(set(times)) > 3
    assert times == sorted(times)
    assert simulation.time == pytest.approx(4 * runs)


def test_two_runs_at_once_share_the_steps():
    """The second waits for the end of the first and finds nothing left to do."""
    simulation = resilin.Simulation(square())
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda _: simulation.run(), range(2)))
    assert sorted(len(result.times) for result in results) == [1, NUM_STEPS + 1]
    assert all(result.status == "done" for result in results)


def test_a_material_that_comes_during_a_run_waits_for_its_end():
    simulation = resilin.Simulation(square())
    soft = resilin.Material("neo_hookean", youngs_modulus=1e4, poissons_ratio=0.3)
    with ThreadPoolExecutor(2) as pool:
        run = pool.submit(simulation.run)
        while simulation.time == 0:
            pass
        pool.submit(simulation.set_material, "square", soft).result()
        assert run.result().report["bodies"][0]["constants"]["shear_modulus"] == pytest.approx(1e5 / 2.8)
    assert simulation.bodies[0]["constants"]["shear_modulus"] == pytest.approx(1e4 / 2.6)


def test_ctrl_c_ends_the_waiting():
    simulation = resilin.Simulation(square(end_time=1e6))
    is_over = threading.Event()

    def work():
        while not is_over.is_set():
            simulation.run(steps=50)

    worker = threading.Thread(target=work)
    worker.start()
    main = threading.main_thread().ident
    timer = threading.Timer(0.3, signal.pthread_kill, [main, signal.SIGINT])
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(100000):
                simulation.run(steps=50)
    finally:
        is_over.set()
        worker.join()
        timer.cancel()


def test_a_signal_handler_inside_a_step_is_told_to_wait():
    """A reader during a step would see neither the state before the step nor the one after."""
    simulation = resilin.Simulation(cantilever(load_steps=1))
    errors = []

    def handler(*_):
        try:
            errors.append(simulation.time)
        except RuntimeError as error:
            errors.append(str(error))

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
        simulation.run(steps=3)
        for _ in range(3):
            time.sleep(0.002)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    told = [text for text in errors if isinstance(text, str)]
    assert all("expected a call between its steps" in text for text in told)


def test_simulations_of_their_own_run_side_by_side(alone):
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: resilin.run(square()), range(4)))
    for result in results:
        np.testing.assert_array_equal(result.positions, alone.positions)


def test_one_elastic_body_serves_several_threads():
    mesh = resilin.Mesh.box((1, 1, 1), (6, 6, 6))
    body = resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.4))
    states = [mesh.positions * (1 + 0.01 * i) for i in range(12)]
    expected = [(body.value(x), body.gradient(x), body.hessian(x).data, body.von_mises(x)) for x in states]
    with ThreadPoolExecutor(6) as pool:
        found = list(
            pool.map(lambda x: (body.value(x), body.gradient(x), body.hessian(x).data, body.von_mises(x)), states)
        )
    for ours, theirs in zip(found, expected, strict=True):
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(a, b)


def test_no_signal_is_lost_while_matrices_are_ordered():
    """Each SIGTERM arrives before the next is sent, also those that come while METIS works, in whatever thread."""
    scene = cantilever(load_steps=1)
    scene["body"][0]["mesh"] = {"box": {"size": [1, 0.2, 0.2], "cells": [32, 8, 8]}}
    scene["solver"] = {"kind": "multifrontal"}
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    is_over = threading.Event()
    counts = {"sent": 0, "lost": 0}

    def send():
        ours.settimeout(20)
        while not is_over.is_set() and not counts["lost"]:
            os.kill(os.getpid(), signal.SIGTERM)
            counts["sent"] += 1
            try:
                ours.recv(1)
            except TimeoutError:
                counts["lost"] += 1

    before = signal.signal(signal.SIGTERM, lambda *_: None)
    before_fd = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    sender = threading.Thread(target=send)
    try:
        sender.start()
        result = resilin.run(scene)
    finally:
        is_over.set()
        sender.join()
        signal.set_wakeup_fd(before_fd)
        signal.signal(signal.SIGTERM, before)
    assert counts["lost"] == 0
    assert counts["sent"] > 5
    np.testing.assert_array_equal(result.positions[-1], resilin.run(scene).positions[-1])
