"""Bodies with fibres: their energies by themselves, in scenes, and when a material is exchanged."""

# ruff: noqa: N803 - X is the letter of the field

import numpy as np
import pytest

import resilin

ALONG_X, ALONG_Y = [1, 0, 0], [0, 1, 0]
CROSSED = [[0.8, 0.6, 0], [0.8, -0.6, 0]]


def tissue(fibres, fibre_modulus=2e5):
    return resilin.Material(
        "holzapfel_gasser_ogden",
        youngs_modulus=1e5,
        poissons_ratio=0.3,
        fibre_modulus=fibre_modulus,
        fibre_stiffening=0.8,
        fibres=fibres,
    )


def block():
    return resilin.Mesh.box((1, 1, 1), (2, 2, 2))


def deformed(X, seed=0):
    """Stretched along x, and shaken so that no two cells are alike."""
    return X @ np.diag([1.2, 0.95, 1.0]) + 0.02 * np.random.default_rng(seed).standard_normal(X.shape)


def directions_of_cells(num_cells, families=2, dim=3):
    directions = np.random.default_rng(1).standard_normal((num_cells, families, dim))
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def bar(material, **simulation):
    """A bar pulled by a tenth of its length."""
    return {
        "simulation": {"kind": "static", **simulation},
        "body": [
            {
                "name": "bar",
                "element": "P1",
                "mesh": {"box": {"size": [1, 0.3, 0.3], "cells": [4, 2, 2]}},
                "material": {"law": material},
            }
        ],
        "fix": [
            {"name": "wall", "where": {"group": "x_min"}},
            {"name": "hand", "where": {"group": "x_max"}, "displacement": [0.1, 0, 0]},
        ],
    }


def pull(material):
    """Force on the pulled end [N]."""
    return resilin.run(bar(material)).report["frames"][-1]["reactions"]["hand"][0]


def test_a_bar_is_stiffer_along_its_fibres():
    across, along = pull(tissue([ALONG_Y])), pull(tissue([ALONG_X]))
    assert across > 0
    assert along > 1.5 * across
    # Two crossed families bear less than both along the bar, more than both across it.
    assert pull(tissue([ALONG_Y, ALONG_Y])) < pull(tissue(CROSSED)) < pull(tissue([ALONG_X, ALONG_X]))


@pytest.mark.parametrize("fibres", [CROSSED, "by cell"])
def test_the_energy_of_a_body_is_that_of_its_material(fibres):
    mesh = block()
    material = tissue(directions_of_cells(len(mesh.cells)) if isinstance(fibres, str) else fibres)
    body = resilin.Elastic(mesh, material)
    x = deformed(mesh.positions)
    psi = material.energy_density(body.deformation_gradients(x))
    np.testing.assert_allclose(body.energy_densities(x), psi, rtol=1e-12)
    assert body.value(x) == pytest.approx(psi @ body.rest_volumes, rel=1e-12)


def test_fibres_of_a_plane_body_may_leave_the_plane():
    mesh = resilin.Mesh.rectangle((1, 1), (3, 3))
    for fibres in ([[0.6, 0.8]], [[0.6, 0.0, 0.8]], directions_of_cells(18, families=1)):
        material = tissue(fibres)
        body = resilin.Elastic(mesh, material)
        x = deformed(np.pad(mesh.positions, ((0, 0), (0, 1))))[:, :2]
        psi = material.energy_density(body.deformation_gradients(x))
        assert body.value(x) == pytest.approx(psi @ body.rest_volumes, rel=1e-12)


@pytest.mark.parametrize("fibres", [CROSSED, "by cell"])
def test_gradient_and_hessian_are_slopes(fibres):
    mesh = block()
    material = tissue(directions_of_cells(len(mesh.cells)) if isinstance(fibres, str) else fibres)
    body = resilin.Elastic(mesh, material)
    x, h = deformed(mesh.positions), 1e-6
    p = np.random.default_rng(2).standard_normal(x.shape)
    slope = (body.value(x + h * p) - body.value(x - h * p)) / (2 * h)
    assert slope == pytest.approx(np.sum(body.gradient(x) * p), rel=1e-6)  # error h^2 and round-off / h
    along = (body.gradient(x + h * p) - body.gradient(x - h * p)).ravel() / (2 * h)
    expected = body.hessian(x) @ p.ravel()
    np.testing.assert_allclose(along, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


def test_fibres_by_cell_that_are_alike_are_fibres_given_once():
    mesh = block()
    x = deformed(mesh.positions)
    once = resilin.Elastic(mesh, tissue(CROSSED))
    by_cell = resilin.Elastic(mesh, tissue(np.broadcast_to(CROSSED, (len(mesh.cells), 2, 3))))
    assert once.value(x) == by_cell.value(x)
    np.testing.assert_array_equal(once.gradient(x), by_cell.gradient(x))


@pytest.mark.parametrize("fibres", [CROSSED, "by cell"])
def test_a_scene_with_a_material_is_a_scene_with_its_directions(fibres):
    given = directions_of_cells(4 * 2 * 2 * 6) if isinstance(fibres, str) else np.array(fibres)
    material = tissue(given)
    by_material = resilin.run(bar(material))
    scene = bar("holzapfel_gasser_ogden")
    families = list(np.moveaxis(given, -2, 0))  # each one direction, or one for each cell
    scene["body"][0]["material"] |= {**material.constants, "fibres": families}
    # Directions brought to length 1 a second time may differ in their last bit.
    np.testing.assert_allclose(by_material.positions, resilin.run(scene).positions, rtol=0, atol=1e-14)
    assert np.ptp(by_material.positions[-1][:, 0]) == pytest.approx(1.1, rel=1e-9)


def test_a_simulation_and_an_elastic_body_agree():
    material = tissue(directions_of_cells(4 * 2 * 2 * 6))
    result = resilin.run(bar(material))
    body = resilin.Elastic(resilin.Mesh.box((1, 0.3, 0.3), (4, 2, 2)), material)
    energy = result.report["frames"][-1]["energy"]["elastic"]
    assert body.value(result.positions[-1]) == pytest.approx(energy, rel=1e-12)


def test_a_plane_scene_takes_fibres_in_its_plane():
    scene = bar(tissue([[0.6, 0.8]]), dimension=2)
    scene["body"][0]["mesh"] = resilin.Mesh.rectangle((1, 0.3), (4, 2))
    scene["fix"][1]["displacement"] = [0.1, 0]
    result = resilin.run(scene)
    assert result.report["status"] == "done"
    scene["body"][0]["material"]["law"] = tissue([[0.6, 0.0, 0.8]])
    with pytest.raises(resilin.InputError, match="material.fibres: expected directions in the plane"):
        resilin.run(scene)


@pytest.mark.parametrize("fibres", [[ALONG_Y], "by cell"])
def test_a_material_with_fibres_comes_and_goes(fibres):
    plain = resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.3)
    other = tissue(directions_of_cells(4 * 2 * 2 * 6) if isinstance(fibres, str) else fibres)
    simulation = resilin.Simulation(bar(tissue([ALONG_X])))
    simulation.step()
    x = simulation.positions
    energies = []
    for material in (plain, other, tissue([ALONG_X])):
        simulation.set_material("bar", material)
        np.testing.assert_array_equal(simulation.positions, x)
        body = resilin.Elastic(resilin.Mesh.box((1, 0.3, 0.3), (4, 2, 2)), material)
        energies.append(simulation.frame["energy"]["elastic"])
        assert energies[-1] == pytest.approx(body.value(x), rel=1e-12)
    assert len(set(energies)) == 3


def refusal_of(call, *arguments):
    with pytest.raises(resilin.InputError) as caught:
        call(*arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_fibres_that_do_not_fit_are_refused():
    mesh = block()
    for material in (tissue(None), tissue(np.ones((3, 1, 3))), tissue(np.ones((2, 24, 1, 3)))):
        assert refusal_of(resilin.Elastic, mesh, material).startswith("material.fibres: expected")
        assert "material.fibres" in refusal_of(resilin.run, bar(material))
        simulation = resilin.Simulation(bar(tissue([ALONG_X])))
        assert refusal_of(simulation.set_material, "bar", material).startswith("material.fibres: expected")


def test_what_stands_in_a_material_and_beside_it_is_refused():
    scene = bar(tissue([ALONG_X]))
    scene["body"][0]["material"]["fibres"] = [ALONG_Y]
    assert "material.fibres: expected a value in the Material or beside it" in refusal_of(resilin.run, scene)
    scene = bar(tissue(None))  # the material leaves them open
    scene["body"][0]["material"]["fibres"] = [ALONG_X]
    by_scene = resilin.run(scene).positions
    np.testing.assert_array_equal(by_scene, resilin.run(bar(tissue([ALONG_X]))).positions)
