"""Autograd functions: quantities of a law at tensors of states.

Each quantity that the core evaluates knows what it becomes when it is differentiated; one autograd function,
`Evaluation`, serves all. The energy can be differentiated twice, stress and forces once.
"""

# ruff: noqa: N803, N806, N815 - F and P are the letters of the field

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import torch

from resilin import _core
from resilin.catalog import projection_named
from resilin.constants import batch_law
from resilin.law_at_arrays import LawAtArrays
from resilin.tensor_constants import TensorConstants

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from resilin.typing import Projection

    Array = NDArray[Any]


@dataclass(frozen=True)
class Quantity:
    """Quantity that the core evaluates at each state, and its derivatives; None where there is none."""

    num_axes: int  # number of axes of its value at one state, each of length d
    evaluate: Callable[[_core.BatchLaw, Array, bool, Array], None]  # law, F, holds_displacement_gradients, result
    by_F: Quantity | None = None
    by_constant: Callable[[int], Quantity] | None = None


def tangent(projection: Projection = None) -> Quantity:
    kind = projection_named(projection)
    return Quantity(4, lambda law, F, is_H, out: law.stress_tangents(F, is_H, kind, out))


def stress_slope(p: int) -> Quantity:
    """dP/dp for the constant at place p."""
    return Quantity(2, lambda law, F, is_H, out: law.constant_derivatives(F, is_H, p, None, out))


def second_slope(p: int, q: int) -> Quantity:
    """d2Psi/(dp dq)."""
    return Quantity(0, lambda law, F, is_H, out: law.second_constant_derivatives(F, is_H, p, q, out))


def energy_slope(p: int) -> Quantity:
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
    constants: LawAtArrays | TensorConstants
    are_displacement_gradients: bool

    def law(self, batch: tuple[int, ...], tensors: Sequence[torch.Tensor]) -> _core.BatchLaw:
        """The core's law; `tensors` are the constants where autograd follows them."""
        if isinstance(self.constants, LawAtArrays):
            return self.constants.law_for(batch)
        numbers = [np.ascontiguousarray(tensor.detach().numpy()) for tensor in tensors]
        return batch_law(self.constants.info, numbers, self.constants.fibres, batch)


def _value(quantity: Quantity, states: States, F: torch.Tensor, *constants: torch.Tensor) -> torch.Tensor:
    batch, dim = F.shape[:-2], F.shape[-1]
    value = torch.empty((*batch, *[dim] * quantity.num_axes), dtype=F.dtype, device="cpu")
    array = F.detach().resolve_neg().contiguous().numpy()
    quantity.evaluate(states.law(batch, constants), array, states.are_displacement_gradients, value.numpy())
    return value


def _remembered_value(ctx: Any, *inputs: Any) -> torch.Tensor:
    """Before torch 2.0 one method computes and remembers."""
    value = _value(*inputs)
    Evaluation.setup_context(ctx, inputs, value)
    return value


class Evaluation(torch.autograd.Function):
    """A quantity at states F (*batch, d, d) and constants, each float64 and () or batch; none when they are fixed."""

    forward: Callable[..., torch.Tensor] = staticmethod(_value if hasattr(torch, "func") else _remembered_value)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: torch.Tensor) -> None:  # noqa: ARG004 - torch's signature
        ctx.quantity, ctx.states, *tensors = inputs
        ctx.save_for_backward(*tensors)
        ctx.save_for_forward(*tensors)

    @staticmethod
    def backward(ctx: Any, weight: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        by_F, by_constant = _slopes(ctx)
        num_axes = ctx.quantity.num_axes
        _, *constants = ctx.saved_tensors
        gradients: list[torch.Tensor | None] = [None, None, None]
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
    def jvp(
        ctx: Any,
        _quantity: None,
        _states: None,
        F_change: torch.Tensor | None,
        *constant_changes: torch.Tensor | None,
    ) -> torch.Tensor:
        by_F, by_constant = _slopes(ctx)
        change: Any = 0  # a tensor from the first part on
        if F_change is not None:
            change = torch.einsum(
                "...ij,...ij->..." if ctx.quantity.num_axes == 0 else "...klij,...ij->...kl", by_F(), F_change
            )
        for place, constant_change in enumerate(constant_changes):
            if constant_change is not None:
                along = [1] * ctx.quantity.num_axes
                change = change + by_constant(place) * constant_change.reshape(*constant_change.shape, *along)
        rate: torch.Tensor = change.to(ctx.saved_tensors[0].dtype)
        return rate

    @staticmethod
    def vmap(
        info: Any,
        in_dims: tuple[int | None, ...],
        quantity: Quantity,
        states: States,
        F: torch.Tensor,
        *constants: torch.Tensor,
    ) -> tuple[torch.Tensor, int]:
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
        return evaluated(quantity, states, F, *spread), 0


def evaluated(quantity: Quantity, states: States, F: torch.Tensor, *constants: torch.Tensor) -> torch.Tensor:
    """The quantity as a node of autograd's graph."""
    apply: Callable[..., torch.Tensor] = Evaluation.apply
    return apply(quantity, states, F, *constants)


def _slopes(ctx: Any) -> tuple[Callable[[], torch.Tensor], Callable[[int], torch.Tensor]]:
    """Derivatives of the quantity of `ctx`: by F, and by the constant at a place."""
    quantity: Quantity = ctx.quantity
    if quantity.by_F is None or quantity.by_constant is None:
        raise RuntimeError(
            "the energy density can be differentiated twice, stress and forces once; "
            "third derivatives of the energy are not available"
        )
    by_F, by_constant = quantity.by_F, quantity.by_constant
    states: tuple[Any, ...] = (ctx.states, *ctx.saved_tensors)
    return partial(evaluated, by_F, *states), lambda place: evaluated(by_constant(place), *states)
