"""Material inside the transforms of torch.func."""

# ruff: noqa: N803, N806 - E, F, P and A are the letters of the field

import numpy as np
import pytest

import resilin

torch = pytest.importorskip("torch")
pytestmark = [
    pytest.mark.torch,
    pytest.mark.skipif(not hasattr(torch, "func"), reason="torch.func is there from torch 2.0"),
]

MATERIAL = resilin.Material("neo_hookean", youngs_modulus=2.0, poissons_ratio=0.3)


def states(dim=3, count=4):
    noise = np.random.default_rng(0).uniform(-1, 1, (count, dim, dim))
    return torch.from_numpy(np.eye(dim) + 0.3 * noise / dim)


def assert_same(got, expected):
    scale = expected.abs().max()
    assert (got - expected).abs().max() <= 64 * torch.finfo(expected.dtype).eps * scale


@pytest.mark.parametrize("dim", [2, 3])
def test_vmap_over_states_is_the_batch(dim):
    F = states(dim)
    for method in (MATERIAL.energy_density, MATERIAL.first_piola_kirchhoff_stress, MATERIAL.stress_tangent):
        assert_same(torch.func.vmap(method)(F), method(F))
        assert_same(torch.func.vmap(method, in_dims=2, out_dims=0)(F.movedim(0, 2)), method(F))
    pairs = F.reshape(2, 2, dim, dim)
    assert_same(torch.func.vmap(torch.func.vmap(MATERIAL.energy_density))(pairs), MATERIAL.energy_density(pairs))


def test_vmap_over_cells():
    F, volume = states(), torch.rand(4, dtype=torch.float64)
    Dm_inv = states() - 0.1
    assert_same(torch.func.vmap(MATERIAL.elastic_forces)(F, Dm_inv, volume), MATERIAL.elastic_forces(F, Dm_inv, volume))


def test_vmap_over_constants():
    F, young = states(), torch.tensor([1.0, 2.0, 5.0], dtype=torch.float64)

    def energy(E, F):
        return resilin.Material("neo_hookean", youngs_modulus=E, poissons_ratio=0.3).energy_density(F)

    expected = young[:, None] / 2 * MATERIAL.energy_density(F)
    assert_same(torch.func.vmap(energy, (0, None))(young, F), expected)
    assert_same(torch.func.vmap(torch.func.vmap(energy, (None, 0)), (0, None))(young, F), expected)
    assert_same(torch.func.vmap(energy)(young, F[:3]), torch.diagonal(expected))
    slopes = torch.func.vmap(torch.func.grad(lambda E: energy(E, F).sum()))(young)
    assert_same(slopes, (MATERIAL.energy_density(F).sum() / 2).expand(3))


def test_derivatives_per_state():
    F, vmap = states(), torch.func.vmap
    P, A = MATERIAL.first_piola_kirchhoff_stress(F), MATERIAL.stress_tangent(F)
    energy, stress = MATERIAL.energy_density, MATERIAL.first_piola_kirchhoff_stress
    assert_same(vmap(torch.func.grad(energy))(F), P)
    assert_same(vmap(torch.func.jacrev(stress))(F), A)
    assert_same(vmap(torch.func.jacfwd(stress))(F), A)
    assert_same(vmap(torch.func.hessian(energy))(F), A)
    assert_same(vmap(torch.func.jacrev(torch.func.jacrev(energy)))(F), A)
    _, change = torch.func.jvp(stress, (F,), (F,))
    assert_same(change, torch.einsum("nijkl,nkl->nij", A, F))


def test_third_derivatives_are_refused():
    with pytest.raises(RuntimeError, match="third derivatives of the energy are not available"):
        torch.func.hessian(lambda F: MATERIAL.first_piola_kirchhoff_stress(F).sum())(states()[0])


def test_transforms_pass_through_a_body():
    mesh = resilin.Mesh.rectangle((1, 1), (1, 2))
    body = resilin.Elastic(mesh, MATERIAL, element="P1")
    x = torch.from_numpy(body.rest_positions * 1.1)
    np.testing.assert_array_equal(torch.func.grad(body.value)(x).numpy(), body.gradient(x.numpy()))
    H = torch.func.hessian(body.value)(x).reshape(x.numel(), x.numel()).numpy()
    expected = body.hessian(x.numpy()).toarray()
    np.testing.assert_allclose(H, expected, atol=1e-12 * np.abs(expected).max())
    several = torch.stack([x, 1.1 * x, 0.9 * x])
    energies = torch.func.vmap(body.value)(several).numpy()
    np.testing.assert_array_equal(energies, [body.value(state.numpy()) for state in several])

    def energy(E):
        return resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=E, poissons_ratio=0.3)).value(x)

    assert float(torch.func.grad(energy)(torch.tensor(2.0, dtype=torch.float64))) > 0
