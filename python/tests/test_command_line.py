"""The command line that comes with the package: `resilin` and `python -m resilin`."""

import importlib.metadata
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
from importlib.util import find_spec

import pytest
from toml_reader import tomllib

import resilin
from resilin.__main__ import PROGRAM

SCRIPT = pathlib.Path(sys.executable).parent / "resilin"
SCENE = """
simulation = { kind = "static", gravity = [0, 0, -9.81] }
fix = [{ where = { group = "x_min" } }]
[[body]]
mesh = { box = { size = [1, 0.2, 0.2], cells = [4, 1, 1] } }
"""


def is_installed():
    try:
        importlib.metadata.distribution("resilin")
    except importlib.metadata.PackageNotFoundError:
        return False  # the package is used from a build folder
    return True


COMMANDS = {"python -m resilin": [sys.executable, "-m", "resilin"]}
if is_installed():
    COMMANDS["resilin"] = [str(SCRIPT)]


@pytest.fixture(params=COMMANDS)
def command(request):
    return COMMANDS[request.param]


def run(command, *arguments, **options):
    return subprocess.run([*command, *map(str, arguments)], capture_output=True, text=True, check=False, **options)


def test_it_is_of_the_same_version(command):
    done = run(command, "--version")
    assert done.returncode == 0
    assert resilin.__version__ in done.stdout


def test_it_runs_a_scene_and_draws_it(command, tmp_path):
    scene = tmp_path / "beam.toml"
    scene.write_text(SCENE)
    done = run(command, "run", scene, "--out", tmp_path / "out", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["version"] == resilin.__version__
    assert run(command, "picture", tmp_path / "out", "--out", tmp_path / "a.png").returncode == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_it_says_what_is_wrong_in_one_line_and_exits_with_1(command, tmp_path):
    done = run(command, "run", tmp_path / "nowhere.toml")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "nowhere.toml" in done.stderr


def test_it_serves_the_page_until_ctrl_c(command, tmp_path):
    scene = tmp_path / "beam.toml"
    scene.write_text(SCENE)
    server = subprocess.Popen(
        [*command, "view", str(scene), "--no-browser"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    lines = [server.stdout.readline() for _ in range(2)]
    assert any("http://127.0.0.1:" in line for line in lines)
    time.sleep(0.1)
    server.send_signal(signal.SIGINT)
    server.communicate(timeout=60)
    assert server.returncode == 0


def test_it_is_there():
    assert PROGRAM.exists()
    assert not is_installed() or SCRIPT.exists()


def test_doctor_names_extras_that_the_package_has(tmp_path):
    """By a python3 that has nothing but our package."""
    python = tmp_path / "python3"
    python.write_text(f"#!/bin/sh\necho version {resilin.__version__}\n")
    python.chmod(0o755)
    run = subprocess.run(
        [PROGRAM, "doctor", "--json"], capture_output=True, text=True, check=True, env={"PATH": str(tmp_path)}
    )
    cures = {finding["name"]: finding["cure"] for finding in json.loads(run.stdout)}
    named = {name: found[1] for name, cure in cures.items() if (found := re.search(r"resilin\[(\w+)\]", cure))}
    settings = tomllib.loads((pathlib.Path(__file__).parents[2] / "pyproject.toml").read_text())
    extras = settings["project"]["optional-dependencies"]
    assert set(named.values()) == extras.keys()
    for package, extra in named.items():
        assert any(requirement.startswith(package) for requirement in extras[extra]), package


def test_doctor_finds_this_package_and_what_it_works_with():
    folder = pathlib.Path(sys.executable).parent
    run = subprocess.run(
        [PROGRAM, "doctor", "--json"],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PATH": f"{folder}:{os.environ['PATH']}"},
    )
    well = {finding["name"]: finding["ok"] for finding in json.loads(run.stdout)}
    assert well["Python"]
    for package in ("torch", "matplotlib", "pandas", "pyvista", "meshio", "anywidget", "pyarrow", "distributed"):
        assert well[package] == (find_spec(package) is not None), package
