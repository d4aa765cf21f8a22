"""Motion from Python: every integrator, functions of time, steps that adapt, free vibrations."""

import numpy as np
import pytest

import resilin


def strip(**simulation):
    """A strip of 1 m, held at its left end."""
    return {
        "simulation": {"dimension": 2, "kind": "dynamic", "time_step": 0.01, "end_time": 0.05, **simulation},
        "body": [
            {
                "mesh": {"box": {"size": [1, 0.1], "cells": [10, 1]}},
                "material": {"law": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1000},
            }
        ],
        "fix": [{"name": "wall", "where": {"plane": {"axis": "x", "at": 0}}}],
        "probe": [{"name": "tip", "at": [1, 0.05]}],
    }


@pytest.mark.parametrize("integrator", ["backward_euler", "bdf2", "tr_bdf2", "newmark", "midpoint"])
def test_every_integrator_lets_a_strip_fall(integrator):
    result = resilin.run(strip(gravity=[0, -9.81], time_step=0.0025, integrator=integrator))
    assert result.status == "done"
    fallen = -result.report["frames"][-1]["probes"]["tip"]["displacement"][1]
    assert fallen == pytest.approx(0.5 * 9.81 * 0.05**2, rel=0.25)  # nearly free at the tip, for so short a time


def test_a_support_follows_its_function_of_time():
    scene = strip(end_time=0.1)
    scene["fix"][0] |= {"displacement": [0, 0.01], "time_function": {"table": [[0, 0], [0.05, 1], [0.1, 0]]}}
    result = resilin.run(scene)
    wall = np.flatnonzero(result.positions[0][:, 0] == 0)
    lifted = (result.positions - result.positions[0])[:, wall, 1].mean(axis=1)
    np.testing.assert_allclose(lifted, [0.01 * min(k, 10 - k) / 5 for k in range(11)], atol=1e-12)


def test_steps_that_adapt_end_at_the_end():
    result = resilin.run(strip(gravity=[0, -9.81], integrator="tr_bdf2", adaptive={"tolerance": 1e-4}))
    assert result.status == "done"
    assert result.times[-1] == pytest.approx(0.05, rel=1e-12)


def test_the_first_tone_of_a_strip_is_that_of_a_beam():
    scene = strip(kind="modes", modes={"count": 3})
    scene["simulation"] = {key: scene["simulation"][key] for key in ("dimension", "kind", "modes")}
    scene["body"][0]["element"] = "P2"
    frequencies = [mode["frequency"] for mode in resilin.run(scene).report["modes"]]
    stiffness = 1e6 / (1 - 0.3**2)  # plane strain
    euler = 1.8751**2 / (2 * np.pi) * np.sqrt(stiffness * 0.1**2 / (12 * 1000))
    assert frequencies[0] == pytest.approx(euler, rel=0.03)
    assert frequencies == sorted(frequencies)
