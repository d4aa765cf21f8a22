"""Materials from tests; the numbers themselves are checked in C++ (tests/fit)."""

import json
import pathlib

import numpy as np
import pytest

import resilin

EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "examples" / "fit_rubber.toml"
STRETCH = np.linspace(1.1, 3.0, 80)  # longer than what is handed over as a list


def neo_hookean_test(modulus, **more):
    stress = modulus * (STRETCH - STRETCH**-2)
    return {"test": [{"mode": "uniaxial", "stretch": STRETCH, "nominal_stress": stress, "unit": "MPa", **more}]}


def test_arrays_give_back_the_law_that_they_are_made_of():
    fit = resilin.fit(neo_hookean_test(0.4), laws=["neo_hookean", "gent"])
    constant = fit["neo_hookean"].constants["shear_modulus"]
    assert constant.value == pytest.approx(4e5, rel=1e-12)
    assert constant.interval == pytest.approx((4e5, 4e5))
    assert constant.half_width_95 > 0
    assert fit["neo_hookean"].r_squared == {"uniaxial": pytest.approx(1)}
    assert fit["neo_hookean"].points == 80
    curve = fit["neo_hookean"].curves["uniaxial"]
    assert curve.nominal_stress == pytest.approx(4e5 * (curve.load - curve.load**-2), abs=1e-3)


def test_the_material_is_ready_for_a_scene():
    law = resilin.fit(neo_hookean_test(0.4), laws="neo_hookean").best
    tangent = law.material.stress_tangent(np.eye(3))
    assert tangent[0, 1, 0, 1] == pytest.approx(4e5)


def test_a_file_is_fitted_as_by_the_command_line(tmp_path):
    fit = resilin.fit(EXAMPLE)
    assert len(fit.laws) == 6
    assert [law.aicc for law in fit.laws] == sorted(law.aicc for law in fit.laws)
    fit.save(tmp_path / "out")
    assert json.loads((tmp_path / "out" / "fit.json").read_text())["laws"][0]["name"] == fit.best.name
    assert "<svg" in (tmp_path / "out" / "fit.html").read_text()
    assert "material = {" in (tmp_path / "out" / "material.toml").read_text()
    assert fit.best.name in fit.text


def test_overrides_and_laws_replace_what_the_file_says():
    fit = resilin.fit(EXAMPLE, laws="all", overrides={"fit.residual": "relative"})
    assert "relative residuals" in fit.objective
    assert "holzapfel_gasser_ogden" in fit.not_fitted
    assert {"ogden1", "ogden2", "ogden3"} <= {law.name for law in fit.laws}


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"test": [{"mode": "uniaxial", "stretch": [1.1], "nominal_stress": [1, 2]}]}, "as many as there are loads"),
        ({"tests": []}, 'did you mean "test"'),
        (neo_hookean_test(0.4, weight=-1), "weight"),
        (3, "a path or a dict"),
    ],
)
def test_wrong_data_are_refused_in_one_line(data, words):
    with pytest.raises(resilin.InputError, match=words) as error:
        resilin.fit(data)
    assert "\n" not in str(error.value)


def test_an_unknown_law_names_the_nearest():
    with pytest.raises(resilin.InputError, match="neo_hookean"):
        resilin.fit(neo_hookean_test(0.4), laws=["neo_hokean"])
    with pytest.raises(resilin.InputError, match="gent"):
        resilin.fit(neo_hookean_test(0.4), laws=["gent"])["yeoh"]
