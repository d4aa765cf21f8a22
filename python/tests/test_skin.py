"""Skins: fine points carried by coarse cells."""

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
