"""`resilin.check`: what a scene selects and what its loads amount to, before a run."""

import numpy as np
import pytest
from scenes import cantilever

import resilin

BEAM = {
    "simulation": {"kind": "static", "gravity": [0, 0, 0]},
    "body": [
        {
            "name": "beam",
            "mesh": {"box": {"size": [1, 0.2, 0.1], "cells": [5, 2, 2]}},
            "translate": [2, 0, 0],
            "material": {"law": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1000},
        }
    ],
    "fix": [{"name": "wall", "where": {"group": "x_min"}}],
    "load": [{"name": "pull", "kind": "traction", "where": {"group": "x_max"}, "value": [50, 0, -100]}],
}


def test_a_scene_tells_what_it_selects_and_what_its_loads_amount_to(recwarn):
    found = resilin.check(BEAM)
    assert [body["name"] for body in found.bodies] == ["beam"]
    assert found.bodies[0]["cells"] == len(resilin.Simulation(BEAM).cells("beam"))
    np.testing.assert_allclose(found.boxes["beam"], [[2, 0, 0], [3, 0.2, 0.1]], atol=1e-12)
    (wall,) = found.fixes
    assert wall["nodes"] > 0
    np.testing.assert_allclose(wall["area"], 0.02, rtol=1e-12)
    (pull,) = found.loads
    np.testing.assert_allclose(pull["center"], [3, 0.1, 0.05], atol=1e-12)
    np.testing.assert_allclose(pull["force"], [1, 0, -2], atol=1e-12)  # 0.02 m^2
    assert found.warnings == []
    assert not [w for w in recwarn if w.category is UserWarning]
    lines = str(found).splitlines()
    assert lines[0] == "no errors, 0 warnings"
    assert lines[1].startswith("body beam: neo_hookean, ")
    assert lines[1].endswith("from (2, 0, 0) to (3, 0.2, 0.1) m")
    assert lines[2].startswith("fix wall: on ")
    assert lines[3].startswith("load pull: traction on ")
    assert lines[3].endswith("0.02 m^2) about (3, 0.1, 0.05) m: force (1, 0, -2) N")


def test_warnings_are_in_the_result_and_are_not_given_again(recwarn):
    scene = {**BEAM, "load": []}
    found = resilin.check(scene)
    assert found.warnings
    assert str(found).splitlines()[0] == f"warning: {found.warnings[0]}"
    assert not [w for w in recwarn if w.category is UserWarning]


def test_overrides_and_errors_are_those_of_a_simulation():
    scene = cantilever()
    stiffness = [
        resilin.check(scene, {"body.beam.material.youngs_modulus": modulus}).bodies[0]["constants"]["shear_modulus"]
        for modulus in (1e5, 2e5)
    ]
    np.testing.assert_allclose(stiffness[1], 2 * stiffness[0], rtol=1e-12)
    with pytest.raises(resilin.InputError, match="kynd"):
        resilin.check({**scene, "simulation": {"kynd": "static"}})


def test_a_mesh_is_referred_to_its_own_check(tmp_path):
    with pytest.raises(
        resilin.InputError, match=r'expected a scene file \(.toml\) or a dict, got a file ".msh"; read_mesh'
    ):
        resilin.check(tmp_path / "box.msh")
