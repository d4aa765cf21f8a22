import numpy as np
import pytest

import resilin


def pulled_block(**material):
    """A block of one cell, pulled to 1.5 times its length in 0.1 s and held for 20 s."""
    return {
        "simulation": {"kind": "static", "end_time": 20, "load_steps": 200},
        "body": [
            {
                "name": "block",
                "element": "Q1P0",
                "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1], "kind": "hexahedra"}},
                "material": {
                    "law": "neo_hookean_isochoric",
                    "shear_modulus": 1e5,
                    "bulk_modulus": 2e6,
                    "viscoelastic": {"g": [0.3, 0.2], "tau": [0.5, 1.0]} | material,
                },
            }
        ],
        "fix": [
            *({"name": axis, "where": {"group": f"{axis}_min"}, "components": axis} for axis in "xyz"),
            {
                "name": "grip",
                "where": {"group": "x_max"},
                "components": "x",
                "displacement": [0.5, 0, 0],
                "time_function": {"table": [[0, 0], [0.1, 1]]},
            },
        ],
    }


def test_force_and_stress_relax_to_those_of_the_long_term_moduli():
    result = resilin.run(pulled_block())
    assert result.status == "done"
    force = np.array([frame["reactions"]["grip"][0] for frame in result.report["frames"]])
    energy = [frame["energy"] for frame in result.report["frames"]]
    soft = pulled_block()
    material = soft["body"][0]["material"]
    del material["viscoelastic"]
    material["shear_modulus"] = 0.5e5
    relaxed = resilin.run(soft)
    assert (np.diff(force[2:]) < 2e-8 * force[-1]).all()  # twice the tolerance of the steps
    assert force[-1] == pytest.approx(relaxed.report["frames"][-1]["reactions"]["grip"][0], rel=1e-6)
    assert energy[-1]["elastic"] == pytest.approx(relaxed.report["frames"][-1]["energy"]["elastic"], rel=1e-6)
    assert energy[-1]["dissipated"] > 0
    stress = result.fields["cauchy_stress"][[2, -1], 0, 0, 0]
    assert stress[1] < 0.7 * stress[0]
    assert stress[1] == pytest.approx(relaxed.fields["cauchy_stress"][-1, 0, 0, 0], rel=1e-6)


@pytest.mark.parametrize(
    ("material", "text"),
    [
        ({"g": [0.5, 0.6]}, r"viscoelastic\.g: expected shares that sum to less than 1"),
        ({"tau": [0.5, -1]}, r"viscoelastic\.tau\[1\]: expected a relaxation time > 0 s, got -1"),
        ({"tau": [0.5]}, r"viscoelastic\.tau: expected 2 relaxation times, one for each share, got 1"),
        ({"moduli": "relaxed"}, r"viscoelastic\.moduli: expected"),
        ({"g": 0.5}, r"viscoelastic\.g: expected"),
    ],
)
def test_bad_input_is_refused_in_one_line(material, text):
    with pytest.raises(resilin.InputError, match=text) as error:
        resilin.Simulation(pulled_block(**material))
    assert "\n" not in str(error.value)


def test_gradients_and_inverse_design_are_refused():
    with pytest.raises(resilin.InputError, match="expected elastic materials where derivatives are asked for"):
        resilin.gradient(pulled_block(), {"reaction": {"of": "grip"}}, wrt=["body.block.material.shear_modulus"])
    with pytest.raises(resilin.InputError, match="expected an elastic material for a stress-free shape"):
        resilin.find_rest_shape(pulled_block())
