"""Materials at torch tensors: numbers are read where they lie, and autograd follows them.

Each quantity that the core evaluates knows what it becomes when it is differentiated; one autograd function,
`Evaluation`, serves all. The energy can be differentiated twice, stress and forces once.
"""

# ruff: noqa: N803, N806, N815 - F and P are the letters of the field

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import torch
from torch.autograd import forward_ad

from resilin import _core
from resilin.arrays import describe, is_tensor, real_array, refuse
from resilin.constants import batch_law, common_shape, own_constants, spread_over
from resilin.material import Material, projection_named

REAL = (torch.float64, torch.float32)


@dataclass(frozen=True)
class Quantity:
    """What the core evaluates at each state, and its derivatives; None where there is none."""

    num_axes: int  # of its value at one state, each of length d
    evaluate: Callable  # (law, F, holds_displacement_gradients, result)
    by_F: "Quantity | None" = None
    by_constant: "Callable[[int], Quantity] | None" = None


def tangent(projection=None):
    kind = projection_named(projection)
    return Quantity(4, lambda law, F, is_H, out: law.stress_tangents(F, is_H, kind, out))


def stress_slope(p):
    """dP/dp for the constant at place p."""
    return Quantity(2, lambda law, F, is_H, out: law.constant_derivatives(F, is_H, p, None, out))


def second_slope(p, q):
    """d2Psi/(dp dq)."""
    return Quantity(0, lambda law, F, is_H, out: law.second_constant_derivatives(F, is_H, p, q, out))


def energy_slope(p):
    """dPsi/dp."""
    return Quantity(
        0,
        lambda law, F, is_H, out: law.constant_derivatives(F, is_H, p, out, None),
        stress_slope(p),
        partial(second_slope, p),
    )


STRESS = Quantity(
    2, lambda law, F, is_H, out: law.first_piola_kirchhoff_stresses(F, is_H, out), tangent(), stress_slope
)
ENERGY = Quantity(0, lambda law, F, is_H, out: law.energy_densities(F, is_H, out), STRESS, energy_slope)


class States(NamedTuple):
    material: Material
    are_displacement_gradients: bool

    def law(self, batch, constants):
        if not constants:
            return self.material.law_for(batch)
        numbers = [np.ascontiguousarray(constant.detach().numpy()) for constant in constants]
        return batch_law(self.material.info, numbers, self.material.fibres, batch)


class Evaluation(torch.autograd.Function):
    """A quantity at states F (*batch, d, d) and constants, each float64 and () or batch; none when they are fixed."""

    @staticmethod
    def forward(quantity, states, F, *constants):
        batch, dim = F.shape[:-2], F.shape[-1]
        value = torch.empty((*batch, *[dim] * quantity.num_axes), dtype=F.dtype, device="cpu")
        array = F.detach().resolve_neg().contiguous().numpy()
        quantity.evaluate(states.law(batch, constants), array, states.are_displacement_gradients, value.numpy())
        return value

    @staticmethod
    def setup_context(ctx, inputs, output):  # noqa: ARG004 - the signature is torch's
        ctx.quantity, ctx.states, *tensors = inputs
        ctx.save_for_backward(*tensors)
        ctx.save_for_forward(*tensors)

    @staticmethod
    def backward(ctx, weight):
        by_F, by_constant = _slopes(ctx)
        num_axes = ctx.quantity.num_axes
        _, *constants = ctx.saved_tensors
        gradients = [None, None, None]
        if ctx.needs_input_grad[2]:
            gradients[2] = (
                weight[..., None, None] * by_F()
                if num_axes == 0
                else torch.einsum("...ij,...ijkl->...kl", weight, by_F())
            )
        for place, constant in enumerate(constants):
            gradient = None
            if ctx.needs_input_grad[3 + place]:
                gradient = (weight * by_constant(place)).double()
                if num_axes > 0:
                    gradient = gradient.sum((-2, -1))
                if constant.ndim == 0:
                    gradient = gradient.sum()
            gradients.append(gradient)
        return tuple(gradients)

    @staticmethod
    def jvp(ctx, _quantity, _states, F_change, *constant_changes):
        by_F, by_constant = _slopes(ctx)
        change = 0
        if F_change is not None:
            change = torch.einsum(
                "...ij,...ij->..." if ctx.quantity.num_axes == 0 else "...klij,...ij->...kl", by_F(), F_change
            )
        for place, constant_change in enumerate(constant_changes):
            if constant_change is not None:
                along = [1] * ctx.quantity.num_axes
                change = change + by_constant(place) * constant_change.reshape(*constant_change.shape, *along)
        return change.to(ctx.saved_tensors[0].dtype)

    @staticmethod
    def vmap(info, in_dims, quantity, states, F, *constants):
        """The mapped axis becomes the first of the leading ones, which are free."""
        size = info.batch_size
        F = F.expand(size, *F.shape) if in_dims[2] is None else F.movedim(in_dims[2], 0)
        batch = F.shape[:-2]
        spread = []
        for constant, axis in zip(constants, in_dims[3:], strict=True):
            if axis is not None:
                constant = constant.movedim(axis, 0)
                constant = constant.reshape(size, *[1] * (len(batch) - constant.ndim), *constant.shape[1:])
            spread.append(constant if constant.ndim == 0 else constant.expand(batch))
        return Evaluation.apply(quantity, states, F, *spread), 0


if not hasattr(torch, "func"):  # before torch 2.0 one method computes and remembers

    def _forward(ctx, *inputs, compute=Evaluation.forward):
        value = compute(*inputs)
        Evaluation.setup_context(ctx, inputs, value)
        return value

    Evaluation.forward = staticmethod(_forward)


def _slopes(ctx):
    """Derivatives of the quantity of `ctx`: by F, and by the constant at a place."""
    quantity, (F, *constants) = ctx.quantity, ctx.saved_tensors
    if quantity.by_F is None:
        raise RuntimeError(
            "the energy density can be differentiated twice, stress and forces once; "
            "third derivatives of the energy are not available"
        )
    by_F = partial(Evaluation.apply, quantity.by_F, ctx.states, F, *constants)
    return by_F, lambda place: Evaluation.apply(quantity.by_constant(place), ctx.states, F, *constants)


def energy_density(material, F, is_H, out):
    F = _matrices(F, "F")
    arrays = _arrays(material, F)
    if arrays is None:
        return _derived(ENERGY, material, F, is_H, out)
    return _tensor(material.energy_density(*arrays, displacement_gradient=is_H, out=_array_of(out)), out)


def first_piola_kirchhoff_stress(material, F, is_H, out):
    F = _matrices(F, "F")
    arrays = _arrays(material, F)
    if arrays is None:
        return _derived(STRESS, material, F, is_H, out)
    return _tensor(material.first_piola_kirchhoff_stress(*arrays, displacement_gradient=is_H, out=_array_of(out)), out)


def stress_tangent(material, F, projection, is_H, out):
    F = _matrices(F, "F")
    arrays = _arrays(material, F)
    if arrays is None:
        return _derived(tangent(projection), material, F, is_H, out)
    return _tensor(
        material.stress_tangent(*arrays, projection, displacement_gradient=is_H, out=_array_of(out)),
        out,
    )


def elastic_forces(material, F, Dm_inv, volume, is_H, out):
    tensors = _matrices(F, "F"), _matrices(Dm_inv, "Dm_inv"), _checked(volume, "volume")
    arrays = _arrays(material, *tensors)
    if arrays is not None:
        return _tensor(material.elastic_forces(*arrays, displacement_gradient=is_H, out=_array_of(out)), out)
    F, Dm_inv, volume = tensors
    if Dm_inv.shape[-1] != F.shape[-1]:
        refuse("Dm_inv", f"matrices as large as those of F, {tuple(F.shape[-2:])}", f"{tuple(Dm_inv.shape[-2:])}")
    P = _derived(STRESS, material, F, is_H, out)
    others = -volume[..., None, None] * (Dm_inv @ P.transpose(-1, -2))  # rows: corners 1, 2, ...
    return torch.cat([-others.sum(-2, keepdim=True), others], -2)


def constant_derivatives(material, F, is_H):
    F = _matrices(F, "F")
    return {
        constant.name: tuple(_derived(slope(p), material, F, is_H) for slope in (energy_slope, stress_slope))
        for p, constant in enumerate(material.info.constants)
    }


def cauchy_stress(material, F, is_H):
    F = _matrices(F, "F")
    arrays = _arrays(material, F)
    if arrays is not None:
        return _tensor(material.cauchy_stress(*arrays, displacement_gradient=is_H), None)
    missing = 3 - F.shape[-1]
    in_space = torch.nn.functional.pad(F, (0, missing, 0, missing))
    if missing and not is_H:
        in_space = in_space + torch.diag(torch.tensor([0, 0, 1], dtype=F.dtype))
    P = _derived(STRESS, material, in_space, is_H)
    if material.info.is_small_strain:
        return P
    if is_H:
        in_space = in_space + torch.eye(3, dtype=F.dtype)
    sigma = P.double() @ in_space.double().transpose(-1, -2) / torch.linalg.det(in_space.double())[..., None, None]
    return sigma.to(F.dtype)


def split_constants(law, given, fibres):
    """What autograd follows, {name: tensor}, and the rest of `given` and `fibres` as arrays."""
    tensors = {}
    for name, value in given.items():
        if not is_tensor(value):
            continue
        value = _checked(value, f"{law}.{name}")
        if value.requires_grad or _is_forward_mode() or not _is_readable(value):
            tensors[name] = value
        else:
            given = {**given, name: value.numpy()}
    if is_tensor(fibres):
        if fibres.requires_grad:
            refuse(f"{law}.fibres", "directions that do not require grad", "a tensor that does", "use fibres.detach()")
        fibres = _checked(fibres, f"{law}.fibres").numpy()
    return {name: value for name, value in given.items() if name not in tensors}, tensors, fibres


def check_constants(given, tensors, info):
    """Refuses tensors whose values are out of bounds; those that torch.func has wrapped cannot be read."""
    if all(_is_readable(tensor) for tensor in tensors.values()):
        own_constants(info, {**given, **{name: tensor.detach().double().numpy() for name, tensor in tensors.items()}})


def own_tensors(given, tensors, conversion, info):
    """The constants of the law's formula as float64 tensors that depend on the given ones.

    `conversion` is what `conversion_from_young_poisson` makes of `given`, or None when those two are not given.
    """
    tensors = {name: tensor.double() for name, tensor in tensors.items()}

    def tensor(name, fallback=None):
        if name not in tensors and name not in given and fallback is None:
            refuse(f"{info.name}.{name}", "a number or a tensor", "nothing", f"add {name}")
        return tensors[name] if name in tensors else torch.from_numpy(given.get(name, np.array(fallback)))

    if conversion is None:
        return [tensor(constant.name, constant.fallback) for constant in info.constants]
    young, poisson = tensor("youngs_modulus"), tensor("poissons_ratio")
    mu = young / (2 * (1 + poisson))
    lame_lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    return [
        tensors[name] if name in tensors else base + by_mu * mu + by_lambda * lame_lambda
        for name, (base, by_mu, by_lambda) in conversion.items()
    ]


def conversion_from_young_poisson(given, tensors, info):
    """{own constant: (base, by_mu, by_lambda)}: own = base + by_mu mu + by_lambda lambda, for Hooke's mu and lambda."""
    fallbacks = {constant.name: constant.fallback for constant in info.constants if constant.is_free}
    free = {name: np.array(1.0 if value is None else value) for name, value in fallbacks.items()}
    free.update((name, given[name]) for name in free.keys() & given.keys())
    at_11, at_22, at_14 = (_converted(info, hooke, free) for hooke in ((1.0, 1.0), (2.0, 2.0), (1.0, 4.0)))
    for name in free.keys() & tensors.keys():
        elsewhere = _converted(info, (1.0, 1.0), {**free, name: 1.5 * free[name] + 0.1})
        if any(not np.array_equal(elsewhere[other], at_11[other]) for other in at_11 if other != name):
            refuse(
                f"{info.name}.{name}",
                "a number beside youngs_modulus, because other constants depend on it",
                "a tensor that requires grad",
                f"give {' and '.join(at_11)} in place of youngs_modulus and poissons_ratio",
            )
    conversion = {}
    for name in at_11:
        by_lambda = (at_14[name] - at_11[name]) / 3
        by_both = at_22[name] - at_11[name]
        terms = at_11[name] - by_both, by_both - by_lambda, by_lambda
        conversion[name] = tuple(torch.from_numpy(np.asarray(term)) for term in terms)
    return conversion


def _converted(info, hooke, free):
    shape = common_shape(free, info.name)
    rows = np.empty((len(info.constants), math.prod(shape)))
    spread = [array if array.ndim == 0 else spread_over(array, shape) for array in free.values()]
    _core.convert_constants(info, *hooke, spread, rows)
    return {constant.name: row.reshape(shape) for constant, row in zip(info.constants, rows, strict=True)}


def _checked(value, place):
    """A real tensor on the CPU, or the tensor of an array."""
    if is_tensor(value) and value.dtype in REAL and value.is_cpu and value.layout is torch.strided:
        return value
    if not is_tensor(value):
        return torch.from_numpy(np.array(real_array(value, place)))
    if not value.is_cpu:
        refuse(place, "a tensor on the CPU", f"one on {value.device}", "use .cpu()")
    if value.layout is not torch.strided:
        refuse(place, "a dense tensor", f"layout {value.layout}", "use .to_dense()")
    if value.dtype.is_floating_point or value.dtype.is_complex or value.dtype is torch.bool:
        refuse(place, "real numbers in float64 or float32", str(value.dtype).removeprefix("torch."))
    return value.double()


def _matrices(value, place):
    tensor = _checked(value, place)
    shape = tensor.shape
    if len(shape) < 2 or shape[-1] != shape[-2] or not 2 <= shape[-1] <= 3:
        refuse(place, "a tensor (..., 2, 2) or (..., 3, 3)", describe(shape))
    return tensor


def _is_readable(tensor):
    try:
        tensor.detach().numpy()
    except RuntimeError:
        return False
    return True


def _is_forward_mode():
    """Whether tensors may carry tangents."""
    return getattr(forward_ad, "_current_level", -1) >= 0


def _arrays(material, *tensors):
    """Views of tensors as arrays; None where autograd or a transform of torch.func follows them."""
    if material.tensors or _is_forward_mode():
        return None
    arrays = []
    for tensor in tensors:
        if tensor.requires_grad:
            if torch.is_grad_enabled():
                return None
            tensor = tensor.detach()
        try:
            arrays.append(tensor.numpy())
        except RuntimeError:  # torch.func wraps tensors that hold no memory of their own
            return None
    return arrays


def _array_of(out):
    if out is None:
        return None
    if not is_tensor(out):
        refuse("out", "a torch tensor as F is", type(out).__name__)
    return _checked(out, "out").detach().numpy()


def _tensor(result, out):
    return torch.from_numpy(np.asarray(result)) if out is None else out


def _derived(quantity, material, F, is_H, out=None):
    """The quantity as a node that autograd, and vmap, can follow."""
    if out is not None:
        refuse("out", "nothing where autograd or torch.func follows the result", "a tensor")
    constants = material.tensor_constants()
    batch = F.shape[:-2]
    shapes = [batch, material.states_shape, *(constant.shape for constant in constants)]
    try:
        batch = np.broadcast_shapes(*(tuple(shape) for shape in shapes))
    except ValueError:
        refuse("F", f"a leading shape that goes with the constants' {tuple(shapes[-1])}", str(tuple(batch)))
    constants = [constant if constant.ndim == 0 else constant.expand(batch) for constant in constants]
    return Evaluation.apply(quantity, States(material, is_H), F.expand(*batch, *F.shape[-2:]), *constants)
