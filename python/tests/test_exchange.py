"""Frames for meshio, pyvista and pandas, and connectivity of every element."""

import importlib
import sys

import numpy as np
import pytest
from scenes import cantilever, square

import resilin

BOX = resilin.Mesh.box((2, 1, 1), (2, 1, 1))
BRICKS = resilin.Mesh.box((2, 1, 1), (2, 1, 1), pattern="hexahedra")
SHEET = resilin.Mesh.rectangle((2, 1), (2, 1))
TILES = resilin.Mesh.rectangle((2, 1), (2, 1), pattern="quadrilaterals")
# element, mesh, kind of cell for meshio, nodes of a cell, what `to_pyvista` calls it
ELEMENTS = [
    ("P1", BOX, "tetra", 4, 10),
    ("P2", BOX, "tetra10", 10, 24),
    ("P2P0", BOX, "tetra10", 10, 24),
    ("Q1", BRICKS, "hexahedron", 8, 12),
    ("Q1P0", BRICKS, "hexahedron", 8, 12),
    ("P1", SHEET, "triangle", 3, 5),
    ("P2", SHEET, "triangle6", 6, 22),
    ("P2P0", SHEET, "triangle6", 6, 22),
    ("Q1", TILES, "quad", 4, 9),
    ("Q1P0", TILES, "quad", 4, 9),
]


def stretched(element, mesh):
    """A bar of volume 2, drawn to twice its length; nu = 0, so that it gets volume 4."""
    dimension = mesh.positions.shape[1]
    material = {"law": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0}
    pull = [2, 0, 0][:dimension]
    return {
        "simulation": {"kind": "static", "dimension": dimension},
        "body": [{"name": "bar", "mesh": mesh, "element": element, "material": material}],
        "fix": [{"where": {"group": "x_min"}}, {"name": "pull", "where": {"group": "x_max"}, "displacement": pull}],
    }


@pytest.mark.parametrize(("element", "mesh", "kind", "nodes", "vtk_type"), ELEMENTS)
def test_every_element_has_its_cells_in_every_form(element, mesh, kind, nodes, vtk_type):
    result = resilin.run(stretched(element, mesh), progress=False)
    cells = result.cells()
    assert cells.shape[1] == nodes
    np.testing.assert_array_equal(cells, result.cells("bar"))
    assert set(cells.ravel()) == set(range(result.positions.shape[1]))
    assert result.vertices() == slice(0, result.positions.shape[1])
    # Mid-edge nodes lie in the middle of their edges: each is the mean of two corners of its cell.
    if nodes in (6, 10):
        corners = 3 if nodes == 6 else 4
        edges = [(0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)][: nodes - corners]
        places = result.positions[-1][cells]
        for middle, (a, b) in enumerate(edges, corners):
            np.testing.assert_allclose(places[:, middle], (places[:, a] + places[:, b]) / 2, atol=1e-9)

    pyvista = pytest.importorskip("pyvista")
    grid = result.to_pyvista(fields=["displacement", "cauchy_stress", "volume_ratio", "nodal_von_mises"])
    assert isinstance(grid, pyvista.UnstructuredGrid)
    assert set(grid.celltypes) == {vtk_type}
    # VTK integrates its own shape functions over our nodes in our order: a wrong order would tangle the cells.
    sizes = grid.compute_cell_sizes(length=False)
    measure = sizes["Volume" if mesh.positions.shape[1] == 3 else "Area"]
    assert measure.min() > 0
    np.testing.assert_allclose(measure.sum(), 4, rtol=1e-9)
    np.testing.assert_allclose(grid["volume_ratio"], 2, rtol=1e-9)
    np.testing.assert_allclose(grid["displacement"][:, 0], grid.points[:, 0] / 2, atol=1e-9)
    assert grid["cauchy_stress"].shape == (len(cells), 9)

    meshio = pytest.importorskip("meshio")
    there = result.to_meshio(fields=["volume_ratio", "displacement"])
    assert isinstance(there, meshio.Mesh)
    (block,) = there.cells
    assert block.type == kind
    np.testing.assert_array_equal(there.cell_data["body"][0], np.zeros(len(cells)))
    back = resilin.Mesh.from_meshio(there)
    np.testing.assert_array_equal(next(iter(back.cells_by_kind.values())), cells)
    np.testing.assert_array_equal(back.positions, result.positions[-1])


def test_bodies_of_different_cells_keep_their_fields_apart(tmp_path):
    soft = {"law": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1000}
    scene = {
        "simulation": {"kind": "static", "gravity": [0, 0, -9.81]},
        "body": [
            {"name": "upper", "mesh": BOX, "material": soft, "element": "P2", "translate": [0, 0, 3]},
            {"name": "lower", "mesh": BRICKS, "material": soft, "element": "Q1"},
            {"name": "last", "mesh": BOX, "material": soft, "element": "P1", "translate": [0, 3, 0]},
        ],
        "fix": [{"body": name, "where": {"group": "x_min"}} for name in ("upper", "lower", "last")],
    }
    result = resilin.run(scene, progress=False)
    assert result.bodies == ["upper", "lower", "last"]
    with pytest.raises(resilin.InputError, match="body: expected one of upper, lower, last, got no name"):
        result.cells()
    meshio = pytest.importorskip("meshio")
    mesh = result.to_meshio(fields=["von_mises", "velocity"])
    assert [block.type for block in mesh.cells] == ["tetra10", "hexahedron", "tetra"]
    np.testing.assert_array_equal(np.concatenate(mesh.cell_data["von_mises"]), result.fields["von_mises"][-1])
    for body, (block, numbers) in enumerate(zip(mesh.cells, mesh.cell_data["body"], strict=True)):
        assert set(numbers) == {body}
        rows = result.vertices(result.bodies[body])
        assert rows.start <= block.data.min() <= block.data.max() < rows.stop
    mesh.write(tmp_path / "frame.vtu")
    again = meshio.read(tmp_path / "frame.vtu")
    np.testing.assert_array_equal(again.points, result.positions[-1])
    grid = pytest.importorskip("pyvista").read(tmp_path / "frame.vtu")
    ours = result.to_pyvista(fields=["von_mises"])
    np.testing.assert_array_equal(ours.celltypes, grid.celltypes)
    np.testing.assert_array_equal(ours.cell_connectivity, grid.cell_connectivity)
    np.testing.assert_array_equal(ours["von_mises"], grid["von_mises"])


def test_frames_and_fields_are_asked_for_by_number_and_name():
    result = resilin.run(square(end_time=0.03), progress=False)
    pytest.importorskip("meshio")
    for frame in range(-len(result.times), len(result.times)):
        points = result.to_meshio(frame).points
        np.testing.assert_array_equal(points[:, :2], result.positions[frame])
        np.testing.assert_array_equal(points[:, 2], 0)
    with pytest.raises(resilin.InputError, match="frame: expected 0 to"):
        result.to_meshio(len(result.times))
    with pytest.raises(resilin.InputError, match="von_mises"):
        result.to_meshio(fields=["von_misses"])
    with pytest.raises(resilin.InputError, match="a list of names"):
        result.to_meshio(fields="von_mises")


def test_a_table_has_a_row_for_each_frame():
    pandas = pytest.importorskip("pandas")
    result = resilin.run(cantilever(), progress=False)
    table = result.to_dataframe()
    assert isinstance(table, pandas.DataFrame)
    frames = result.report["frames"]
    assert len(table) == len(frames)
    np.testing.assert_array_equal(table["load"], result.loads)
    np.testing.assert_array_equal(table["energy.total"], [frame["energy"]["total"] for frame in frames])
    for name, probe in frames[-1]["probes"].items():
        for axis, value in zip("xyz", probe["displacement"], strict=True):
            assert table[f"probes.{name}.displacement.{axis}"].iloc[-1] == value
    for name, force in frames[-1]["reactions"].items():
        assert table[f"reactions.{name}.z"].iloc[-1] == force[2]
    assert table["energy.total"].dtype == np.float64


@pytest.mark.parametrize("package", ["meshio", "pyvista", "pandas"])
def test_a_package_that_is_absent_is_named_with_its_cure(package, monkeypatch):
    result = resilin.run(square(end_time=0.01), progress=False)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError):
        importlib.import_module(package)
    call = {"meshio": result.to_meshio, "pyvista": result.to_pyvista, "pandas": result.to_dataframe}[package]
    with pytest.raises(ImportError, match=rf"needs {package}: pip install 'resilin\[{package}\]'"):
        call()
