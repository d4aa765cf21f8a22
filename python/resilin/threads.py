"""How many threads the core uses."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from resilin import _core
from resilin.arrays import refuse

if TYPE_CHECKING:
    from typing import SupportsIndex

_core.num_threads()  # a RESILIN_THREADS that is wrong is told before any work is done


def num_threads() -> int:
    """Number of threads of parallel loops.

    All cores unless `set_num_threads` was called or the environment variable RESILIN_THREADS says otherwise.
    """
    return _core.num_threads()


def set_num_threads(count: SupportsIndex) -> None:
    """Limits later computations to `count` threads; results are bitwise equal for any number."""
    try:
        number = operator.index(count)
    except TypeError:
        number = 0
    if not 1 <= number <= _core.max_threads():
        refuse("count", f"a whole number from 1 to {_core.max_threads()}", repr(count))
    _core.set_num_threads(number)
