"""Arrays of a caller, made ready for the core: real, float64 or float32, C-contiguous; or refused in one line."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from resilin._core import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import TypeGuard

    from numpy.typing import NDArray

    from resilin.typing import AnyPath, TensorLike

FLOAT64: np.dtype[np.float64] = np.dtype(np.float64)
FLOAT32: np.dtype[np.float32] = np.dtype(np.float32)


def is_tensor(value: object) -> TypeGuard[TensorLike[Any]]:
    """Whether `value` is a torch tensor; torch is never imported for the question."""
    torch = sys.modules.get("torch")
    return torch is not None and isinstance(value, torch.Tensor)


def refuse(place: str, expected: str, got: str, cure: str = "") -> NoReturn:
    raise InputError(f"{place}: expected {expected}, got {got}" + (f"; {cure}" if cure else ""))


def require_instance(value: object, kind: type, place: str) -> None:
    if not isinstance(value, kind):
        refuse(place, f"a resilin.{kind.__name__}", type(value).__name__)


def plain_text(value: object, place: str) -> str:
    """A text that has a form in UTF-8, which a lone surrogate such as "\\ud800" has not."""
    if not isinstance(value, str):
        refuse(place, "a text", repr(value))
    try:
        value.encode()
    except UnicodeEncodeError as error:
        lone = ascii(value[error.start])
        refuse(place, "a text of whole characters", f"{ascii(value)[:60]} with half of one, {lone}")
    return value


def file_path(path: AnyPath, place: str) -> str:
    """A path that the system can hold."""
    if not isinstance(path, str | os.PathLike):
        refuse(place, "a path", type(path).__name__)
    text = os.fspath(path)
    try:
        has_null = b"\0" in os.fsencode(text)
    except UnicodeEncodeError:
        refuse(place, "a path of whole characters", ascii(text)[:60])
    if has_null:
        refuse(place, "a path without null characters", ascii(text)[:60])
    return text


def real_array(value: object, place: str) -> NDArray[np.floating[Any]]:
    """`value` as a C-contiguous float64 or float32 array; the same object where it is one, else a copy.

    Whole numbers become float64, exactly up to 2^53.
    """
    if type(value) is np.ndarray and (value.dtype is FLOAT64 or value.dtype is FLOAT32):
        flags = value.flags
        if flags.c_contiguous and flags.aligned:
            return value
    if is_tensor(value):
        refuse(place, "a numpy array", "a torch tensor", "give all arguments as tensors, or this one as an array")
    try:
        array = np.asarray(value)
    except ValueError:
        refuse(place, "an array of real numbers", "rows of different lengths")
    except TypeError:  # such as an array on another device
        refuse(place, "an array of real numbers on the CPU", type(value).__name__)
    if isinstance(value, np.ma.MaskedArray):
        refuse(place, "an array without a mask", "a masked array", "use .filled()")
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "f" and size in (4, 8):
        wanted = np.dtype(f"f{size}")
    elif kind in "iu":
        wanted = FLOAT64
    else:
        refuse(place, "real numbers in float64 or float32", array.dtype.name)
    return np.require(array, dtype=wanted, requirements=["C", "A"])


def square_matrices(value: object, place: str) -> NDArray[np.floating[Any]]:
    """`value` as an array (..., d, d) of 2 by 2 or 3 by 3 matrices."""
    array = real_array(value, place)
    shape = array.shape
    if len(shape) < 2 or shape[-1] != shape[-2] or not 2 <= shape[-1] <= 3:
        refuse(place, "an array (..., 2, 2) or (..., 3, 3)", describe(shape))
    return array


def result_array(
    out: object,
    shape: tuple[int, ...],
    like: NDArray[np.floating[Any]],
    inputs: Iterable[NDArray[np.floating[Any]]] = (),
) -> NDArray[np.floating[Any]]:
    """`out` once it has been found fit to hold a result, else a new array of the type of `like`."""
    if out is None:
        return np.empty(shape, like.dtype)
    if type(out) is not np.ndarray or out.shape != shape or out.dtype != like.dtype:
        got = f"{out.dtype} {describe(out.shape)}" if isinstance(out, np.ndarray) else type(out).__name__
        refuse("out", f"a {like.dtype} array {describe(shape)}", got)
    flags = out.flags
    if not (flags.c_contiguous and flags.aligned and flags.writeable and out.dtype.isnative):
        refuse("out", "a writeable C-contiguous array", "a strided, byte-swapped or read-only one")
    if any(np.may_share_memory(out, array) for array in (like, *inputs)):
        refuse("out", "memory of its own", "an array that overlaps an input")
    return out


def describe(shape: Sequence[int]) -> str:
    """(3,) as "(3,)"; () as "a single number"."""
    return str(tuple(shape)) if shape else "a single number"
