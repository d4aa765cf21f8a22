"""What the core has to choose from, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from resilin import _core
from resilin.arrays import refuse

if TYPE_CHECKING:
    from resilin.typing import Projection

PROJECTIONS: dict[Projection, _core.Projection] = {
    None: _core.Projection.none,
    "clamp": _core.Projection.clamp,
    "absolute": _core.Projection.absolute,
}


def projection_named(name: Projection) -> _core.Projection:
    """The core's Projection of this name."""
    if name not in PROJECTIONS:
        refuse("projection", 'None, "clamp" or "absolute"', repr(name))
    return PROJECTIONS[name]


def laws() -> dict[str, _core.LawInfo]:
    """Every law by name, {name: LawInfo}: formula, source, constants with units, behaviour under inversion."""
    return {law.name: law for law in _core.laws()}


def law_table() -> str:
    """What help(Material) says about each law."""
    lines = ["Laws", "----"]
    for law in laws().values():
        lines += [law.name, f"    Psi = {law.formula}", *(f"    {_described(constant)}" for constant in law.constants)]
        if law.max_fibres > 0:
            lines.append(f"    Fibres: up to {law.max_fibres} families.")
        if law.only_poissons_ratio is not None:
            lines.append(f"    Poisson's ratio: {law.only_poissons_ratio:g} only.")
        lines += [f"    Inversion: {law.inversion}.", f"    Source: {law.source}."]
    return "\n".join(lines) + "\n"


def _described(constant: _core.LawConstant) -> str:
    text = f"{constant.name} = {constant.meaning}: {constant.range}"
    if constant.is_free:
        text += ", also beside youngs_modulus and poissons_ratio"
    return text if constant.fallback is None else text + f"; {constant.fallback:g} unless given"
