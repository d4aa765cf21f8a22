"""Loads NumPy and the core.

OpenBLAS, in both, starts a thread for each core as it is loaded, each with 128 MiB of its own; where the address space
is limited (`ulimit -v`) and cannot have them, the process ends by a signal, or never. Our core has no use for these
threads, and NumPy can do without.

OpenBLAS also takes old kernels on processors that are newer than itself. `resilin` puts that right in the command line;
here where its OpenBLAS is none that NumPy or another has had before, and may be computing with.
"""

import contextlib
import importlib
import os
import pathlib
import resource

_NO_THREADS = {"OPENBLAS_NUM_THREADS": "1", "OMP_THREAD_LIMIT": "1"}


def _is_limited() -> bool:
    limits = (resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA))
    return any(limit != resource.RLIM_INFINITY for limit in limits)


def _openblas_files() -> set[str]:
    """The libraries of that name that the process holds."""
    try:
        lines = pathlib.Path("/proc/self/maps").read_text().splitlines()
    except OSError:
        return set()
    files = (line.split()[-1] for line in lines)
    return {file for file in files if "openblas" in file}


def _load() -> None:
    importlib.import_module("numpy")
    of_others = _openblas_files()
    core = importlib.import_module("resilin._core")
    if _openblas_files() - of_others:
        with contextlib.suppress(core.InputError):  # a wrong RESILIN_ISA is told of where it is first asked for
            core.choose_blas_kernel()


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
else:
    _load()
