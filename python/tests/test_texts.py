"""Texts that no file can hold: half a character, as a careless decoding leaves it."""

import copy
import os

import numpy as np
import pytest
from scenes import cantilever

import resilin

HALF = "\ud800"
MESH = resilin.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
LAW = resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.3)


def scene_with(*path):
    """A scene with half a character as the value at the end of the path."""
    scene = copy.deepcopy(cantilever())
    place = scene
    for key in path[:-1]:
        place = place.setdefault(key, {}) if isinstance(key, str) else place[key]
    place[path[-1]] = HALF
    return scene


IN_SCENES = [
    ("title",),
    ("simulation", "kind"),
    ("body", 0, "name"),
    ("body", 0, "element"),
    ("body", 0, "mesh"),
    ("body", 0, "material", "law"),
    ("body", 0, "material", HALF),
    ("fix", 0, "where", "group"),
    ("probe", 0, "name"),
    ("output", "fields"),
    (HALF,),
]


@pytest.mark.parametrize("path", IN_SCENES, ids=ascii)
def test_half_a_character_in_a_scene_is_refused_with_its_place(path):
    with pytest.raises(resilin.InputError) as refusal:
        resilin.Simulation(scene_with(*path))
    line = str(refusal.value)
    assert line.encode().decode() == line  # it can be printed
    assert "\n" not in line
    assert "'\\ud800'" in line
    key = path[-1]
    assert key in line or key == HALF


@pytest.fixture
def result():
    return resilin.run(cantilever(), steps=1)


CALLS = {
    "law": lambda r: resilin.Material(HALF, youngs_modulus=1, poissons_ratio=0),
    "constant": lambda r: resilin.Material("neo_hookean", **{HALF: 1}),
    "name of a mesh": lambda r: resilin.Mesh(MESH.positions, MESH.cells, name=HALF),
    "kind of cells": lambda r: resilin.Mesh(MESH.positions, {HALF: MESH.cells}),
    "group": lambda r: resilin.Mesh(MESH.positions, MESH.cells, {HALF: [0]}),
    "file to read": lambda r: resilin.read_mesh(HALF + ".msh"),
    "file to write": lambda r: MESH.write(HALF + ".msh"),
    "element": lambda r: resilin.Elastic(MESH, LAW, element=HALF),
    "quadrature": lambda r: resilin.Elastic(MESH, LAW, quadrature=HALF),
    "mass": lambda r: resilin.Elastic(MESH, LAW).mass(kind=HALF),
    "projection": lambda r: LAW.stress_tangent(np.eye(3), HALF),
    "curve": lambda r: LAW.curve(HALF),
    "scene file": lambda r: resilin.Simulation(HALF + ".toml"),
    "override": lambda r: resilin.Simulation(cantilever(), ["title=" + HALF]),
    "override by key": lambda r: resilin.Simulation(cantilever(), {"title": HALF}),
    "folder": lambda r: resilin.run(cantilever(), out=HALF),
    "field": lambda r: r.fields[HALF],
    "field of a picture": lambda r: r.plot(HALF),
    "view": lambda r: r.plot(view=HALF),
    "colours": lambda r: r.plot(map=HALF),
    "folder of a picture": lambda r: resilin.picture(HALF),
    "body": lambda r: resilin.Simulation(cantilever()).cells(HALF),
    "body with a skin": lambda r: resilin.Simulation(cantilever()).skin_positions(HALF),
    "body of a material": lambda r: resilin.Simulation(cantilever()).set_material(HALF, LAW),
}


@pytest.mark.parametrize("call", CALLS)
def test_half_a_character_in_a_call_is_refused_in_one_line(call, result):
    with pytest.raises(resilin.InputError) as refusal:
        CALLS[call](result)
    line = str(refusal.value)
    assert line.encode().decode() == line
    assert "\n" not in line
    assert "\\ud800" in line


def test_whole_characters_of_all_kinds_pass(tmp_path):
    name = "b\u00e4r \U0001f43b \u0627"
    scene = cantilever()
    scene["title"] = scene["body"][0]["name"] = name
    simulation = resilin.Simulation(scene)
    assert name in repr(simulation)
    assert simulation.bodies[0]["name"] == name
    mesh = resilin.Mesh(MESH.positions, MESH.cells, {name: [0]}, name=name)
    assert list(mesh.groups) == [name]
    mesh.write(tmp_path / f"{name}.msh")
    assert list(resilin.read_mesh(tmp_path / f"{name}.msh").groups) == [name]


def test_a_file_whose_name_is_no_utf_8_is_read(tmp_path):
    """Such names are bytes, which Python's paths hold as they are."""
    path = os.fsdecode(os.fsencode(tmp_path) + b"/\xff.msh")
    MESH.write(path)
    assert len(resilin.read_mesh(path).positions) == 3
    with pytest.raises(resilin.InputError):
        resilin.read_mesh(os.fsdecode(os.fsencode(tmp_path) + b"/\xfe.msh"))
