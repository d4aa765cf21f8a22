"""Constants of a Material: numbers, one value for every state, and what is refused."""

# ruff: noqa: N803, N806 - F is the letter of the field

import numpy as np
import pytest
from every_law import LAWS, beside_young_and_poisson, poissons_ratio_of

import resilin


def states(count):
    return np.eye(3) + 0.1 * np.random.default_rng(0).uniform(-1, 1, (count, 3, 3))


def refusal_of(law, **arguments):
    with pytest.raises(resilin.InputError) as refusal:
        resilin.Material(law, **arguments)
    assert isinstance(refusal.value, ValueError)
    assert "\n" not in str(refusal.value)
    return str(refusal.value)


@pytest.mark.parametrize("law", LAWS)
def test_each_state_has_its_own_constants_where_arrays_are_given(law):
    young, poisson = np.linspace(1e5, 3e5, 6), poissons_ratio_of(law, np.linspace(0.2, 0.4, 6)) * np.ones(6)
    others = beside_young_and_poisson(law, young)
    F = states(6)
    together = resilin.Material(law, youngs_modulus=young, poissons_ratio=poisson, **others)
    for method in ("energy_density", "first_piola_kirchhoff_stress", "stress_tangent"):
        got = getattr(together, method)(F)
        for i in range(6):
            its = {name: value[i] if isinstance(value, np.ndarray) else value for name, value in others.items()}
            alone = resilin.Material(law, youngs_modulus=young[i], poissons_ratio=poisson[i], **its)
            np.testing.assert_array_equal(got[i], getattr(alone, method)(F[i]))
    assert np.shape(next(iter(together.constants.values()))) == (6,)


def test_arrays_of_constants_broadcast_against_the_leading_shape():
    young = np.array([1e5, 2e5, 3e5])
    material = resilin.Material("neo_hookean", youngs_modulus=young, poissons_ratio=0.3)
    F = states(6).reshape(2, 3, 3, 3)
    psi = material.energy_density(F)
    assert psi.shape == (2, 3)
    np.testing.assert_array_equal(psi[1], material.energy_density(F[1]))
    assert material.energy_density(F[0, 0]).shape == (3,)
    assert material.elastic_forces(F, np.eye(3), 1.0).shape == (2, 3, 4, 3)
    with pytest.raises(resilin.InputError, match=r"F: expected leading shapes that go together and with the constants"):
        material.energy_density(states(4))


def test_an_array_beside_a_number_leaves_the_number():
    material = resilin.Material("neo_hookean", shear_modulus=[1.0, 2.0], lame_lambda=3.0)
    assert material.constants["lame_lambda"] == 3.0
    np.testing.assert_array_equal(material.constants["shear_modulus"], [1.0, 2.0])


def test_constants_are_those_of_the_small_strain_solid():
    material = resilin.Material("neo_hookean", youngs_modulus=1e6, poissons_ratio=0.25)
    assert material.constants == {"shear_modulus": pytest.approx(4e5), "lame_lambda": pytest.approx(4e5)}
    assert material.law == material.info.name == "neo_hookean"
    assert repr(material) == "Material('neo_hookean', shear_modulus=400000, lame_lambda=400000)"


def test_a_later_change_of_the_array_that_was_given_changes_nothing():
    young = np.array([1e5, 2e5])
    material = resilin.Material("neo_hookean", youngs_modulus=young, poissons_ratio=0.3)
    before = material.energy_density(states(2))
    young[:] = 1
    np.testing.assert_array_equal(material.energy_density(states(2)), before)
    with pytest.raises(ValueError, match="read-only"):
        material.constants["shear_modulus"][0] = 1


def test_the_table_of_laws_is_the_help():
    text = resilin.Material.__doc__
    for name, law in resilin.laws().items():
        assert law.name == name
        for part in (name, law.title, law.formula, law.source, law.inversion, *(c.name for c in law.constants)):
            assert part in text
        assert law.constants


def test_what_is_no_law_is_refused():
    assert "law: expected one of" in refusal_of("neo_hooken", youngs_modulus=1.0, poissons_ratio=0.3)
    assert 'did you mean "neo_hookean"?' in refusal_of("neo_hooken", youngs_modulus=1.0, poissons_ratio=0.3)
    assert refusal_of(3, youngs_modulus=1.0, poissons_ratio=0.3) == "law: expected a name, got 3"


@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ({"youngs_modulus": 1.0, "poissons_ratio": 0.5}, "neo_hookean.poissons_ratio: expected a number in (-1, 0.5)"),
        ({"youngs_modulus": -1.0, "poissons_ratio": 0.3}, "neo_hookean.youngs_modulus: expected a number above 0"),
        ({"youngs_modulus": np.nan, "poissons_ratio": 0.3}, "neo_hookean.youngs_modulus: expected a number above 0"),
        ({"youngs_modulus": 1.0}, "neo_hookean.poissons_ratio: expected"),
        ({}, "neo_hookean.youngs_modulus: expected youngs_modulus and poissons_ratio"),
        ({"youngs_modulus": 1.0, "poissons_rato": 0.3}, "neo_hookean.poissons_rato: expected"),
        (
            {"youngs_modulus": [1.0, 2.0, -3.0], "poissons_ratio": 0.3},
            "neo_hookean[2].youngs_modulus: expected a number",
        ),
        ({"shear_modulus": 0.0, "lame_lambda": 1.0}, "neo_hookean.shear_modulus: expected a number above 0 Pa, got 0"),
        ({"youngs_modulus": "1", "poissons_ratio": 0.3}, "neo_hookean.youngs_modulus: expected a number or an array"),
        ({"youngs_modulus": 1j, "poissons_ratio": 0.3}, "neo_hookean.youngs_modulus: expected a number or an array"),
        ({"youngs_modulus": [[1], [1, 2]], "poissons_ratio": 0.3}, "neo_hookean.youngs_modulus: expected a number or"),
        ({"youngs_modulus": [1.0, 2.0], "poissons_ratio": [0.3] * 3}, "neo_hookean: expected constants of one shape"),
        (
            {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "fibres": [1, 0, 0]},
            "neo_hookean.fibres: expected none: this law has no fibres",
        ),
    ],
)
def test_constants_out_of_bounds_are_refused_with_the_reason(constants, message):
    assert refusal_of("neo_hookean", **constants).startswith(message)


def test_a_refused_constant_says_what_to_do():
    text = refusal_of("neo_hookean", youngs_modulus=1.0, poissons_ratio=0.5)
    assert text.endswith("got 0.5; for a nearly incompressible solid use 0.495")
    assert 'did you mean "poissons_ratio"?' in refusal_of("neo_hookean", youngs_modulus=1.0, poissons_rato=0.3)


TISSUE = {"shear_modulus": 1.0, "bulk_modulus": 3.0, "fibre_modulus": 2.0, "fibre_stiffening": 0.5}


def test_fibres_are_directions_for_all_states_or_for_each():
    F = states(5)
    directions = np.random.default_rng(1).standard_normal((5, 2, 3))
    each = resilin.Material("holzapfel_gasser_ogden", **TISSUE, fibres=directions)
    np.testing.assert_allclose(np.linalg.norm(each.fibres, axis=-1), 1, rtol=1e-15)
    psi = each.energy_density(F)
    assert psi.shape == (5,)
    for i in range(5):
        one = resilin.Material("holzapfel_gasser_ogden", **TISSUE, fibres=3 * directions[i])
        np.testing.assert_allclose(one.energy_density(F[i]), psi[i], rtol=1e-14)
    pairs = np.broadcast_to(F, (2, 5, 3, 3))
    np.testing.assert_array_equal(each.first_piola_kirchhoff_stress(pairs)[1], each.first_piola_kirchhoff_stress(F))


def test_a_fibre_of_two_components_lies_in_the_plane():
    F = np.array([[1.2, 0.1], [0.0, 1.1]])
    flat = resilin.Material("holzapfel_gasser_ogden", **TISSUE, fibres=[3.0, 4.0])
    solid = resilin.Material("holzapfel_gasser_ogden", **TISSUE, fibres=[[0.6, 0.8, 0.0]])
    assert flat.energy_density(F) == solid.energy_density(F)
    none = resilin.Material("holzapfel_gasser_ogden", **TISSUE)
    assert none.energy_density(F) < solid.energy_density(F)


@pytest.mark.parametrize("fibres", [np.ones((3, 3)), np.ones(4), 1.0, [0, 0, 0], [np.nan, 0, 1]])
def test_what_is_no_fibre_is_refused(fibres):
    assert "holzapfel_gasser_ogden.fibres: expected directions" in refusal_of(
        "holzapfel_gasser_ogden", **TISSUE, fibres=fibres
    )


def test_free_constants_stand_beside_youngs_modulus():
    given = {"youngs_modulus": 1.0, "poissons_ratio": 0.25}
    assert resilin.Material("gent", **given).constants["limit"] == 97.2
    assert resilin.Material("gent", **given, limit=[30.0, 40.0]).constants["limit"].tolist() == [30.0, 40.0]
    assert refusal_of("gent", **given, limit=-1.0) == "gent.limit: expected a number above 0, got -1"
    assert refusal_of("gent", **given, shear_modulus=1.0).startswith("gent: expected")
