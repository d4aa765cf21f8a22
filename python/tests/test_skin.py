"""Skins: fine points carried by coarse cells."""

import pickle

import numpy as np
import pytest

import resilin

AFFINE = np.array([[1.2, 0.3, -0.1], [0.1, 0.8, 0.2], [0, -0.4, 1.1]])


def fine_surface():
    box = resilin.Mesh.box(size=(1, 0.25, 0.25), cells=(8, 4, 4))
    used, triangles = np.unique(box.cells_by_kind["triangle"], return_inverse=True)
    return resilin.Mesh(box.positions[used], {"triangle": triangles.reshape(-1, 3).astype(np.int32)})


@pytest.mark.parametrize("pattern", ["kuhn6", "hexahedra"])
def test_embedding_carries_affine_maps_inside_and_outside(pattern):
    mesh = resilin.Mesh.box(size=(1, 1, 1), cells=(3, 3, 3), pattern=pattern)
    points = np.random.default_rng(1).uniform(-0.5, 1.5, (200, 3))
    weights = resilin.embed(mesh, points)
    assert weights.shape == (200, len(mesh.positions))
    np.testing.assert_allclose(weights.sum(axis=1), 1, rtol=1e-12)
    np.testing.assert_allclose(weights @ (mesh.positions @ AFFINE.T + 3), points @ AFFINE.T + 3, atol=1e-12)


def test_embedding_in_the_plane():
    mesh = resilin.Mesh.rectangle(size=(1, 1), cells=(3, 3))
    points = np.array([[0.5, 0.4], [-1, 2]])
    np.testing.assert_allclose(resilin.embed(mesh, points) @ mesh.positions, points, atol=1e-14)


def test_embedding_refuses_what_does_not_fit():
    mesh = resilin.Mesh.box(size=(1, 1, 1), cells=(1, 1, 1))
    with pytest.raises(resilin.InputError, match=r"points: expected an array \(V, 3\)"):
        resilin.embed(mesh, np.zeros((4, 2)))
    with pytest.raises(resilin.InputError, match="finite"):
        resilin.embed(mesh, np.full((1, 3), np.nan))


def scene_with_skin(**body):
    return {
        "simulation": {"kind": "dynamic", "gravity": [0, 0, -9.81], "time_step": 0.02, "end_time": 0.2},
        "body": [
            {
                "name": "bar",
                "element": "P1",
                "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [4, 1, 1]}},
                **body,
            }
        ],
        "fix": [{"where": {"plane": {"axis": "x", "at": 0}}}],
    }


def test_simulation_moves_the_skin_with_its_weights():
    simulation = resilin.Simulation(scene_with_skin(skin=fine_surface()))
    rest = simulation.skin_positions("bar")
    simulation.step()
    coarse = resilin.Mesh(simulation.rest_positions, simulation.cells("bar"))
    expected = resilin.embed(coarse, rest) @ simulation.positions
    np.testing.assert_allclose(simulation.skin_positions("bar"), expected, atol=1e-13)
    assert simulation.skin_triangles("bar").max() == len(rest) - 1
    assert np.abs(expected - rest).max() > 1e-4


def test_body_without_a_skin_says_so():
    simulation = resilin.Simulation(scene_with_skin())
    with pytest.raises(resilin.InputError, match="expected a skin, got none"):
        simulation.skin_positions("bar")


@pytest.mark.parametrize("distance", [0, 1e4, 1e8])
def test_places_are_those_of_the_scene_wherever_it_stands(distance, tmp_path):
    """A far scene is computed in coordinates of its own; what comes out does not show that."""
    place = np.array([1, -2, 0.5]) * distance

    def simulate(place):
        scene = scene_with_skin(skin=fine_surface(), translate=list(place))
        scene["fix"][0]["where"] = {"group": "x_min"}
        simulation = resilin.Simulation(scene)
        return simulation, simulation.run(out=tmp_path / "out")

    (near, near_result), (far, result) = simulate(0 * place), simulate(place)
    rounding = 1e-12 + 4e-16 * distance
    for there, here in [
        (far.rest_positions, near.rest_positions),
        (far.positions, near.positions),
        (far.skin_positions("bar"), near.skin_positions("bar")),
        (result.positions, near_result.positions),
        (pickle.loads(pickle.dumps(result)).positions, near_result.positions),
    ]:
        np.testing.assert_allclose(there, here + place, rtol=0, atol=rounding)
    np.testing.assert_allclose(result.fields["displacement"], near_result.fields["displacement"], rtol=0, atol=1e-12)
    frame = resilin.Mesh.read(tmp_path / "out" / "frames" / "0010.vtu")
    np.testing.assert_allclose(frame.positions, result.positions[-1], rtol=0, atol=rounding)
    far.set_material("bar", resilin.Material("neo_hookean", youngs_modulus=2e6, poissons_ratio=0.4))
    np.testing.assert_array_equal(far.positions, result.positions[-1])
