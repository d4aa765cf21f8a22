"""Simulations as functions of tensors."""

import pytest
from gradient_scenes import E, bar, halved, motion

torch = pytest.importorskip("torch")

import resilin.torch  # noqa: E402

pytestmark = pytest.mark.torch


@pytest.mark.parametrize("scene", [bar, motion])
def test_torch_goes_through_statics_and_motion(scene):
    names = [E, "load.pull.value", "fix.wall.displacement"]

    def positions(*tensors):
        return resilin.torch.simulate(scene(), **dict(zip(names, tensors, strict=True)))

    def scaled(modulus, pull, shift):  # numbers of about 1, whose differences have digits
        return positions(1e5 * modulus, 30 * pull, 0.1 * shift)[-1]

    inputs = [
        torch.tensor(values, dtype=torch.float64, requires_grad=True)
        for values in (1.0, [1.0, 0.5, 0.2], [0.1, 0.0, 0.2])
    ]
    assert torch.autograd.gradcheck(scaled, inputs, eps=1e-5, atol=1e-7, rtol=1e-5)

    field = torch.full((24,), 1e5, dtype=torch.float64, requires_grad=True)
    resilin.torch.simulate(scene(), **{E: field})[-1, :, 2].sum().backward()
    assert field.grad.shape == (24,)


@pytest.mark.parametrize("scene", [bar, motion])
def test_a_batch_has_the_bits_of_one_after_another(scene):
    steps = torch.arange(4, dtype=torch.float64)
    moduli = (1e5 * (1 + steps)).requires_grad_()
    pull = torch.tensor([10.0, 1.0, 2.0], dtype=torch.float64, requires_grad=True)
    names = (E, "load.pull.value")

    def simulate(*tensors, **options):
        return resilin.torch.simulate(scene(), **options, **dict(zip(names, tensors, strict=True)))

    places = simulate(moduli, pull.expand(4, 3), batch=True)
    places[:, -1, :, 2].amin(dim=1).sum().backward()
    found = moduli.grad.clone()
    assert pull.grad.shape == (3,)
    for i in range(4):
        modulus = moduli[i].detach().requires_grad_()
        alone = simulate(modulus, pull)
        assert torch.equal(alone, places[i])
        alone[-1, :, 2].min().backward()
        assert modulus.grad == found[i]


def test_a_batch_goes_over_runs_whose_load_steps_were_halved():
    moduli = torch.tensor([1e5, 3e4, 1e7], dtype=torch.float64, requires_grad=True)
    places = resilin.torch.simulate(halved(), batch=True, **{E: moduli})
    assert places.shape[1] == 3  # load factors 0, 1/2 and 1
    places[:, 1:, :, 2].sum().backward()
    for i, modulus in enumerate(moduli.detach()):
        run = resilin.value_and_gradient(halved(float(modulus)), None, [E])
        seed = 0 * run.positions
        asked = [list(run.outcome.loads).index(load) for load in (0.5, 1.0)]
        seed[asked, :, 2] = 1
        assert moduli.grad[i] == run.vjp(seed)[E]
        assert (places[i, 1:].detach().numpy() == run.positions[asked]).all()
