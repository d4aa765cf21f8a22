"""Sums of constitutive models: arrays of states, scenes, gradients and bad input."""

import numpy as np
import pytest

import resilin

GROUND = {"law": "mooney_rivlin", "c10": 2e5, "c01": 3e4, "bulk_modulus": 2e6}
FIBRE = {"law": "exponential_fibre", "fibre_modulus": 1e5, "fibre_stiffening": 0.5, "fibres": [[1, 0, 0]]}


def sum_material():
    return resilin.Material(
        "mooney_rivlin + exponential_fibre",
        fibres=[1, 0, 0],
        **{
            "sum[0].c10": 2e5,
            "sum[0].c01": 3e4,
            "sum[0].bulk_modulus": 2e6,
            "sum[1].fibre_modulus": 1e5,
            "sum[1].fibre_stiffening": 0.5,
        },
    )


def states(count=20):
    return np.eye(3) + 0.1 * np.random.default_rng(0).standard_normal((count, 3, 3))


def bar(material):
    return {
        "simulation": {"kind": "static"},
        "newton": {"tolerance": 1e-11},
        "body": [
            {
                "name": "bar",
                "element": "P1",
                "mesh": {"box": {"size": [1, 0.3, 0.3], "cells": [4, 2, 2]}},
                "material": material,
            }
        ],
        "fix": [{"name": "wall", "where": {"group": "x_min"}}],
        "load": [{"name": "pull", "kind": "traction", "where": {"group": "x_max"}, "value": [2e4, 0, 0]}],
    }


def test_a_sum_is_the_sum_of_its_parts():
    F = states()  # noqa: N806 - the letter of the field
    ground = resilin.Material("mooney_rivlin", c10=2e5, c01=3e4, bulk_modulus=2e6)
    tissue = resilin.Material(
        "exponential_fibre",
        shear_modulus=1.0,
        lame_lambda=1.0,
        fibre_modulus=1e5,
        fibre_stiffening=0.5,
        fibres=[1, 0, 0],
    )
    small = resilin.Material("neo_hookean", shear_modulus=1.0, lame_lambda=1.0)
    both = sum_material()
    for name in ("energy_density", "first_piola_kirchhoff_stress", "stress_tangent"):
        parts = [getattr(law, name)(F) for law in (ground, tissue, small)]
        expected = parts[0] + parts[1] - parts[2]
        np.testing.assert_allclose(getattr(both, name)(F), expected, rtol=1e-12, atol=1e-9 * np.abs(expected).max())


def test_a_sum_has_derivatives_by_the_constants_of_its_parts():
    psi_by, p_by = sum_material().constant_derivatives(states())["sum[1].fibre_modulus"]
    assert psi_by.shape == (20,)
    assert p_by.shape == (20, 3, 3)
    assert np.abs(psi_by).max() > 0


def test_a_scene_has_a_sum_and_its_gradient():
    scene = bar({"density": 1000, "sum": [GROUND, FIBRE]})
    report = resilin.run(scene).report["bodies"][0]
    assert report["law"] == "mooney_rivlin + exponential_fibre"
    assert report["constants"]["sum[1].fibre_modulus"] == 1e5
    objective = {"position": {"body": "bar", "at": [1, 0, 0], "target": [1.2, 0, 0], "sigma": 1e-2}}
    keys = [f"body.bar.material.sum[{part}].{name}" for part, name in ((0, "c10"), (1, "fibre_modulus"))]
    _, gradients = resilin.value_and_gradient(scene, objective, wrt=keys)
    for key, part, name in zip(keys, (0, 1), ("c10", "fibre_modulus"), strict=True):
        values = []
        for factor in (1 + 1e-4, 1 - 1e-4):
            parts = [dict(GROUND), dict(FIBRE)]
            parts[part][name] *= factor
            value, _ = resilin.value_and_gradient(bar({"density": 1000, "sum": parts}), objective, wrt=keys)
            values.append(value)
        slope = (values[0] - values[1]) / (2e-4 * scene["body"][0]["material"]["sum"][part][name])
        assert gradients[key] == pytest.approx(slope, rel=1e-5)


def test_fewer_moduli_than_a_solid_needs_are_refused():
    with pytest.raises(resilin.InputError, match="stable"):
        resilin.Material("yeoh + gent", **{"sum[0].c10": 1e5, "sum[1].limit": 30})


def test_fibres_across_the_plane_act_in_axisymmetric_solids():
    """A ring of one cell whose stretches are 1.2 along the radius and the hoop."""
    fibres = [[0, 0.6, 0.8], [0, 0.6, -0.8]]
    tissue = {**FIBRE, "fibres": fibres}
    scene = {
        "simulation": {"kind": "static", "dimension": "axisymmetric"},
        "body": [
            {
                "name": "ring",
                "element": "Q1",
                "mesh": {"box": {"size": [0.4, 0.2], "origin": [0.1, 0], "cells": [1, 1], "kind": "quadrilaterals"}},
                "material": {"sum": [GROUND, tissue]},
            }
        ],
        "fix": [
            {"name": "inside", "where": {"group": "x_min"}, "components": "x", "displacement": [0.02, 0]},
            {"name": "outside", "where": {"group": "x_max"}, "components": "x", "displacement": [0.1, 0]},
            {"name": "bottom", "where": {"group": "y_min"}, "components": "y"},
            {"name": "top", "where": {"group": "y_max"}, "components": "y"},
        ],
    }
    result = resilin.run(scene)
    F = np.diag([1.2, 1, 1.2])[None]  # noqa: N806 - the letter of the field
    ground = resilin.Material("mooney_rivlin", c10=2e5, c01=3e4, bulk_modulus=2e6)
    own = {"fibre_modulus": 1e5, "fibre_stiffening": 0.5, "shear_modulus": 1.0, "lame_lambda": 1.0}
    fibre = resilin.Material("exponential_fibre", fibres=fibres, **own)
    nothing = resilin.Material("neo_hookean", shear_modulus=1.0, lame_lambda=1.0)
    density = ground.energy_density(F) + fibre.energy_density(F) - nothing.energy_density(F)
    volume = np.pi * (0.5**2 - 0.1**2) * 0.2
    assert result.report["frames"][-1]["energy"]["elastic"] == pytest.approx(volume * float(density[0]), rel=1e-10)
