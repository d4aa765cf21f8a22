"""README.md and examples/python do what they say."""

import pathlib
import re
import runpy
import warnings
from importlib.util import find_spec

import numpy as np
import pytest
from scenes import square

import resilin

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def test_forty_lines_of_scipy_step_like_the_built_in_solver():
    example = runpy.run_path(str(ROOT / "examples" / "python" / "square.py"))
    assert (ROOT / "examples" / "python" / "square.py").read_text().count("\n") < 40
    result = resilin.run(square() | {"newton": {"tolerance": 1e-13}})
    x, v = example["start"], np.zeros_like(example["start"])
    for i in range(1, len(result.times)):
        x, v = example["step"](x, v)
        # Each step of either is solved to about 1e-12 m; velocities are differences of positions over 0.01 s.
        np.testing.assert_allclose(x, result.positions[i], rtol=0, atol=1e-10)
        np.testing.assert_allclose(v, result.velocities[i], rtol=0, atol=1e-8)


def test_the_picture_of_curves_is_drawn(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib").use("Agg")
    picture = tmp_path / "curves.png"
    monkeypatch.setattr("sys.argv", ["curves.py", str(picture)])
    with warnings.catch_warnings():  # the example silences them
        figure = runpy.run_path(str(ROOT / "examples" / "python" / "curves.py"))["figure"]
    assert picture.read_bytes().startswith(b"\x89PNG")
    for ax in figure.axes:
        drawn = {line.get_label() for line in ax.lines} - {"_unstable"}
        assert drawn == {
            "neo_hookean",
            "neo_hookean_isochoric",
            "mooney_rivlin",
            "yeoh",
            "ogden",
            "arruda_boyce",
            "gent",
        }


def test_the_story_of_the_cantilever_is_told(tmp_path):
    story = runpy.run_path(str(ROOT / "examples" / "cantilever_story" / "story.py"))
    linear, rubber = story["results"]["linear_elastic"], story["results"]["neo_hookean"]
    assert linear.report["is_linear"] and not rubber.report["is_linear"]
    is_inverted = linear.fields["volume_ratio"].min(axis=1) < 0
    np.testing.assert_array_equal(is_inverted, linear.loads > story["inversion_load"])
    assert rubber.fields["volume_ratio"].min() > 0.3
    assert len(list(story["table"]())) == 12
    if find_spec("matplotlib") is not None:
        story["draw"](tmp_path / "sag.png")
        assert (tmp_path / "sag.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("page", ["README.md", "docs/python.md", "docs/materials.md", "docs/gradients.md"])
def test_the_python_lines_of_a_page_run(page, tmp_path, monkeypatch):
    text = (ROOT / page).read_text(encoding="utf-8")
    scene = re.search(r"```toml\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "beam.toml").write_text(scene.group(1), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    blocks = BLOCK.findall(text)
    assert blocks
    names = {}
    for block in blocks:  # one program, as a reader would type it
        if "import torch" in block and find_spec("torch") is None:
            continue
        exec(compile(block, page, "exec"), names)


def test_perforated_sheets_soften_with_their_holes(tmp_path):
    pytest.importorskip("matplotlib").use("Agg")
    h5py = pytest.importorskip("h5py")
    example = runpy.run_path(str(ROOT / "examples" / "python" / "perforated_sheet.py"))
    parameters, table = example["main"](tmp_path, 12)
    assert set(table["status"]) == {"done"}
    assert (tmp_path / "stiffness.png").read_bytes().startswith(b"\x89PNG")
    stiffness = example["stiffness"](table, 1)
    assert np.all((stiffness > 0) & (stiffness < 1))
    # More and rounder holes leave less: but for noise the order is that of the share.
    share = parameters[:, 0] ** 2 * parameters[:, 1]
    assert np.corrcoef(share, stiffness)[0, 1] < -0.9
    with h5py.File(tmp_path / "perforated_sheet.h5") as file:
        assert file["displacements"].shape[0] == len(file["parameters"]) == 12
        moved = file["rest_positions"][:] + file["displacements"][:]
        right = file["rest_positions"][0, :, 0] > 1 - 1e-9
        np.testing.assert_allclose(moved[:, right, 0], 1.15, rtol=1e-9)


def test_the_arm_of_the_task_reaches_its_targets_and_can_do_so_again():
    example = runpy.run_path(str(ROOT / "examples" / "python" / "reach.py"))
    environment = example["ReachTip"]()
    first = [example["play"](environment, seed) for seed in range(5)]
    for steps, distance in first:
        assert 1 < steps < environment.most_steps
        assert distance < environment.tolerance
    assert [example["play"](environment, seed) for seed in range(5)] == first  # a reset leaves nothing behind
