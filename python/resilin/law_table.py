"""Text of help(Material) about the laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from resilin import _core


def law_table(laws: Mapping[str, _core.LawInfo]) -> str:
    """Table of all laws and their constants."""
    lines = ["Laws", "----"]
    for law in laws.values():
        lines += [
            f"{law.name} ({law.title})",
            f"    Psi = {law.formula}",
            *(f"    {_described(constant)}" for constant in law.constants),
        ]
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
