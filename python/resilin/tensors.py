"""Tensors of a caller, made ready: real, dense, on the CPU; or refused in one line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch.autograd import forward_ad

from resilin.arrays import describe, real_array, refuse

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

REAL = (torch.float64, torch.float32)


def real_tensor(value: object, place: str) -> torch.Tensor:
    """A real tensor on the CPU, or the tensor of an array."""
    if not isinstance(value, torch.Tensor):
        return torch.from_numpy(np.array(real_array(value, place)))
    if value.dtype in REAL and value.is_cpu and value.layout is torch.strided:
        return value
    if not value.is_cpu:
        refuse(place, "a tensor on the CPU", f"one on {value.device}", "use .cpu()")
    if value.layout is not torch.strided:
        refuse(place, "a dense tensor", f"layout {value.layout}", "use .to_dense()")
    if value.dtype.is_floating_point or value.dtype.is_complex or value.dtype is torch.bool:
        refuse(place, "real numbers in float64 or float32", str(value.dtype).removeprefix("torch."))
    whole: torch.Tensor = value.double()
    return whole


def square_tensors(value: object, place: str) -> torch.Tensor:
    """`value` as a tensor (..., d, d) of 2 by 2 or 3 by 3 matrices."""
    tensor = real_tensor(value, place)
    shape = tensor.shape
    if len(shape) < 2 or shape[-1] != shape[-2] or not 2 <= shape[-1] <= 3:
        refuse(place, "a tensor (..., 2, 2) or (..., 3, 3)", describe(shape))
    return tensor


def is_readable(tensor: torch.Tensor) -> bool:
    """False for tensors that torch.func has wrapped, which hold no memory of their own."""
    try:
        tensor.detach().numpy()
    except RuntimeError:
        return False
    return True


def is_forward_mode() -> bool:
    """Whether tensors may carry tangents."""
    level: int = getattr(forward_ad, "_current_level", -1)
    return level >= 0


def arrays_of(tensors: Iterable[torch.Tensor]) -> list[NDArray[Any]] | None:
    """Views of tensors as arrays; None where autograd or a transform of torch.func follows them."""
    if is_forward_mode():
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


def plain_arrays(*tensors: Any) -> list[NDArray[Any]]:
    """Views of tensors as arrays; none where one is no tensor, or its numbers are not simply there."""
    if is_forward_mode():
        return []
    try:
        return [tensor.numpy() for tensor in tensors]
    except (AttributeError, RuntimeError, TypeError):  # errors of autograd, torch.func or another device
        return []


def array_of(out: object) -> NDArray[Any] | None:
    """The memory of a tensor that a result goes to."""
    if out is None:
        return None
    if not isinstance(out, torch.Tensor):
        refuse("out", "a torch tensor as F is", type(out).__name__)
    memory: NDArray[Any] = real_tensor(out, "out").detach().numpy()
    return memory


def tensor_of(result: object, out: object) -> torch.Tensor:
    """`out`, which holds the result already, or the result."""
    return out if isinstance(out, torch.Tensor) else torch.from_numpy(np.asarray(result))


def in_type_of(like: torch.Tensor, values: torch.Tensor) -> torch.Tensor:
    """`values` in float64 or float32, as `like` is."""
    converted: torch.Tensor = values.to(like.dtype)
    return converted
