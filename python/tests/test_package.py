import ast
import importlib.metadata
import os
import pathlib
import re
import subprocess
import sys

import pytest

import resilin

FOLDER = pathlib.Path(resilin.__file__).parent


def python(code, environment=None):
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    return run.stdout.strip()


def test_importing_leaves_big_packages_alone():
    """A quick import needs nothing but numpy, the extension and our own modules is read."""
    code = """
import sys, numpy
before = {name.split(".")[0] for name in sys.modules}
import resilin
loaded = {name.split(".")[0] for name in sys.modules} - before - set(sys.stdlib_module_names)
print(*sorted(loaded))
"""
    assert python(code) == "resilin"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks /proc")
def test_the_direct_solver_uses_kernels_of_the_processor_unless_it_shares_them():
    """RESILIN_ISA chooses the kernels of an OpenBLAS of our own; a shared one keeps the kernels that it had."""
    code = """
import pathlib, numpy
def libraries():
    return {line.split()[-1] for line in pathlib.Path("/proc/self/maps").read_text().splitlines() if "openblas" in line}
before = libraries()
import resilin
print(bool(libraries() - before), resilin._core.blas_kernel_name())
"""
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    cores = {"baseline": "Prescott", "avx2": "Haswell", "avx512": "SkylakeX"}
    kernels = {
        name: python(code, environment | {"RESILIN_ISA": name}) for name in resilin._core.available_instruction_sets()
    }
    if all(kernel.startswith("True") for kernel in kernels.values()):
        assert kernels == {name: f"True OpenBLAS {cores[name]}" for name in kernels}
    else:
        assert len(set(kernels.values())) == 1


def test_the_version_is_that_of_the_distribution():
    assert re.fullmatch(r"\d+\.\d+\.\d+", resilin.__version__)
    try:
        distribution = importlib.metadata.distribution("resilin")
    except importlib.metadata.PackageNotFoundError:
        return  # the package is used from a build folder
    assert distribution.version == resilin.__version__


def test_everything_promised_is_there():
    for name in resilin.__all__:
        assert getattr(resilin, name) is not None
    assert (FOLDER / "py.typed").exists()


def names_in_stub():
    """{name: set of members} of the classes and functions of _core.pyi."""
    tree = ast.parse((FOLDER / "_core.pyi").read_text())
    found = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found[node.name] = {child.name for child in getattr(node, "body", []) if isinstance(child, ast.FunctionDef)}
    return found


def test_the_type_stub_is_that_of_this_extension():
    from resilin import _core

    stub = names_in_stub()
    public = {name for name in vars(_core) if not name.startswith("_")}
    assert public == stub.keys()
    for name, members in stub.items():
        if isinstance(vars(_core)[name], type) and not issubclass(vars(_core)[name], Exception):
            there = {member for member in vars(vars(_core)[name]) if not member.startswith("_")}
            assert {m for m in members if not m.startswith("_")} <= there


def test_bundled_libraries_are_listed_with_their_licences():
    """In a wheel: every library that it carries is named in the list, and none is under the GPL alone."""
    libraries = FOLDER.parent / "resilin.libs"
    if not libraries.exists():
        assert "build" in FOLDER.parts or "site-packages" in FOLDER.parts  # not a repaired wheel
        return
    lists = [f for f in importlib.metadata.files("resilin") if f.name == "bundled-libraries.txt"]
    text = lists[0].read_text()
    names = [library.name for library in libraries.iterdir()]
    assert names
    for name in names:
        assert name in text
        assert "cholmod" not in name


@pytest.mark.parametrize("wrong", [0, -1, 1.5, "2", 10**9])
def test_the_number_of_threads_is_a_whole_number(wrong):
    with pytest.raises(resilin.InputError, match="a whole number from 1 to 1024"):
        resilin.set_num_threads(wrong)


@pytest.mark.parametrize("wrong", ["0", "-1", "1000000", "abc"])
def test_a_wrong_number_of_threads_in_the_environment_is_told_in_one_line(wrong):
    run = subprocess.run(
        [sys.executable, "-c", "import resilin"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "RESILIN_THREADS": wrong},
    )
    assert run.returncode == 1
    last = run.stderr.strip().splitlines()[-1]
    expected = f'environment variable RESILIN_THREADS: expected a whole number from 1 to 1024, got "{wrong}"'
    assert last.endswith(f"InputError: {expected}; correct it or unset it")
