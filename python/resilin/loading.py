"""Loads NumPy and the core where the address space is limited (`ulimit -v`).

OpenBLAS, in both, starts a thread for each core as it is loaded, each with 128 MiB of its own; where it cannot have
them the process ends by a signal, or never. Our core has no use for these threads, and NumPy can do without.
"""

import importlib
import os
import resource

_NO_THREADS = {"OPENBLAS_NUM_THREADS": "1", "OMP_THREAD_LIMIT": "1"}


def _is_limited() -> bool:
    limits = (resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA))
    return any(limit != resource.RLIM_INFINITY for limit in limits)


def _load() -> None:
    for name in ("numpy", "resilin._core"):
        importlib.import_module(name)


def _load_without_threads() -> None:
    before = {name: os.environ.get(name) for name in _NO_THREADS}
    os.environ.update(_NO_THREADS)
    try:
        _load()
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


if _is_limited():
    _load_without_threads()
