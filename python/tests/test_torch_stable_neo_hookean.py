"""The drop-in class: its names, and its numbers against the formula written in torch and derived by autograd."""

# ruff: noqa: N802, N803, N806 - E, F, P, I and J are the letters of the field

import numpy as np
import pytest

import resilin

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from resilin.torch import StableNeoHookean  # noqa: E402 - after torch is known to be there


def formula(F, mu, lam):
    """The energy as its users write it, without clamps."""
    first_invariant = (F * F).sum((-2, -1)) + (3 - F.shape[-1])
    J = torch.det(F)
    return mu / 2 * (first_invariant - 3) - mu * torch.log(J) + lam / 2 * (J - 1) ** 2


def states(dim, count=200):
    """J between 0.3 and 3, rotated."""
    rng = np.random.default_rng(3)
    F = np.eye(dim) + 0.5 * rng.uniform(-1, 1, (count, dim, dim))
    turn, _ = np.linalg.qr(rng.standard_normal((count, dim, dim)))
    turn[..., 0] *= np.sign(np.linalg.det(turn))[:, None]
    F = turn @ F
    J = np.linalg.det(F)
    return torch.from_numpy(F[(J > 0.3) & (J < 3)])


@pytest.mark.parametrize("young", [1.0, 1e6])
@pytest.mark.parametrize("dim", [2, 3])
def test_energy_stress_tangent_and_forces_equal_the_formula_by_autograd(dim, young):
    material = StableNeoHookean(youngs_modulus=young, poissons_ratio=0.45)
    F = states(dim).requires_grad_()
    psi = formula(F, material.mu, material.lam)
    (P,) = torch.autograd.grad(psi.sum(), F, create_graph=True)
    rows = [torch.autograd.grad(P[:, i, j].sum(), F, retain_graph=True)[0] for i, j in np.ndindex(dim, dim)]
    A = torch.stack(rows, 1).reshape(-1, dim, dim, dim, dim)
    Dm_inv, volume = torch.linalg.inv(states(dim).flip(0)), torch.linspace(0.5, 2, len(F), dtype=torch.float64)
    H = -volume[:, None, None] * (P @ Dm_inv.transpose(1, 2))
    forces = torch.stack([-H.sum(-1), *H.unbind(-1)], 1)

    F = F.detach()
    results = [
        (material.energy_density(F), psi),
        (material.first_piola_kirchhoff_stress(F), P),
        (material.first_piola_kirchhoff_stress_analytic(F), P),
        (material.compute_elastic_forces(F, Dm_inv, volume), forces),
        (resilin.Material("neo_hookean_quadratic", youngs_modulus=young, poissons_ratio=0.45).stress_tangent(F), A),
    ]
    for got, expected in results:
        expected = expected.detach()
        assert got.shape == expected.shape
        assert (got - expected).abs().max() <= 1e-12 * expected.abs().max()


def test_defaults_and_attributes_are_those_of_the_replaced_class():
    material = StableNeoHookean()
    assert (material.E, material.nu) == (1e6, 0.45)
    assert material.mu == pytest.approx(1e6 / 2.9, rel=1e-15)
    assert material.lam == pytest.approx(0.45e6 / (1.45 * 0.1), rel=1e-13)  # 1 - 2 nu loses a digit
    with pytest.raises(AttributeError):
        material.mu = 1.0


def test_stress_is_the_slope_of_the_energy_where_the_replaced_class_clamped():
    F = torch.diag(torch.tensor([0.2, 4.0, 5.0], dtype=torch.float64))[None].requires_grad_()  # J = 4
    material = StableNeoHookean(1e6, 0.45)
    (slope,) = torch.autograd.grad(formula(F, material.mu, material.lam).sum(), F)
    for method in (material.first_piola_kirchhoff_stress, material.first_piola_kirchhoff_stress_analytic):
        assert (method(F.detach()) - slope).abs().max() <= 1e-12 * slope.abs().max()
    assert slope.norm() > 1e6  # where the replaced class scaled the stress down


def test_an_inverted_element_is_infinite_and_alone():
    F = torch.eye(3, dtype=torch.float64).repeat(3, 1, 1)
    F[1, 0, 0] = -1
    psi, P = StableNeoHookean().energy_density(F), StableNeoHookean().first_piola_kirchhoff_stress(F)
    assert psi.tolist() == [0, np.inf, 0]
    assert torch.isnan(P[1]).any()
    assert not P[[0, 2]].any()


def test_graph_of_F_and_of_the_constants_is_kept():
    F, young = states(3).requires_grad_(), torch.tensor(1.0, dtype=torch.float64, requires_grad=True)
    material = StableNeoHookean(young, 0.45)
    material.compute_elastic_forces(F, torch.eye(3).double().expand(len(F), 3, 3), torch.ones(len(F)).double())[
        0, 0, 0
    ].backward()
    assert F.grad[0].any()
    assert not F.grad[1:].any()
    assert young.grad.abs() > 0
