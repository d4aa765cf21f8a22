"""The types of the package: sound in themselves, of use to a strict type checker, and true when a program runs."""

import os
import pathlib
import re
import runpy
import subprocess
import sys
import typing
from importlib.util import find_spec

import numpy as np
import pytest
from scenes import cantilever, square

import resilin
import resilin.typing

TESTS = pathlib.Path(__file__).parent
ROOT = TESTS.parents[1]
SCRIPT = TESTS / "typed_user_script.py"
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


@pytest.fixture(scope="session")
def check_types(tmp_path_factory):
    """Runs mypy and gives what it says: as a user of this interpreter has it, without a configuration of ours."""
    pytest.importorskip("mypy")
    cache = tmp_path_factory.mktemp("mypy")

    def run(*arguments, configuration="", search=""):
        options = ["--strict", "--no-error-summary", f"--cache-dir={cache}", f"--config-file={configuration}"]
        command = [sys.executable, "-m", "mypy", *options, *map(str, arguments)]
        # From a folder without packages: `resilin` is the one that the tests import, by PYTHONPATH or installed.
        environment = {**os.environ, "MYPYPATH": str(search)}
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=cache, env=environment)
        assert done.returncode in (0, 1), done.stdout + done.stderr
        return done.stdout.splitlines()

    return run


def test_the_package_is_sound_to_a_strict_type_checker(check_types):
    assert check_types("-p", "resilin", configuration=ROOT / "pyproject.toml") == []


def test_a_users_script_is_sound_to_a_strict_type_checker(check_types):
    assert check_types(SCRIPT) == []


def test_the_users_script_runs(tmp_path):
    runpy.run_path(str(SCRIPT))["main"](tmp_path)


def test_the_python_lines_of_the_manual_are_sound_to_a_strict_type_checker(check_types, tmp_path):
    """Block by block as a reader types them; names keep the types of the blocks before."""
    blocks = BLOCK.findall((ROOT / "docs" / "python.md").read_text(encoding="utf-8"))
    page = tmp_path / "page.py"
    known = [block for block in blocks if "import torch" not in block or find_spec("torch")]
    page.write_text("\n".join(known), encoding="utf-8")
    assert check_types("--allow-redefinition", page) == []


MISTAKES = """
import numpy as np
import resilin
mesh = resilin.Mesh.box((1, 1, 1), (1, 1, 1), pattern="kuhn")
law = resilin.Material("gent", youngs_modulus="1e6", poissons_ratio=0.4)
law.energy_density("F")
law.energy_density(np.eye(3)).upper()
law.energy_density(np.eye(3), out=mesh.cells)
law.stress_tangent(np.eye(3), "clmap")
law.stress_tangents(np.eye(3))
law.curve("uniaxail")
law.curve("uniaxial").stretch = np.ones(3)
body = resilin.Elastic(law, mesh)
body.value(mesh)
body.mass(kind="consistant")
body.gradient(mesh.positions, "clamp")
rows, columns = body.hessian(mesh.positions, as_triplets=True)
mesh.positions = np.eye(3)
mesh.cells["tetrahedron"]
result = resilin.run({"simulation": {}}, overides={})
result.report["frmes"]
result.report["frames"][0]["energy"]["elastic"].upper()
result.status == "don"
result.fields[0]
result.plot("von_mises", vew="front")
resilin.picture("out", map="jet").png()
resilin.run(42)
resilin.Simulation("beam.toml").step().residuals
resilin.Simulation("beam.toml").set_material("beam", "neo_hookean")
resilin.set_num_threads("all")
resilin.embed(mesh, ["a"])
"""


def test_a_type_checker_sees_mistakes(check_types, tmp_path):
    """One in each line after the imports; were the types `Any`, it would see none."""
    script = tmp_path / "mistakes.py"
    script.write_text(MISTAKES, encoding="utf-8")
    lines = [re.search(r":(\d+): error: ", line) for line in check_types(script)]
    wrong = {int(line[1]) for line in lines if line}
    assert wrong == {number for number, line in enumerate(MISTAKES.splitlines(), 1) if line and "import" not in line}


TORCH = """
class Tensor:
    requires_grad: bool
    def double(self) -> "Tensor": ...
    def __mul__(self, factor: float) -> "Tensor": ...
    def __array__(self) -> object: ...

class Parameter(Tensor): ...
"""
TENSORS = """
from typing_extensions import assert_type
import numpy as np
import resilin
import resilin.torch
import torch

def energies(F: torch.Tensor, E: torch.Parameter) -> None:
    law = resilin.Material("yeoh", youngs_modulus=E, poissons_ratio=0.45)
    assert_type(law.energy_density(F), torch.Tensor)
    assert_type(law.first_piola_kirchhoff_stress(E, out=F), torch.Tensor)
    assert_type(law.stress_tangent(F, "clamp"), torch.Tensor)
    assert_type(law.elastic_forces(F, F, np.ones(3)), torch.Tensor)
    assert_type(law.constant_derivatives(F), dict[str, tuple[torch.Tensor, torch.Tensor]])
    assert_type(resilin.torch.StableNeoHookean(E).energy_density(F), torch.Tensor)
    law.energy_density(F, out=np.empty(3))  # a mistake
    law.energy_density(np.eye(3), out=F)  # a mistake
"""


def test_tensors_give_tensors_to_a_type_checker(check_types, tmp_path):
    """With types of torch in their essence: what Debian packs has none, and a wheel's tests have no torch."""
    (tmp_path / "torch").mkdir()
    (tmp_path / "torch" / "__init__.pyi").write_text(TORCH, encoding="utf-8")
    script = tmp_path / "tensors.py"
    script.write_text(TENSORS, encoding="utf-8")
    lines = [re.search(r"tensors.py:(\d+): error: ", line) for line in check_types(script, search=tmp_path)]
    wrong = {int(line[1]) for line in lines if line}
    assert wrong == {number for number, line in enumerate(TENSORS.splitlines(), 1) if "# a mistake" in line}


def fits(value, kind):
    """Whether what JSON has brought is of a type of resilin.typing, key by key; otherwise says where it is not."""
    if typing.is_typeddict(kind):
        hints = typing.get_type_hints(kind)
        assert kind.__required_keys__ <= value.keys() <= hints.keys(), kind
        return all(fits(entry, hints[key]) for key, entry in value.items())
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Literal:
        assert value in arguments
    elif type(None) in arguments:
        return value is None or all(fits(value, argument) for argument in arguments if argument is not type(None))
    elif origin is list:
        assert type(value) is list
        return all(fits(entry, arguments[0]) for entry in value)
    elif origin is dict:
        assert type(value) is dict
        return all(fits(entry, arguments[1]) for entry in value.values())
    else:
        kinds = arguments or (kind,)
        assert type(value) in kinds or (float in kinds and type(value) is int), f"{value!r} is no {kind}"
    return True


def of_two_materials():
    scene = cantilever()
    half = {"where": {"box": [[-1, -1, -1], [0.5, 1, 1]]}, "material": scene["body"][0]["material"]}
    return scene | {"body": [scene["body"][0] | {"region": [half | {"name": "half"}]}]}


REPORTED = {
    "a static run with a probe, a section and results on vertices": cantilever()
    | {
        "section": [{"name": "middle", "body": "beam", "plane": {"axis": "x", "at": 0.45}}],
        "output": {"fields": ["von_mises", "nodal_von_mises"]},
    },
    "steps in time as long as an estimate allows": square(adaptive={"tolerance": 1e-2}, end_time=0.05),
    "free vibrations": cantilever(kind="modes", gravity=[0, 0, 0]),
    "a body of two materials": of_two_materials(),
}


@pytest.mark.parametrize("name", REPORTED)
def test_a_report_has_the_keys_and_types_that_are_promised(name):
    simulation = resilin.Simulation(REPORTED[name])
    assert fits(simulation.frame, resilin.typing.FrameReport)
    assert fits(simulation.bodies, list[resilin.typing.BodyReport])
    assert fits(simulation.fixes, list[resilin.typing.FixReport])
    assert fits(simulation.loads, list[resilin.typing.LoadReport])
    result = simulation.run()
    assert fits(result.report, resilin.typing.Report)
    assert fits(result.status, resilin.typing.RunStatus)


def names_in_refusal(action, *arguments, **options):
    """The words that a refusal offers."""
    with pytest.raises(resilin.InputError) as refusal:
        action(*arguments, **options)
    return set(re.search("expected (?:one of )?(.*), got", str(refusal.value))[1].replace(" or ", ", ").split(", "))


def names_in_type(kind):
    parts = typing.get_args(kind)
    return {"None" if kind is type(None) else kind} if not parts else set().union(*map(names_in_type, parts))


def test_names_in_types_are_those_that_the_core_knows():
    law = resilin.Material("neo_hookean", youngs_modulus=1e6, poissons_ratio=0.4)
    elastic = resilin.Elastic(resilin.Mesh.box((1, 1, 1), (1, 1, 1)), law)
    result = resilin.run(cantilever(), steps=1)
    known = {
        "CurveKind": names_in_refusal(law.curve, "no such"),
        "Projection": names_in_refusal(law.stress_tangent, np.eye(3), "no such"),
        "MassKind": names_in_refusal(elastic.mass, kind="no such"),
        "StressKind": names_in_refusal(law.curve("shear").plot, stress="no such"),
        "ColorMap": names_in_refusal(result.plot, map="no such"),
        "BoxPattern": names_in_refusal(resilin.Mesh.box, (1, 1, 1), (1, 1, 1), pattern="no such") | {"hexahedra"},
        "RectanglePattern": names_in_refusal(resilin.Mesh.rectangle, (1, 1), (1, 1), pattern="no such")
        | {"quadrilaterals"},
    }
    for name, words in known.items():
        assert names_in_type(getattr(resilin.typing, name)) == {word.strip('"') for word in words}
