"""Simulations through which torch's autograd goes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch.autograd.function import once_differentiable

from resilin.gradient import Differentiated
from resilin.tensors import real_tensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from resilin.typing import Overrides, Scene


class _Simulate(torch.autograd.Function):
    """From the tensors of named parameters to the places of all nodes."""

    @staticmethod
    def forward(ctx: Any, run: Differentiated, *tensors: torch.Tensor) -> torch.Tensor:  # noqa: ARG004
        ctx.run, ctx.shapes = run, [(tensor.shape, tensor.dtype) for tensor in tensors]
        return torch.from_numpy(run.positions)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, by_positions: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        gradients = ctx.run.vjp(by_positions.detach().contiguous().numpy())
        found = [
            torch.from_numpy(np.array(gradient, dtype=np.float64)).reshape(shape).to(dtype)
            for (shape, dtype), gradient in zip(ctx.shapes, gradients.values(), strict=True)
        ]
        return None, *found


def simulate_at_tensors(
    scene: Scene, overrides: Overrides, checkpoints: int, given: Mapping[str, torch.Tensor]
) -> torch.Tensor:
    tensors = {name: real_tensor(tensor, name) for name, tensor in given.items()}
    values = {name: tensor.detach().numpy() for name, tensor in tensors.items()}
    run = Differentiated(scene, None, list(tensors), overrides, values, checkpoints)
    places: torch.Tensor = _Simulate.apply(run, *tensors.values())
    return places
