"""Simulations through which torch's autograd goes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch
from torch.autograd.function import once_differentiable

from resilin.array_simulation import ArrayRun
from resilin.tensors import real_tensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from resilin.typing import Overrides, Scene


class _Simulate(torch.autograd.Function):
    """From the tensors of named parameters to the places of all nodes."""

    @staticmethod
    def forward(ctx: Any, run: ArrayRun, *tensors: torch.Tensor) -> torch.Tensor:
        ctx.run, ctx.like = run, [(tuple(tensor.shape), tensor.dtype) for tensor in tensors]
        return torch.from_numpy(run.positions)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, by_positions: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        slopes = ctx.run.slopes(by_positions.detach().numpy(), [shape for shape, _ in ctx.like])
        return None, *(torch.from_numpy(of).to(dtype) for of, (_, dtype) in zip(slopes, ctx.like, strict=True))


def simulate_at_tensors(
    scene: Scene, overrides: Overrides, checkpoints: int, batch: bool, given: Mapping[str, torch.Tensor]
) -> torch.Tensor:
    tensors = {name: real_tensor(tensor, name) for name, tensor in given.items()}
    values = {name: tensor.detach().numpy() for name, tensor in tensors.items()}
    run = ArrayRun(scene, values, overrides, checkpoints, batch)
    places: torch.Tensor = _Simulate.apply(run, *tensors.values())
    return places
