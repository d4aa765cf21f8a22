"""The schema of the scene file, by a validator that is not ours."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest
from toml_reader import tomllib

import resilin
from resilin.__main__ import PROGRAM

jsonschema = pytest.importorskip("jsonschema")
ROOT = pathlib.Path(__file__).resolve().parents[2]


TAPLO = shutil.which("taplo", path=os.pathsep.join([str(pathlib.Path(sys.executable).parent), os.environ["PATH"]]))


def schema_text():
    return subprocess.run([PROGRAM, "info", "--schema"], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def validator():
    schema = json.loads(schema_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def scenes():
    places = ("examples/*.toml", "validation/*/scene.toml", "tests/scene/scenes/*.toml")
    found = [path for place in places for path in ROOT.glob(place)]
    return sorted(path for path in found if not path.name.startswith("fit_"))


def test_every_scene_here_is_valid(validator):
    assert len(scenes()) > 30
    for path in scenes():
        faults = [error.message for error in validator.iter_errors(tomllib.loads(path.read_text()))]
        assert faults == [], path


GOOD = """
[simulation]
kind = "static"
[[body]]
mesh = { box = { size = [1, 1, 1], cells = [2, 2, 2] } }
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3 }
"""


@pytest.mark.parametrize(
    ("wrong", "place"),
    [
        (GOOD.replace("kind =", "kynd ="), ["simulation"]),
        (GOOD.replace("static", "statics"), ["simulation", "kind"]),
        (GOOD.replace("neo_hookean", "neo_hooke"), ["body", 0, "material", "law"]),
        (GOOD + 'element = "P3"\n', ["body", 0, "element"]),
        (GOOD + "scale = -1\n", ["body", 0, "scale"]),
        (GOOD + "[newton]\ntolerance = true\n", ["newton", "tolerance"]),
        ("[simulation]\nkind = 'static'\n", []),
    ],
)
def test_what_is_wrong_is_marked_where_it_stands_and_refused_by_the_reader(validator, wrong, place):
    assert list(validator.iter_errors(tomllib.loads(GOOD))) == []
    faults = list(validator.iter_errors(tomllib.loads(wrong)))
    assert place in [list(error.absolute_path) for error in faults]
    with pytest.raises(resilin.InputError):
        resilin.Simulation(tomllib.loads(wrong))


@pytest.mark.skipif(TAPLO is None, reason="needs taplo")
def test_taplo_takes_the_settings_of_the_page_passes_scenes_and_marks_a_wrong_key(tmp_path):
    page = (ROOT / "docs" / "editors.md").read_text()
    settings = re.search(r"```toml\n(\[\[rule\]\].*?)```", page, re.DOTALL).group(1)
    (tmp_path / ".taplo.toml").write_text(settings)
    (tmp_path / "scene.schema.json").write_text(schema_text())
    for path in scenes():
        place = tmp_path / path.parent.name / path.name
        place.parent.mkdir(exist_ok=True)
        place.write_text(path.read_text())

    def lint(*files):
        run = subprocess.run([TAPLO, "lint", *files], cwd=tmp_path, capture_output=True, text=True, check=False)
        return run.returncode, run.stderr

    code, words = lint()
    assert (code, f"total={len(scenes()) + 1} " in words) == (0, True), words
    (tmp_path / "wrong.toml").write_text(GOOD.replace("youngs_modulus", "young_modulus"))
    code, words = lint("wrong.toml")
    assert code == 1
    assert "young_modulus" in words
    (tmp_path / "named.toml").write_text("#:schema scene.schema.json\n" + GOOD.replace("static", "statics"))
    (tmp_path / ".taplo.toml").unlink()
    assert lint("named.toml")[0] == 1
    assert lint("wrong.toml")[0] == 0  # nothing names its schema now
