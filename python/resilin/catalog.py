"""Catalogues of the core, by name."""

from __future__ import annotations

import inspect
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
    """Lists all constitutive models.

    Returns
    -------
    dict
        {name: LawInfo}: title, formula, source, constants with units, behaviour under inversion.
    """
    return {law.name: law for law in _core.laws()}


class HelpWithLaws:
    """A docstring that closes with a table of the laws, which is made when somebody reads it."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __get__(self, _: object, owner: type) -> str:
        from resilin.law_table import law_table

        return f"{inspect.cleandoc(self._text)}\n\n{law_table(laws())}"
