"""Material at torch tensors: the same numbers, and derivatives by autograd."""

# ruff: noqa: N803, N806 - E, F, P and A are the letters of the field

import numpy as np
import pytest
from every_law import LAWS, beside_young_and_poisson, material_of, poissons_ratio_of

import resilin

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch
gradcheck, gradgradcheck = torch.autograd.gradcheck, torch.autograd.gradgradcheck


def states(dim, count=4, strain=0.3, dtype=torch.float64):
    noise = np.random.default_rng(0).uniform(-1, 1, (count, dim, dim))
    return torch.from_numpy(np.eye(dim) + strain * noise / dim).to(dtype)


def cells(dim, count=4):
    rng = np.random.default_rng(1)
    Dm_inv = np.eye(dim) + 0.2 * rng.uniform(-1, 1, (count, dim, dim))
    return torch.from_numpy(Dm_inv), torch.from_numpy(rng.uniform(0.5, 1, count))


def number(value, shape=()):
    return torch.full(shape, value, dtype=torch.float64, requires_grad=True)


def calls_of(material, F, *of_cells):
    """Each method on the same arguments."""
    return {
        "energy": material.energy_density(F),
        "stress": material.first_piola_kirchhoff_stress(F),
        "tangent": material.stress_tangent(F),
        "clamped tangent": material.stress_tangent(F, "clamp"),
        "forces": material.elastic_forces(F, *of_cells),
        "Cauchy stress": material.cauchy_stress(F),
    }


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("dtype", [torch.float64, torch.float32])
@pytest.mark.parametrize("law", LAWS)
def test_tensors_give_the_numbers_of_arrays(law, dtype, dim):
    material = material_of(law)
    arguments = [tensor.to(dtype) for tensor in (states(dim), *cells(dim))]
    expected = calls_of(material, *(tensor.numpy() for tensor in arguments))
    followed = calls_of(material, arguments[0].clone().requires_grad_(), *arguments[1:])
    with torch.no_grad():
        unfollowed = calls_of(material, arguments[0].clone().requires_grad_(), *arguments[1:])
    for name, result in calls_of(material, *arguments).items():
        assert result.dtype == dtype
        assert not result.requires_grad
        np.testing.assert_array_equal(result.numpy(), expected[name], err_msg=name)
        np.testing.assert_array_equal(unfollowed[name].numpy(), expected[name], err_msg=name)
        assert followed[name].requires_grad
        scale, epsilon = np.abs(expected[name]).max(), torch.finfo(dtype).eps
        assert np.abs(followed[name].detach().numpy() - expected[name]).max() <= 64 * epsilon * scale


def functions_of(law):
    def material(E, nu):
        return resilin.Material(law, youngs_modulus=E, poissons_ratio=nu, **beside_young_and_poisson(law, 2.0))

    def energy(F, E, nu):
        return material(E, nu).energy_density(F)

    def stress(F, E, nu):
        return material(E, nu).first_piola_kirchhoff_stress(F)

    def forces(F, E, nu, Dm_inv, volume):
        return material(E, nu).elastic_forces(F, Dm_inv, volume)

    return energy, stress, forces


@pytest.mark.parametrize("shape", [(), (2,)])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("law", LAWS)
def test_autograd_agrees_with_differences(law, dim, shape):
    energy, stress, forces = functions_of(law)
    F, E = states(dim, 2).requires_grad_(), number(2.0, shape)
    only = resilin.laws()[law].only_poissons_ratio
    nu = number(0.3, shape) if only is None else only
    Dm_inv, volume = (tensor.requires_grad_() for tensor in cells(dim, 2))
    assert gradcheck(energy, (F, E, nu))
    assert gradcheck(stress, (F, E, nu))
    assert gradcheck(forces, (F, E, nu, Dm_inv, volume))
    assert gradgradcheck(energy, (F, E, nu))


@pytest.mark.parametrize("law", LAWS)
def test_autograd_agrees_with_differences_of_the_laws_own_constants(law):
    F = states(3, 2).requires_grad_()
    material = material_of(law, youngs_modulus=2.0)
    values = material.constants
    constants = [number(value or 0.1) for value in values.values()]

    def energy(F, *constants):
        given = dict(zip(values, constants, strict=True))
        return resilin.Material(law, **given, fibres=material.fibres).energy_density(F)

    def stress(F, *constants):
        given = dict(zip(values, constants, strict=True))
        return resilin.Material(law, **given, fibres=material.fibres).first_piola_kirchhoff_stress(F)

    assert gradcheck(energy, (F, *constants))
    assert gradcheck(stress, (F, *constants))
    assert gradgradcheck(energy, (F, *constants))


@pytest.mark.parametrize("law", LAWS)
def test_own_constants_of_tensors_are_those_of_numbers(law):
    for young, poisson in ((1e6, 0.45), (3.0, -0.2), (2.0, 0.0)):
        others = {"poissons_ratio": poissons_ratio_of(law, poisson), **beside_young_and_poisson(law, young)}
        plain = resilin.Material(law, youngs_modulus=young, **others).constants
        followed = resilin.Material(law, youngs_modulus=number(young), **others).constants
        assert list(followed) == list(plain)
        scale = max(abs(value) for value in plain.values())
        for name, value in plain.items():
            assert abs(followed[name].item() - value) <= 1e-14 * scale, name


def test_forward_mode_agrees_with_differences():
    energy, stress, forces = functions_of("neo_hookean")
    F, E, nu = states(3).requires_grad_(), number(2.0, (4,)), number(0.3)
    assert gradcheck(energy, (F, E, nu), check_forward_ad=True)
    assert gradcheck(stress, (F, E, nu), check_forward_ad=True)
    assert gradcheck(forces, (F, E, nu, *cells(3)), check_forward_ad=True)


def test_stress_twice_differentiated_says_that_it_cannot():
    F = states(3).requires_grad_()
    material = resilin.Material("neo_hookean", youngs_modulus=2.0, poissons_ratio=0.3)
    (once,) = torch.autograd.grad(material.first_piola_kirchhoff_stress(F).sum(), F, create_graph=True)
    with pytest.raises(RuntimeError, match="third derivatives of the energy are not available") as refusal:
        torch.autograd.grad(once.sum(), F)
    assert "\n" not in str(refusal.value)


def test_a_gradient_in_single_precision_keeps_its_type():
    F, E = states(3, dtype=torch.float32).requires_grad_(), torch.tensor(2.0, requires_grad=True)
    material = resilin.Material("neo_hookean", youngs_modulus=E, poissons_ratio=0.3)
    material.energy_density(F).sum().backward()
    assert F.grad.dtype == E.grad.dtype == torch.float32
    fixed = resilin.Material("neo_hookean", youngs_modulus=2.0, poissons_ratio=0.3)
    np.testing.assert_allclose(F.grad.numpy(), fixed.first_piola_kirchhoff_stress(F.detach()).numpy(), rtol=1e-6)
    np.testing.assert_allclose(2 * float(E.grad), float(fixed.energy_density(F.detach()).sum()), rtol=1e-6)


def test_an_optimiser_finds_youngs_modulus_again():
    F = states(3)
    target = resilin.Material("stable_neo_hookean", youngs_modulus=3.0, poissons_ratio=0.3).energy_density(F)
    E = torch.nn.Parameter(torch.tensor(1.0, dtype=torch.float64))
    material = resilin.Material("stable_neo_hookean", youngs_modulus=E, poissons_ratio=0.3)
    optimiser = torch.optim.LBFGS([E], max_iter=50, tolerance_grad=1e-14, tolerance_change=1e-16)

    def loss():
        optimiser.zero_grad()
        value = ((material.energy_density(F) - target) ** 2).sum()
        value.backward()
        return value

    for _ in range(3):
        optimiser.step(loss)
    assert abs(float(E) - 3) < 1e-6


def test_a_tensor_that_left_its_bounds_is_refused_at_the_next_call():
    E = number(1.0)
    material = resilin.Material("neo_hookean", youngs_modulus=E, poissons_ratio=0.3)
    with torch.no_grad():
        E -= 2
    with pytest.raises(resilin.InputError, match="neo_hookean.youngs_modulus: expected a number above 0 Pa, got -1"):
        material.energy_density(states(3))


def test_memory_is_shared_not_copied():
    F = states(3)
    out = torch.empty(4, dtype=torch.float64)
    material = resilin.Material("neo_hookean", youngs_modulus=2.0, poissons_ratio=0.3)
    assert material.energy_density(F, out=out) is out
    np.testing.assert_array_equal(out.numpy(), material.energy_density(F.numpy()))


def test_views_strides_and_empty_batches():
    material = resilin.Material("neo_hookean", youngs_modulus=2.0, poissons_ratio=0.3)
    F = states(3)
    expected = material.energy_density(F)
    apart = torch.zeros(8, 3, 3, dtype=torch.float64)
    apart[::2] = F
    by_columns = F.transpose(1, 2).contiguous().transpose(1, 2)
    for view in (apart[::2], by_columns, F[:1].expand(4, 3, 3)):
        for tensor in (view, view.clone().requires_grad_()):
            np.testing.assert_array_equal(
                material.energy_density(tensor).detach().numpy(), material.energy_density(view.contiguous()).numpy()
            )
    assert material.energy_density(F[0]).shape == ()
    assert float(material.energy_density(F[0])) == float(expected[0])
    whole = torch.tensor([[2, 1], [0, 1]])
    assert float(material.energy_density(whole)) == float(material.energy_density(whole.double()))
    for empty in (torch.empty(0, 3, 3), torch.empty(2, 0, 2, 2, requires_grad=True)):
        assert material.energy_density(empty).shape == empty.shape[:-2]
        assert material.stress_tangent(empty).shape == empty.shape + empty.shape[-2:]


def test_constant_derivatives_are_followed():
    F, mu = states(3).requires_grad_(), number(2.0)
    material = resilin.Material("neo_hookean", shear_modulus=mu, lame_lambda=3.0)
    expected = resilin.Material("neo_hookean", shear_modulus=2.0, lame_lambda=3.0).constant_derivatives(
        F.detach().numpy()
    )
    derivatives = material.constant_derivatives(F)
    for name, pair in expected.items():
        for got, value in zip(derivatives[name], pair, strict=True):
            np.testing.assert_array_equal(got.detach().numpy(), value)
    (slope,) = torch.autograd.grad(derivatives["shear_modulus"][0].sum(), F)
    np.testing.assert_array_equal(slope.numpy(), expected["shear_modulus"][1])


class TestRefusals:
    material = resilin.Material("neo_hookean", youngs_modulus=2.0, poissons_ratio=0.3)

    def refusal_of(self, function, *arguments, **named):
        with pytest.raises(resilin.InputError) as refusal:
            function(*arguments, **named)
        assert "\n" not in str(refusal.value)
        return str(refusal.value)

    def test_arrays_for_a_material_whose_constants_require_grad(self):
        material = resilin.Material("neo_hookean", youngs_modulus=number(2.0), poissons_ratio=0.3)
        text = self.refusal_of(material.energy_density, states(3).numpy())
        assert text.startswith(
            "F: expected a torch tensor because youngs_modulus requires grad, got a numpy array; use"
        )

    def test_tensors_beside_arrays(self):
        text = self.refusal_of(self.material.elastic_forces, states(3).numpy(), cells(3)[0], np.ones(4))
        assert text.startswith("Dm_inv: expected a numpy array, got a torch tensor")
        text = self.refusal_of(self.material.energy_density, states(3), out=np.empty(4))
        assert text.startswith("out: expected a torch tensor as F is, got ndarray")

    def test_tensors_elsewhere_and_of_other_kinds(self):
        elsewhere = torch.empty(4, 3, 3, device="meta")
        text = self.refusal_of(self.material.energy_density, elsewhere)
        assert text == "F: expected a tensor on the CPU, got one on meta; use .cpu()"
        if torch.cuda.is_available():
            assert "got one on cuda:0; use .cpu()" in self.refusal_of(self.material.energy_density, states(3).cuda())
        for dtype in (torch.complex64, torch.float16, torch.bfloat16, torch.bool):
            text = self.refusal_of(self.material.energy_density, torch.zeros(3, 3, dtype=dtype))
            assert text.startswith("F: expected real numbers in float64 or float32, got " + str(dtype)[6:])
        sparse = torch.eye(3).to_sparse()
        assert self.refusal_of(self.material.energy_density, sparse).startswith("F: expected a dense tensor")

    @pytest.mark.parametrize("shape", [(3,), (5, 3, 2), (4, 4), ()])
    def test_shapes(self, shape):
        text = self.refusal_of(self.material.energy_density, torch.zeros(shape))
        assert text.startswith("F: expected a tensor (..., 2, 2) or (..., 3, 3), got ")

    def test_constants(self):
        text = self.refusal_of(resilin.Material, "neo_hookean", youngs_modulus=number(2.0), poissons_ratio=0.5)
        assert text.startswith("neo_hookean.poissons_ratio: expected a number in (-1, 0.5), got 0.5")
        text = self.refusal_of(resilin.Material, "neo_hookean", youngs_modulus=1.0, poissons_ratio=number(0.6))
        assert text.startswith("neo_hookean.poissons_ratio: expected a number in (-1, 0.5), got 0.6")
        text = self.refusal_of(resilin.Material, "neo_hookean", youngs_modulus=1.0, poisson_ratio=number(0.3))
        assert 'did you mean "poissons_ratio"?' in text

    def test_free_constants_that_others_depend_on(self):
        given = {"youngs_modulus": 2.0, "poissons_ratio": 0.3}
        text = self.refusal_of(resilin.Material, "arruda_boyce", **given, chain_segments=number(8.0))
        assert text.startswith("arruda_boyce.chain_segments: expected a number beside youngs_modulus")
        names = "chain_modulus and chain_segments and bulk_modulus"
        assert text.endswith(f"; give {names} in place of youngs_modulus and poissons_ratio")
        plain = resilin.Material("arruda_boyce", **given, chain_segments=8.0)
        segments = number(8.0)
        followed = resilin.Material("arruda_boyce", **{**plain.constants, "chain_segments": segments})
        followed.energy_density(states(3)).sum().backward()
        expected = plain.constant_derivatives(states(3).numpy())["chain_segments"][0]
        assert float(segments.grad) == pytest.approx(expected.sum(), rel=1e-12)
        limit = number(30.0)
        resilin.Material("gent", **given, limit=limit).energy_density(states(3)).sum().backward()
        expected = resilin.Material("gent", **given, limit=30.0).constant_derivatives(states(3).numpy())["limit"][0]
        assert float(limit.grad) == pytest.approx(expected.sum(), rel=1e-12)

    def test_constants_that_are_missing(self):
        text = self.refusal_of(resilin.Material, "neo_hookean", youngs_modulus=number(2.0))
        assert text.startswith("neo_hookean.poissons_ratio: expected")
        followed = resilin.Material("ogden", mu_1=number(2.0), alpha_1=1.3, bulk_modulus=5.0)
        assert [float(value) for value in followed.constants.values()] == [2.0, 1.3, 0.0, 2.0, 0.0, -2.0, 5.0]

    def test_simulations_of_tensors(self):
        followed = resilin.Material("neo_hookean", youngs_modulus=number(2.0), poissons_ratio=0.3)
        mesh = resilin.Mesh.rectangle((1, 1), (2, 2))
        scene = {"simulation": {"kind": "dynamic", "dimension": 2}, "body": [{"name": "body", "mesh": mesh}]}
        simulation = resilin.Simulation(scene)
        expected = "material.youngs_modulus: expected numbers or arrays, got tensors that require grad; use .detach()"
        assert self.refusal_of(simulation.set_material, "body", followed) == expected
        scene["body"][0]["material"] = {"law": followed}
        assert self.refusal_of(resilin.run, scene) == expected
        detached = resilin.Material("neo_hookean", youngs_modulus=number(2.0).detach(), poissons_ratio=0.3)
        simulation.set_material("body", detached)

    def test_fibres_that_require_grad(self):
        constants = {"shear_modulus": 1.0, "bulk_modulus": 3.0, "fibre_modulus": 2.0, "fibre_stiffening": 0.5}
        fibre = torch.tensor([1.0, 0.0, 0.0], requires_grad=True)
        text = self.refusal_of(resilin.Material, "holzapfel_gasser_ogden", **constants, fibres=fibre)
        assert text.endswith("got a tensor that does; use fibres.detach()")
        resilin.Material("holzapfel_gasser_ogden", **constants, fibres=fibre.detach())

    def test_out_where_autograd_follows(self):
        out = torch.empty(4, dtype=torch.float64)
        text = self.refusal_of(self.material.energy_density, states(3).requires_grad_(), out=out)
        assert text.startswith("out: expected nothing where autograd or torch.func follows the result")
