"""Constants of a law that autograd follows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from resilin import _core
from resilin.arrays import refuse
from resilin.constants import common_shape, own_constants, spread_over
from resilin.tensors import is_forward_mode, is_readable, real_tensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    Arrays = Mapping[str, NDArray[np.float64]]
    Tensors = Mapping[str, torch.Tensor]
    Conversion = Mapping[str, tuple[torch.Tensor, ...]]


class TensorConstants:
    """A law's constants of which some are tensors that autograd follows.

    Parameters
    ----------
    given : dict of float64 arrays
    tensors : dict of tensors
        Together what the user gave, youngs_modulus and poissons_ratio or the law's own constants.
    fibres : None, or unit vectors (families, 3) or (..., families, 3)
    """

    def __init__(
        self, info: _core.LawInfo, given: Arrays, tensors: Tensors, fibres: NDArray[np.float64] | None
    ) -> None:
        self.info = info
        self.fibres = fibres
        self.states_shape: tuple[int, ...] = () if fibres is None else fibres.shape[:-2]
        self._given, self.tensors = given, tensors
        self._checked_versions: list[int] | None = None
        self._conversion: Conversion | None = None
        if "youngs_modulus" in given or "youngs_modulus" in tensors:
            self._conversion = _conversion_from_young_poisson(given, tensors, info)
        self.own()

    def own(self) -> list[torch.Tensor]:
        """The constants of the law's formula as float64 tensors that depend on the given ones."""
        versions = self.versions()
        if versions != self._checked_versions:
            self._check()
            self._checked_versions = versions
        tensors = {name: tensor.double() for name, tensor in self.tensors.items()}
        if self._conversion is None:
            return [self._tensor(tensors, constant.name, constant.fallback) for constant in self.info.constants]
        young, poisson = self._tensor(tensors, "youngs_modulus"), self._tensor(tensors, "poissons_ratio")
        mu = young / (2 * (1 + poisson))
        lame_lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        return [
            tensors[name]
            if name in tensors
            else base + by_mu * mu + by_lambda * lame_lambda + by_young * young + by_poisson * poisson
            for name, (base, by_mu, by_lambda, by_young, by_poisson) in self._conversion.items()
        ]

    def numbers(self) -> dict[str, NDArray[np.float64]] | None:
        """The constants as they are now; None where torch.func has wrapped one, which cannot be read then."""
        if not all(is_readable(tensor) for tensor in self.tensors.values()):
            return None
        names = (constant.name for constant in self.info.constants)
        return {name: tensor.detach().numpy() for name, tensor in zip(names, self.own(), strict=True)}

    def versions(self) -> list[int]:
        """Differ when an optimiser has changed a constant."""
        return [tensor._version for tensor in self.tensors.values()]

    def _check(self) -> None:
        """Refuses tensors whose values are out of bounds; those that torch.func has wrapped cannot be read."""
        if all(is_readable(tensor) for tensor in self.tensors.values()):
            values = {name: tensor.detach().double().numpy() for name, tensor in self.tensors.items()}
            own_constants(self.info, {**self._given, **values})

    def _tensor(self, tensors: Tensors, name: str, fallback: float | None = None) -> torch.Tensor:
        if name not in tensors and name not in self._given and fallback is None:
            refuse(f"{self.info.name}.{name}", "a number or a tensor", "nothing", f"add {name}")
        return tensors[name] if name in tensors else torch.from_numpy(self._given.get(name, np.array(fallback)))


def constants_of_a_unit_solid(info: _core.LawInfo) -> dict[str, NDArray[np.float64]]:
    """Constants of the law's formula for mu = lambda = 1 Pa: those of no material, but allowed."""
    fallbacks = {constant.name: constant.fallback for constant in info.constants if constant.is_free}
    free = {name: np.array(1.0 if value is None else value) for name, value in fallbacks.items()}
    return _converted(info, (1.0, 1.0), free)


def split_constants(
    law: str, given: Mapping[str, object], fibres: object
) -> tuple[dict[str, object], dict[str, torch.Tensor], object]:
    """The rest of `given` as arrays, what autograd follows, {name: tensor}, and `fibres` as an array."""
    rest: dict[str, object] = {}
    tensors = {}
    for name, value in given.items():
        if not isinstance(value, torch.Tensor):
            rest[name] = value
            continue
        tensor = real_tensor(value, f"{law}.{name}")
        if tensor.requires_grad or is_forward_mode() or not is_readable(tensor):
            tensors[name] = tensor
        else:
            rest[name] = tensor.numpy()
    if isinstance(fibres, torch.Tensor):
        if fibres.requires_grad:
            refuse(f"{law}.fibres", "directions that do not require grad", "a tensor that does", "use fibres.detach()")
        fibres = real_tensor(fibres, f"{law}.fibres").numpy()
    return rest, tensors, fibres


def _conversion_from_young_poisson(given: Arrays, tensors: Tensors, info: _core.LawInfo) -> Conversion:
    """{own constant: (base, by_mu, by_lambda, by_young, by_poisson)}: own = base + by_mu mu + by_lambda lambda, for
    Hooke's mu and lambda, or Young's modulus or Poisson's ratio itself."""
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
    zero, one = (_tensor_of(value) for value in (0.0, 1.0))
    for name in at_11:
        # Young's modulus and Poisson's ratio of mu = 1 and lambda = 1, 4; those of 2 and 2 are 5 and 1/4
        samples = [at[name] for at in (at_11, at_14, at_22)]
        if all(np.allclose(at, E, 1e-12, 0) for at, E in zip(samples, (2.5, 2.8, 5.0), strict=True)):
            conversion[name] = zero, zero, zero, one, zero
            continue
        if all(np.allclose(at, nu, 1e-12, 0) for at, nu in zip(samples, (0.25, 0.4, 0.25), strict=True)):
            conversion[name] = zero, zero, zero, zero, one
            continue
        by_lambda = (at_14[name] - at_11[name]) / 3
        by_both = at_22[name] - at_11[name]
        base, by_mu = at_11[name] - by_both, by_both - by_lambda
        conversion[name] = _tensor_of(base), _tensor_of(by_mu), _tensor_of(by_lambda), zero, zero
    return conversion


def _tensor_of(values: Any) -> torch.Tensor:
    return torch.from_numpy(np.asarray(values))


def _converted(info: _core.LawInfo, hooke: tuple[float, float], free: Arrays) -> dict[str, NDArray[np.float64]]:
    shape = common_shape(free, info.name)
    rows = np.empty((len(info.constants), math.prod(shape)))
    spread = [array if array.ndim == 0 else spread_over(array, shape) for array in free.values()]
    _core.convert_constants(info, *hooke, spread, rows)
    return {constant.name: row.reshape(shape) for constant, row in zip(info.constants, rows, strict=True)}
