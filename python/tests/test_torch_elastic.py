"""The energy of a mesh at torch tensors: the numbers of arrays, followed by autograd."""

# ruff: noqa: N803, N806 - E, F and H are the letters of the field

import numpy as np
import pytest
from every_law import LAWS, beside_young_and_poisson, material_of, poissons_ratio_of

import resilin

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch
gradcheck, gradgradcheck = torch.autograd.gradcheck, torch.autograd.gradgradcheck

FOLLOWED = ["P1", "P2", "Q1"]  # by constants and in the quantities of points, too
ELEMENTS = [*FOLLOWED, "P2P0", "Q1P0"]


def mesh_for(element, dim):
    if dim == 2:
        return resilin.Mesh.rectangle((1, 1), (1, 2), pattern="quadrilaterals" if element[0] == "Q" else "uniform")
    return resilin.Mesh.box((1, 1, 1), (1, 1, 1), pattern="hexahedra" if element[0] == "Q" else "five")


def body_of(element, dim, material=None):
    material = material or resilin.Material("neo_hookean_isochoric", youngs_modulus=2.0, poissons_ratio=0.3)
    return resilin.Elastic(mesh_for(element, dim), material, element=element)


def state_of(body, dtype=torch.float64, seed=0):
    X = body.rest_positions
    return torch.from_numpy(X + 0.05 * np.random.default_rng(seed).uniform(-1, 1, X.shape)).to(dtype)


def number(value, shape=()):
    return torch.full(shape, value, dtype=torch.float64, requires_grad=True)


QUANTITIES = {
    "value": lambda body, x: body.value(x),
    "gradient": lambda body, x: body.gradient(x),
    "volume_ratios": lambda body, x: body.volume_ratios(x),
    "energy_densities": lambda body, x: body.energy_densities(x),
    "deformation_gradients": lambda body, x: body.deformation_gradients(x),
    "cauchy_stresses": lambda body, x: body.cauchy_stresses(x),
    "von_mises": lambda body, x: body.von_mises(x),
    "max_step": lambda body, x: body.max_step(x, -0.9 * x),
}


@pytest.mark.parametrize("dtype", [torch.float64, torch.float32])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("name", QUANTITIES)
def test_tensors_give_the_numbers_of_arrays(name, element, dim, dtype):
    body = body_of(element, dim)
    x = state_of(body, dtype)
    expected = np.asarray(QUANTITIES[name](body, x.numpy()))
    result = QUANTITIES[name](body, x)
    assert isinstance(result, torch.Tensor)
    assert result.dtype == dtype
    assert not result.requires_grad
    assert tuple(result.shape) == expected.shape
    # One rounding to the type of x, and sums of nine terms in another order.
    np.testing.assert_allclose(
        result.numpy(), expected, rtol=0, atol=32 * torch.finfo(dtype).eps * np.abs(expected).max()
    )


@pytest.mark.parametrize("projection", [None, "clamp", "absolute"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_the_hessian_is_a_sparse_tensor(element, projection):
    body = body_of(element, 3)
    x = state_of(body)
    H = body.hessian(x, projection)
    assert H.is_sparse
    expected = body.hessian(x.numpy(), projection)
    np.testing.assert_array_equal(H.to_dense().numpy(), expected.toarray())
    i, j, v = body.hessian(x, projection, as_triplets=True)
    again = torch.sparse_coo_tensor(torch.stack([i, j]), v, H.shape).to_dense()
    np.testing.assert_array_equal(again.numpy(), expected.toarray())


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("element", ELEMENTS)
def test_value_is_followed_twice_and_gradient_once(element, dim):
    body = body_of(element, dim)
    x = state_of(body).requires_grad_()
    assert gradcheck(body.value, (x,))
    assert gradcheck(body.gradient, (x,))
    assert gradgradcheck(body.value, (x,))
    (slope,) = torch.autograd.grad(body.value(x), x)
    np.testing.assert_array_equal(slope.numpy(), body.gradient(x.detach().numpy()))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("element", FOLLOWED)
@pytest.mark.parametrize(
    "name", ["volume_ratios", "energy_densities", "deformation_gradients", "cauchy_stresses", "von_mises"]
)
def test_quantities_of_points_are_followed(name, element, dim):
    body = body_of(element, dim)
    assert gradcheck(lambda x: QUANTITIES[name](body, x), (state_of(body).requires_grad_(),))


@pytest.mark.parametrize("name", ["energy_densities", "cauchy_stresses", "von_mises"])
@pytest.mark.parametrize("element", ["P2P0", "Q1P0"])
def test_pressures_of_cells_are_not_followed_and_say_so(name, element):
    body = body_of(element, 3)
    x = state_of(body).requires_grad_()
    with pytest.raises(resilin.InputError, match="pressures of mixed elements are not differentiable"):
        QUANTITIES[name](body, x)
    with torch.no_grad():
        assert not QUANTITIES[name](body, x).requires_grad


@pytest.mark.parametrize("shape", [(), "cells"])
@pytest.mark.parametrize("element", FOLLOWED)
@pytest.mark.parametrize("law", LAWS)
def test_constants_are_followed(law, element, shape):
    mesh = mesh_for(element, 3)
    count = () if shape == () else (len(mesh.cells),)
    only = resilin.laws()[law].only_poissons_ratio
    nu = number(0.3, count) if only is None else only

    def body(E, nu):
        others = beside_young_and_poisson(law, 2.0)
        return resilin.Elastic(mesh, resilin.Material(law, youngs_modulus=E, poissons_ratio=nu, **others), element)

    x, E = state_of(body(2.0, poissons_ratio_of(law, 0.3))).requires_grad_(), number(2.0, count)
    assert gradcheck(lambda x, E, nu: body(E, nu).value(x), (x, E, nu))
    assert gradcheck(lambda E, nu: body(E, nu).gradient(x.detach()), (E, nu))
    # The same numbers as a body of numbers.
    plain = body(2.0, poissons_ratio_of(law, 0.3))
    array = x.detach().numpy()
    assert float(body(E, nu).value(x).detach()) == pytest.approx(plain.value(array), rel=1e-12)
    scale = np.abs(plain.gradient(array)).max()
    np.testing.assert_allclose(body(E, nu).gradient(x).detach().numpy(), plain.gradient(array), atol=1e-12 * scale)


def test_value_is_followed_twice_by_state_and_constants_together():
    mesh = mesh_for("P2", 2)
    x = state_of(body_of("P2", 2)).requires_grad_()

    def value(x, E, nu):
        return resilin.Elastic(mesh, resilin.Material("yeoh", youngs_modulus=E, poissons_ratio=nu), "P2").value(x)

    assert gradgradcheck(value, (x, number(2.0), number(0.3)))


def test_an_optimiser_finds_the_modulus_of_a_body():
    """Constants that change in place are those of the next call, for all that a body gives."""
    mesh = resilin.Mesh.box((1, 1, 1), (2, 1, 1))
    truth = resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=3.0, poissons_ratio=0.3))
    x = torch.from_numpy(mesh.positions * [1.2, 0.95, 0.95])
    measured = truth.gradient(x)
    E = number(1.0)
    body = resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=E, poissons_ratio=0.3))
    optimiser = torch.optim.Adam([E], lr=0.1)
    for _ in range(300):
        optimiser.zero_grad()
        ((body.gradient(x) - measured) ** 2).sum().backward()
        optimiser.step()
    assert float(E.detach()) == pytest.approx(3, rel=1e-3)
    with torch.no_grad():
        now = resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=float(E), poissons_ratio=0.3))
        assert float(body.value(x)) == now.value(x.numpy())
        np.testing.assert_array_equal(body.hessian(x).to_dense().numpy(), now.hessian(x.numpy()).toarray())


def test_forward_mode_agrees_with_reverse():
    body = body_of("P2P0", 3)
    x, p = state_of(body), state_of(body, seed=1)
    with torch.autograd.forward_ad.dual_level():
        dual = torch.autograd.forward_ad.make_dual(x, p)
        rate = torch.autograd.forward_ad.unpack_dual(body.value(dual)).tangent
        gradient_rate = torch.autograd.forward_ad.unpack_dual(body.gradient(dual)).tangent
    assert float(rate) == pytest.approx(float((body.gradient(x) * p).sum()), rel=1e-12)
    expected = body.hessian(x.numpy()) @ p.numpy().ravel()
    np.testing.assert_allclose(gradient_rate.numpy().ravel(), expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max())


class TestRefusals:
    def refusal_of(self, action, *arguments, **options):
        with pytest.raises(resilin.InputError) as refusal:
            action(*arguments, **options)
        assert "\n" not in str(refusal.value)
        return str(refusal.value)

    def test_wrong_tensors(self):
        body = body_of("P1", 3)
        x = state_of(body)
        assert "expected a tensor (" in self.refusal_of(body.value, x[:-1])
        assert "complex" in self.refusal_of(body.value, x.to(torch.complex128))
        assert "a dense tensor" in self.refusal_of(body.gradient, x.to_sparse())
        assert "got a tensor" not in self.refusal_of(body.max_step, x, x[:1])
        whole = torch.ones(x.shape, dtype=torch.int64)
        assert body.gradient(whole).dtype == torch.float64

    def test_the_hessian_is_not_differentiated(self):
        body = body_of("P1", 3)
        x = state_of(body).requires_grad_()
        assert "under torch.no_grad()" in self.refusal_of(body.hessian, x)
        with torch.no_grad():
            assert body.hessian(x).is_sparse
        third = torch.autograd.grad(body.gradient(x).sum(), x, create_graph=True)[0]
        with pytest.raises(RuntimeError, match="third derivatives of the energy are not available"):
            third.sum().backward()

    def test_arrays_where_a_constant_is_followed(self):
        body = body_of("P1", 3, resilin.Material("neo_hookean", youngs_modulus=number(2.0), poissons_ratio=0.3))
        text = self.refusal_of(body.value, body.rest_positions)
        assert text.endswith("youngs_modulus requires grad, got a numpy array; use torch.from_numpy(x)")

    @pytest.mark.parametrize("element", ["P2P0", "Q1P0"])
    def test_constants_of_elements_with_a_mean_volume(self, element):
        material = resilin.Material("neo_hookean_isochoric", youngs_modulus=number(2.0), poissons_ratio=0.3)
        text = self.refusal_of(body_of, element, 3, material)
        assert text.startswith(
            "material.youngs_modulus: expected numbers or arrays, because the element is mixed (P2P0, Q1P0)"
        )

    def test_constants_that_do_not_go_with_the_cells(self):
        material = resilin.Material("neo_hookean", youngs_modulus=number(2.0, (7,)), poissons_ratio=0.3)
        assert "one for each of" in self.refusal_of(body_of, "P1", 3, material)


def test_fibres_by_cell_are_those_of_the_points():
    mesh = mesh_for("P2", 3)
    fibres = np.random.default_rng(2).standard_normal((len(mesh.cells), 1, 3))
    x = state_of(body_of("P2", 3))
    plain = material_of("holzapfel_gasser_ogden", youngs_modulus=2.0).constants
    constants = {name: value for name, value in plain.items()}
    of_numbers = resilin.Elastic(mesh, resilin.Material("holzapfel_gasser_ogden", fibres=fibres, **constants), "P2")
    followed = {**constants, "fibre_modulus": number(constants["fibre_modulus"])}
    of_tensors = resilin.Elastic(mesh, resilin.Material("holzapfel_gasser_ogden", fibres=fibres, **followed), "P2")
    assert float(of_tensors.value(x).detach()) == pytest.approx(of_numbers.value(x.numpy()), rel=1e-12)
