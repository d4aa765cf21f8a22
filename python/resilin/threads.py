"""How many threads the core uses."""

import operator

from resilin import _core
from resilin.arrays import refuse


def num_threads():
    """Number of threads that loops use; all cores unless `set_num_threads` was called."""
    return _core.num_threads()


def set_num_threads(count):
    """Limits every later computation to `count` threads; results are the same bits for any number."""
    try:
        number = operator.index(count)
    except TypeError:
        number = 0
    if not 1 <= number <= 1024:
        refuse("count", "a whole number from 1 to 1024", repr(count))
    _core.set_num_threads(number)
