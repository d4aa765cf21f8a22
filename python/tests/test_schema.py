"""The schema of the scene file, by a validator that is not ours."""

import json
import pathlib
import subprocess

import pytest
from toml_reader import tomllib

import resilin
from resilin.__main__ import PROGRAM

jsonschema = pytest.importorskip("jsonschema")
ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def validator():
    text = subprocess.run([PROGRAM, "info", "--schema"], capture_output=True, text=True, check=True).stdout
    schema = json.loads(text)
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
