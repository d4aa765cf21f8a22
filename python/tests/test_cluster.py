"""Sweeps on a Dask cluster: workers that die, and threads that are counted."""

import os
import signal
import threading
import time

import numpy as np
import pytest
from test_sweep import MODULUS, RATIO, sheet

import resilin

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client():
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, memory_limit="1GiB", dashboard_address=":0", processes=True
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def without_seconds(table):
    return {name: list(column) for name, column in table.items() if name != "seconds"}


def test_workers_find_what_this_process_finds(client, tmp_path):
    parameters = {MODULUS: np.geomspace(1e5, 1e7, 20), RATIO: [0.1, 0.4, 0.7]}
    there = resilin.sweep(sheet(), parameters, client=client, out=tmp_path / "there")
    here = resilin.sweep(sheet(), parameters, out=tmp_path / "here")
    assert there.num_rows == 60
    assert str(without_seconds(there)) == str(without_seconds(here))
    # Either goes on where the other was.
    rows = set((tmp_path / "there" / "rows").iterdir())
    resilin.sweep(sheet(), parameters, out=tmp_path / "there")
    assert set((tmp_path / "there" / "rows").iterdir()) == rows


def slow(**simulation):
    scene = sheet(simulation={"kind": "dynamic", "dimension": 2, "time_step": 1e-3, "end_time": 0.5, **simulation})
    scene["fix"] = scene["fix"][:1]
    return scene


def test_workers_that_die_are_survived(client, tmp_path):
    killed = []

    def kill_one():
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not list((tmp_path / "out").glob("rows/*")):
            time.sleep(0.02)
        pids = list(client.run(os.getpid).values())
        os.kill(pids[0], signal.SIGKILL)
        killed.append(pids[0])

    killer = threading.Thread(target=kill_one)
    killer.start()
    parameters = {MODULUS: np.geomspace(1e5, 1e7, 30)}
    table = resilin.sweep(slow(), parameters, client=client, out=tmp_path / "out")
    killer.join()
    assert killed
    assert table.num_rows == 30
    assert set(table["status"]) == {"done"}
    here = resilin.sweep(slow(), parameters)
    np.testing.assert_array_equal(table["energy.elastic"], here["energy.elastic"])


def test_a_scene_that_takes_its_workers_with_it_is_a_failed_one(tmp_path, monkeypatch):
    import dask

    from resilin import cluster as cluster_module

    def deadly(definition, tasks, folder, threads):
        if any(scene == 3 for scene, _ in tasks):
            os._exit(1)
        from resilin.cluster import run_scenes

        return run_scenes(definition, tasks, folder, threads)

    monkeypatch.setattr(cluster_module, "MOST_SCENES", 4)
    monkeypatch.setattr(cluster_module, "run_scenes", deadly)
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        table = resilin.sweep(sheet(), {MODULUS: np.geomspace(1e5, 1e7, 6)}, client=client, out=tmp_path / "out")
    assert table.num_rows == 6
    assert list(table.failed) == [3]
    assert "KilledWorker" in table.failed[3]


def test_each_scene_has_one_thread(client, tmp_path):
    resilin.sweep(sheet(), {MODULUS: [1e5, 1e6]}, client=client, out=tmp_path / "out")
    assert set(client.run(resilin.num_threads).values()) <= {1, os.cpu_count()}
    assert 1 in client.run(resilin.num_threads).values()


def test_workers_with_other_files_are_refused(client, tmp_path):
    scene = sheet()
    scene["body"][0]["material"]["poissons_ratio"] = {"file": str(tmp_path / "ratio.csv")}
    (tmp_path / "ratio.csv").write_text("0.3\n0.3\n")
    resilin.sweep(scene, {MODULUS: [1e5]}, client=client, out=tmp_path / "out")
    # The client's hash differs from the file that the worker finds.
    from resilin import cluster as cluster_module

    made = cluster_module.make_sweep(resilin.sweeps._definition(scene, {MODULUS: [1e5]}, "grid", None, 0, (), "none"))
    import pickle

    definition = pickle.dumps(resilin.sweeps._definition(scene, {MODULUS: [1e5]}, "grid", None, 0, (), "none"))
    wanted = made.hash(0)
    (tmp_path / "ratio.csv").write_text("0.25\n0.3\n")
    with pytest.raises(resilin.InputError, match="same version of resilin and the same files"):
        client.submit(cluster_module.run_scenes, definition, [(0, wanted)], "", 1, pure=False).result()


def test_few_scenes_are_in_flight(client, tmp_path):
    most = 0
    stop = threading.Event()

    def watch():  # the definition of the sweep, which the workers get first, is no scene
        nonlocal most
        while not stop.is_set():
            scenes = [future for key, future in list(client.futures.items()) if key.startswith("run_scenes")]
            most = max(most, [future.status for future in scenes].count("pending"))
            time.sleep(0.001)

    watcher = threading.Thread(target=watch)
    watcher.start()
    table = resilin.sweep(
        sheet(), {MODULUS: {"logspace": [1e5, 1e7, 500]}}, client=client, out=tmp_path / "out", in_flight=3
    )
    stop.set()
    watcher.join()
    assert table.num_rows == 500
    assert 0 < most <= 3
