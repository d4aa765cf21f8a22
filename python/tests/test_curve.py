"""Stress-stretch curves."""

# ruff: noqa: N806 - F and P are the letters of the field

import json

import numpy as np
import pytest

import resilin

KINDS = ["uniaxial", "equibiaxial", "planar", "shear", "volumetric"]


def material(law="neo_hookean"):
    return resilin.Material(law, youngs_modulus=1e5, poissons_ratio=0.3)


@pytest.mark.parametrize("kind", KINDS)
def test_points_stand_in_the_order_asked_for(kind):
    stretches = np.array([1.2, 0.8, 1.0])
    curve = material().curve(kind, stretches)
    assert curve.kind == kind
    assert np.array_equal(curve.stretch, stretches)
    assert curve.is_stable.all() and curve.is_stable.shape == (3,)
    for k, stretch in enumerate(stretches):
        alone = material().curve(kind, [stretch])
        assert alone.nominal_stress[0] == pytest.approx(curve.nominal_stress[k], rel=1e-12, abs=1e-9)


def test_stresses_are_those_of_the_material_at_the_solved_stretches():
    law = material()
    curve = law.curve("uniaxial", np.linspace(0.6, 1.8, 7))
    F = curve.stretches[:, :, None] * np.eye(3)
    P = law.first_piola_kirchhoff_stress(F)
    assert np.allclose(P[:, 0, 0], curve.nominal_stress, rtol=1e-12, atol=1e-9)
    assert np.allclose(P[:, 1:, 1:], 0, atol=1e-9)  # Pa: free sides, E = 1e5 Pa
    assert np.allclose(law.energy_density(F), curve.energy_density, rtol=1e-11, atol=1e-9)
    assert np.allclose(np.linalg.det(F), curve.volume_ratio, rtol=1e-14)
    sigma = law.cauchy_stress(F)
    assert np.allclose(sigma[:, 0, 0], curve.cauchy_stress, rtol=1e-12, atol=1e-9)


def test_usual_stretches_stand_in_for_none():
    curve = material().curve("planar")
    assert curve.stretch[0] == 0.5 and curve.stretch[-1] == 2
    assert material().curve("shear").stretch[0] == 0


def test_lost_stability_is_said_and_never_hidden():
    with pytest.warns(UserWarning, match="the nominal stress drops below stretch 0.57735 "):
        curve = material("saint_venant_kirchhoff").curve("uniaxial", [0.5, 1.0, 2.5])
    assert list(curve.stability) == ["stress_drops", "stable", "no_state"]
    assert np.isnan(curve.nominal_stress[2]) and np.isnan(curve.energy_density[2])
    below, above = curve.limits
    assert (below.loss, below.side) == ("stress_drops", "below")
    assert below.stretch == pytest.approx(3**-0.5, rel=1e-6)
    assert (above.loss, above.side) == ("no_state", "above")


def test_curves_are_written_as_csv_and_json(tmp_path):
    with pytest.warns(UserWarning):
        curve = material("saint_venant_kirchhoff").curve("uniaxial", [0.9, 1.25, 2.5])
    curve.to_csv(tmp_path / "curve.csv")
    lines = (tmp_path / "curve.csv").read_text().splitlines()
    assert lines[0].startswith("stretch,nominal_stress [Pa],")
    assert [float(line.split(",")[1]) for line in lines[1:3]] == list(curve.nominal_stress[:2])
    curve.to_json(tmp_path / "curve.json")
    content = json.loads((tmp_path / "curve.json").read_text())
    assert content["points"][1]["cauchy_stress"] == curve.cauchy_stress[1]
    assert content["points"][2]["nominal_stress"] is None
    assert content["limits"][0]["loss"] == "no_state"


@pytest.mark.parametrize(
    ("kind", "stretches", "message"),
    [
        ("uniaxal", [1.0], 'kind: expected one of .* did you mean "uniaxial"'),
        (3, [1.0], "kind: expected"),
        ("uniaxial", [1.0, -1.0], r"stretches\[1\]: expected a stretch above 0, got -1"),
        ("uniaxial", [np.nan], r"stretches\[0\]"),
        ("uniaxial", 1.0, "stretches: expected a list of numbers"),
        ("uniaxial", [1 + 1j], "stretches: expected a list of numbers"),
    ],
)
def test_what_is_no_curve_is_refused(kind, stretches, message):
    with pytest.raises(ValueError, match=message):
        material().curve(kind, stretches)


def test_constants_of_many_states_are_refused():
    law = resilin.Material("neo_hookean", youngs_modulus=np.array([1e5, 2e5]), poissons_ratio=0.3)
    with pytest.raises(ValueError, match="expected one number for a curve"):
        law.curve("uniaxial")


def test_no_points_give_an_empty_curve():
    assert material().curve("uniaxial", []).nominal_stress.shape == (0,)


def test_plot_draws_stable_states_solid_and_others_dashed():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    with pytest.warns(UserWarning):
        curve = material("saint_venant_kirchhoff").curve("uniaxial", np.linspace(0.4, 1.5, 12))
    axes = curve.plot()
    solid, dashed = axes.lines
    assert np.array_equal(~np.isnan(solid.get_ydata()), curve.is_stable)
    assert np.isfinite(dashed.get_ydata()[~curve.is_stable]).all()
    assert axes.get_ylabel() == "nominal stress [Pa]"
    assert curve.plot(axes, stress="cauchy") is axes
    with pytest.raises(ValueError, match="stress: expected"):
        curve.plot(stress="true")
