"""Resilin: hyperelastic solids with finite elements."""

from resilin._core import __version__
from resilin._core import law_names as laws

__all__ = ["__version__", "laws"]
