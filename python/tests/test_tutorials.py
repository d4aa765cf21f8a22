"""The notebooks run from their first cell to their last, as they are."""

import pathlib
import re

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples" / "notebooks"
TIME_LIMIT = 900  # [s] for a cell that hangs, on a busy machine


def test_there_are_some_and_they_hold_no_outputs():
    notebooks = sorted(FOLDER.glob("*.ipynb"))
    assert notebooks
    for path in notebooks:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        for cell in notebook.cells:
            assert cell.cell_type != "code" or (cell.outputs == [] and cell.execution_count is None)
            for target in re.findall(r"\]\(([^)#]+)", cell.source if cell.cell_type == "markdown" else ""):
                assert "://" in target or (FOLDER / target).exists(), target


def test_the_way_from_a_surface_to_a_stress():
    path = FOLDER / "from_surface_to_result.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=TIME_LIMIT, resources={"metadata": {"path": str(FOLDER)}}).execute()

    def outputs(words):
        (cell,) = [cell for cell in notebook.cells if cell.cell_type == "code" and words in cell.source]
        return cell.outputs

    def printed(words):
        return "".join(output.text for output in outputs(words) if output.get("name") == "stdout")

    shown = outputs("result = resilin.run")[-1].data["text/html"]
    assert shown.startswith("<iframe srcdoc=")
    assert len(shown) < 5e6
    assert "'done'" in outputs("result.status")[-1].data["text/plain"]
    for words in ("result.plot", "live.plot"):
        assert "image/png" in outputs(words)[-1].data
    assert "application/vnd.jupyter.widget-view+json" in outputs("live.view")[-1].data
    sags = [float(x) for x in re.findall(r"([\d.]+) cm", printed("def sag"))]
    assert len(sags) == 4
    assert sags == sorted(sags, reverse=True)
    # Twice as stiff, half as deep, but for the shape that changes.
    assert sags[2] / sags[3] == pytest.approx(2, rel=0.15)
    assert sags[3] < 3 < sags[0]
    assert float(re.search(r"with ([\d.e+]+) N", printed("live.grab"))[1]) > 0
