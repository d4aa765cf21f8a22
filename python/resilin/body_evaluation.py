"""Autograd functions of a body's positions alone: energy, gradient and Hessian of the core."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from resilin.catalog import projection_named
from resilin.tensors import in_type_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from resilin import _core

FOLLOWS_WITH_SETUP = hasattr(torch, "func")  # before torch 2.0 one method computes and remembers


def energy(core: _core.ElasticBody, x: torch.Tensor) -> torch.Tensor:
    """E(x), () [J] at positions (N, d); differentiable twice."""
    apply: Callable[..., torch.Tensor] = BodyEnergy.apply
    return apply(core, x)


def gradient(core: _core.ElasticBody, x: torch.Tensor) -> torch.Tensor:
    """dE/dx (N, d) [N]; differentiable once."""
    apply: Callable[..., torch.Tensor] = BodyGradient.apply
    return apply(core, x)


def hessian_product(core: _core.ElasticBody, x: torch.Tensor, direction: torch.Tensor) -> torch.Tensor:
    """d2E/dx2 times a direction (N, d), of which it is a linear function."""
    apply: Callable[..., torch.Tensor] = HessianProduct.apply
    return apply(core, x, direction)


def array_of_positions(x: torch.Tensor) -> NDArray[np.float64]:
    return np.ascontiguousarray(x.detach().resolve_neg().numpy(), dtype=np.float64)


def _energy(core: _core.ElasticBody, x: torch.Tensor) -> torch.Tensor:
    return torch.tensor(core.value(array_of_positions(x)), dtype=x.dtype)


def _gradient(core: _core.ElasticBody, x: torch.Tensor) -> torch.Tensor:
    return in_type_of(x, torch.from_numpy(core.gradient(array_of_positions(x))))


def _hessian_product(core: _core.ElasticBody, x: torch.Tensor, direction: torch.Tensor) -> torch.Tensor:
    from scipy.sparse import csr_matrix  # takes longer to import than all else

    values, columns, row_begin = core.hessian(array_of_positions(x), projection_named(None))
    size = x.numel()
    matrix = csr_matrix((values, columns, row_begin), shape=(size, size))
    product = torch.from_numpy(matrix @ array_of_positions(direction).ravel())
    return in_type_of(x, product.reshape(x.shape))


def _remembering(function: Callable[..., torch.Tensor]) -> Any:
    """The forward of an autograd function."""
    if FOLLOWS_WITH_SETUP:
        return staticmethod(function)

    def forward(ctx: Any, core: _core.ElasticBody, *tensors: torch.Tensor) -> torch.Tensor:
        remember(ctx, (core, *tensors), None)
        return function(core, *tensors)

    return staticmethod(forward)


def remember(ctx: Any, inputs: tuple[Any, ...], output: object) -> None:  # noqa: ARG001 - torch's signature
    ctx.core, *tensors = inputs
    ctx.save_for_backward(*tensors)
    ctx.save_for_forward(*tensors)


def _mapped(function: Callable[..., torch.Tensor]) -> Any:
    """The rule of vmap: one state after the other; the core works on each with all threads."""

    def vmap(
        info: Any, in_dims: tuple[int | None, ...], core: _core.ElasticBody, *tensors: torch.Tensor
    ) -> tuple[torch.Tensor, int]:
        def of(tensor: torch.Tensor, axis: int | None, i: int) -> torch.Tensor:
            return tensor if axis is None else tensor.select(axis, i)

        results = [
            function(core, *(of(tensor, axis, i) for tensor, axis in zip(tensors, in_dims[1:], strict=True)))
            for i in range(info.batch_size)
        ]
        return torch.stack(results), 0

    return staticmethod(vmap)


class BodyEnergy(torch.autograd.Function):
    forward: Any = _remembering(_energy)
    setup_context = staticmethod(remember)
    vmap: Any = _mapped(energy)

    @staticmethod
    def backward(ctx: Any, weight: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        (x,) = ctx.saved_tensors
        return None, weight * gradient(ctx.core, x)

    @staticmethod
    def jvp(ctx: Any, _core: None, change: torch.Tensor) -> torch.Tensor:
        (x,) = ctx.saved_tensors
        return in_type_of(x, (gradient(ctx.core, x) * change).sum())


class BodyGradient(torch.autograd.Function):
    forward: Any = _remembering(_gradient)
    setup_context = staticmethod(remember)
    vmap: Any = _mapped(gradient)

    @staticmethod
    def backward(ctx: Any, weight: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        (x,) = ctx.saved_tensors
        return None, hessian_product(ctx.core, x, weight)  # the Hessian is symmetric

    @staticmethod
    def jvp(ctx: Any, _core: None, change: torch.Tensor) -> torch.Tensor:
        (x,) = ctx.saved_tensors
        return hessian_product(ctx.core, x, change)


class HessianProduct(torch.autograd.Function):
    forward: Any = _remembering(_hessian_product)
    setup_context = staticmethod(remember)
    vmap: Any = _mapped(hessian_product)

    @staticmethod
    def backward(ctx: Any, weight: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        x, _ = ctx.saved_tensors
        if ctx.needs_input_grad[1]:
            refuse_third_derivative()
        return None, None, hessian_product(ctx.core, x, weight)

    @staticmethod
    def jvp(ctx: Any, _core: None, x_change: torch.Tensor | None, change: torch.Tensor | None) -> torch.Tensor:
        x, direction = ctx.saved_tensors
        if x_change is not None and bool(x_change.any()):
            refuse_third_derivative()
        return hessian_product(ctx.core, x, torch.zeros_like(direction) if change is None else change)


def refuse_third_derivative() -> None:
    raise RuntimeError(
        "the energy of a body can be differentiated twice, its gradient once; third derivatives of the energy are not "
        "available"
    )
