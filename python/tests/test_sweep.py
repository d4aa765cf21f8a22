"""Many scenes from Python: the same folder and the same numbers as the command line."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import resilin

MODULUS = "body.sheet.material.youngs_modulus"
RATIO = "body.sheet.material.poissons_ratio"


def sheet(**more):
    """Two triangles that are pulled."""
    return {
        "simulation": {"dimension": 2},
        "body": [
            {
                "name": "sheet",
                "element": "P1",
                "mesh": {"box": {"size": [1, 1], "cells": [1, 1]}},
                "material": {"law": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3},
            }
        ],
        "fix": [
            {"name": "held", "where": {"group": "x_min"}},
            {"name": "pulled", "where": {"group": "x_max"}, "displacement": [0.1, 0]},
        ],
        "probe": [{"name": "corner", "at": [1, 1]}],
        **more,
    }


def test_scenes_are_those_of_run(tmp_path):
    values = np.geomspace(1e5, 1e7, 4)
    table = resilin.sweep(sheet(), {MODULUS: values, RATIO: [0.1, 0.4]}, out=tmp_path / "out")
    assert table.num_rows == 8
    assert set(table["status"]) == {"done"}
    np.testing.assert_array_equal(table[MODULUS], np.repeat(values, 2))
    for row in range(8):
        overrides = {MODULUS: float(table[MODULUS][row]), RATIO: float(table[RATIO][row])}
        frame = resilin.run(sheet(), overrides=overrides).report["frames"][-1]
        assert table["reaction.pulled.x"][row] == frame["reactions"]["pulled"][0]
        assert table["probe.corner.displacement.x"][row] == frame["probes"]["corner"]["displacement"][0]
        assert table["energy.elastic"][row] == frame["energy"]["elastic"]


def test_a_folder_may_be_left_out_and_goes_with_the_table():
    table = resilin.sweep(sheet(), {MODULUS: [1e5]})
    folder = table.folder
    assert folder.exists()
    del table
    assert not folder.exists()


def test_nothing_is_run_again_here_or_on_the_command_line(tmp_path):
    (tmp_path / "sheet.toml").write_text(
        "[simulation]\ndimension = 2\n[[body]]\nname = 'sheet'\nelement = 'P1'\n"
        "mesh = { box = { size = [1, 1], cells = [1, 1] } }\nmaterial = { poissons_ratio = 0.3 }\n"
        "[[fix]]\nname = 'held'\nwhere = { group = 'x_min' }\n"
        "[[load]]\nkind = 'traction'\nwhere = { group = 'x_max' }\nvalue = [1000, 0]\n"
    )
    (tmp_path / "sweep.toml").write_text(f"base = 'sheet.toml'\n[parameters]\n{MODULUS} = [1e5, 1e6, 1e7]\n")
    table = resilin.sweep(tmp_path / "sweep.toml", out=tmp_path / "out")
    assert table.num_rows == 3
    rows = (tmp_path / "out" / "results.csv").read_text()
    command = [sys.executable, "-m", "resilin", "sweep", "sweep.toml", "--out", "out"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "3 of 3 done; 0 run here" in done.stdout
    # The same sweep, said in Python, is the same sweep.
    again = resilin.sweep(tmp_path / "sheet.toml", {MODULUS: [1e5, 1e6, 1e7]}, out=tmp_path / "out")
    assert again.num_rows == 3
    assert (tmp_path / "out" / "results.csv").read_text() == rows


def test_failed_scenes_are_rows_with_their_reason(tmp_path):
    table = resilin.sweep(sheet(), {RATIO: [0.3, 0.7]}, out=tmp_path / "out")
    assert list(table["status"]) == ["done", "refused"]
    assert list(table.failed) == [1]
    assert "poissons_ratio" in table.failed[1]
    assert np.isnan(table["reaction.pulled.x"][1])
    rows = len(list((tmp_path / "out" / "rows").iterdir()))
    resilin.sweep(sheet(), {RATIO: [0.3, 0.7]}, out=tmp_path / "out")
    assert len(list((tmp_path / "out" / "rows").iterdir())) == rows
    resilin.sweep(sheet(), {RATIO: [0.3, 0.7]}, out=tmp_path / "out", retry_failed=True)
    assert len(list((tmp_path / "out" / "rows").iterdir())) == rows + 1


def test_meshes_vectors_and_laws_vary(tmp_path):
    meshes = [resilin.Mesh.rectangle((1, 1), (n, n)) for n in (1, 2)]
    scene = sheet()
    scene["fix"][0]["where"] = {"plane": {"axis": "x", "at": 0}}
    scene["fix"][1]["where"] = {"plane": {"axis": "x", "at": 1}}
    table = resilin.sweep(
        scene,
        {
            "body.sheet.mesh": meshes,
            "fix.pulled.displacement": [[0.1, 0.0], [0.2, 0.1]],
            "body.sheet.material.law": ["neo_hookean", "linear_elastic"],
        },
        out=tmp_path / "out",
    )
    assert table.num_rows == 8
    assert set(table["unknowns"]) == {0, 6}
    assert list(table["fix.pulled.displacement"][2]) == [0.2, 0.1]
    assert set(table["body.sheet.material.law"]) == {"neo_hookean", "linear_elastic"}
    assert len(set(table["body.sheet.mesh"])) == 2


def test_sequences_draw_the_same_scenes_every_time(tmp_path):
    def draw(seed):
        parameters = {MODULUS: {"log_uniform": [1e5, 1e6]}, RATIO: {"uniform": [0, 0.4]}}
        return resilin.sweep(sheet(), parameters, method="sobol", samples=8, seed=seed)

    first, again, other = draw(1), draw(1), draw(2)
    np.testing.assert_array_equal(first[MODULUS], again[MODULUS])
    assert not np.any(first[MODULUS] == other[MODULUS])
    assert np.all((first[RATIO] >= 0) & (first[RATIO] < 0.4))


def test_results_that_are_kept_have_fields(tmp_path):
    scene = sheet(output={"formats": ["vtu"]})
    table = resilin.sweep(scene, {MODULUS: [1e5, 1e6]}, keep=[1], out=tmp_path / "out")
    expected = resilin.run(scene, overrides={MODULUS: 1e6})
    np.testing.assert_allclose(table.field(1, "displacement"), expected.fields["displacement"][-1], atol=1e-15)
    np.testing.assert_allclose(table.field(1, "von_mises"), expected.fields["von_mises"][-1], rtol=1e-9)
    np.testing.assert_array_equal(table.rest_positions(1), expected.positions[0])
    with pytest.raises(resilin.InputError, match="whose results were kept"):
        table.field(0, "displacement")


def test_quantities_over_all_steps_are_lists(tmp_path):
    quantities = ["load", {"name": "pull", "of": "reaction.pulled.x", "over": "all"}]
    scene = sheet(simulation={"dimension": 2, "load_steps": 4})
    table = resilin.sweep(scene, {RATIO: [0.3, 0.6]}, quantities=quantities, out=tmp_path / "out")
    assert len(table["pull"][0]) == 5
    assert np.all(np.diff(table["pull"][0]) > 0)
    assert table["load"][0] == 1


def test_tables_are_written_as_parquet(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    quantities = ["load", {"name": "pull", "of": "reaction.pulled.x", "over": "all"}]
    table = resilin.sweep(
        sheet(), {RATIO: [0.3, 0.6], "title": ["a", 'b, "c"']}, quantities=quantities, out=tmp_path / "out"
    )
    path = table.to_parquet()
    assert path == tmp_path / "out" / "results.parquet"
    read = parquet.read_table(path).to_pydict()
    assert read["title"] == ["a", 'b, "c"'] * 2
    assert read[RATIO] == [0.3, 0.3, 0.6, 0.6]
    assert read["scene"] == [0, 1, 2, 3]
    np.testing.assert_array_equal(read["pull"][0], table["pull"][0])
    assert read["pull"][2] is None


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"body.sheet.material.youngs_modulos": [1e5]}, 'did you mean "youngs_modulus"'),
        ({MODULUS: []}, "at least one value"),
        ({MODULUS: 1e5}, "a list of values"),
        ({}, "keys of the scene"),
        (None, "a dict of keys"),
        ({MODULUS: {"uniform": [1, 2]}}, "draws from intervals"),
    ],
)
def test_bad_parameters_are_refused_in_one_line(tmp_path, parameters, message):
    with pytest.raises(resilin.InputError, match=message) as error:
        resilin.sweep(sheet(), parameters, out=tmp_path / "out")
    assert "\n" not in str(error.value)
    assert not (tmp_path / "out").exists()


def test_another_sweep_and_another_version_are_refused(tmp_path):
    resilin.sweep(sheet(), {MODULUS: [1e5]}, out=tmp_path / "out")
    with pytest.raises(resilin.InputError, match="a folder of this sweep"):
        resilin.sweep(sheet(), {MODULUS: [1e6]}, out=tmp_path / "out")
    manifest = tmp_path / "out" / "sweep.json"
    content = json.loads(manifest.read_text())
    content["identity"][0][1] = "0.0.7"
    manifest.write_text(json.dumps(content))
    with pytest.raises(resilin.InputError, match="run the same version everywhere"):
        resilin.sweep(sheet(), {MODULUS: [1e5]}, out=tmp_path / "out")
    with pytest.raises(resilin.InputError, match=r"results\.csv"):
        resilin.read_sweep(tmp_path)


def test_a_progress_line_is_printed_where_it_is_asked_for(tmp_path, capfd):
    resilin.sweep(sheet(), {MODULUS: [1e5, 1e6]}, out=tmp_path / "out", progress=True)
    assert "2 of 2 done" in capfd.readouterr().out
    resilin.sweep(sheet(), {MODULUS: [1e5, 1e6]}, out=tmp_path / "out")
    assert capfd.readouterr().out == ""


def test_names_may_hold_anything(tmp_path):
    scene = sheet()
    scene["body"][0]["name"] = scene["probe"][0]["body"] = 'a.b, "c" \u00e4\n'
    for fix in scene["fix"]:
        fix["body"] = scene["body"][0]["name"]
    out = tmp_path / 'o u, t"\u00e4'
    table = resilin.sweep(scene, {"body.0.scale": [1.0, 2.0], "title": ["\u00fc,\n"]}, out=out)
    assert table.num_rows == 2
    assert table["title"][0].startswith("\u00fc,")
    assert os.path.exists(out / "results.csv")
