import numpy as np
import pytest

import resilin

TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_a_mesh_from_arrays_holds_them():
    mesh = resilin.Mesh(TETRAHEDRON, [[0, 1, 2, 3]], groups={"base": [2, 0, 1, 2]})
    np.testing.assert_array_equal(mesh.positions, TETRAHEDRON)
    np.testing.assert_array_equal(mesh.cells, [[0, 1, 2, 3]])
    np.testing.assert_array_equal(mesh.groups["base"], [0, 1, 2])
    assert mesh.dimension == 3
    assert mesh.check()


def test_a_mesh_in_the_plane_has_two_coordinates():
    mesh = resilin.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    assert mesh.positions.shape == (3, 2)
    assert mesh.cells.shape == (1, 3)


def test_cells_may_come_by_kind():
    mesh = resilin.Mesh(TETRAHEDRON, {"tetrahedron": [[0, 1, 2, 3]], "triangle": [[0, 2, 1]]})
    assert mesh.cells.shape == (1, 4)
    assert mesh.cells_by_kind["triangle"].tolist() == [[0, 2, 1]]


def test_strided_and_wide_arrays_are_taken_as_they_read():
    positions = np.asfortranarray(np.array(TETRAHEDRON, dtype=np.float32))
    cells = np.array([[0, 9, 1, 9, 2, 9, 3, 9]], dtype=np.uint64)[:, ::2]
    mesh = resilin.Mesh(positions, cells)
    np.testing.assert_array_equal(mesh.positions, TETRAHEDRON)
    np.testing.assert_array_equal(mesh.cells, [[0, 1, 2, 3]])


@pytest.mark.parametrize(
    ("positions", "cells", "message"),
    [
        (np.zeros(4), [[0, 1, 2, 3]], "positions: expected an array (N, 2) or (N, 3), got (4,)"),
        (TETRAHEDRON, [[0, 1, 2, 4]], "expected vertices from 0 to 3, got 4"),
        (TETRAHEDRON, [[0, 1, 2, -1]], "expected vertices from 0 to 3, got -1"),
        (TETRAHEDRON, [[0.0, 1, 2, 3]], "expected whole numbers, got float64"),
        (TETRAHEDRON, [0, 1, 2, 3], "expected an array (M, 3) of triangles or (M, 4) of tetrahedra"),
        (TETRAHEDRON, {"tetra": [[0, 1, 2, 3]]}, "expected one of point, line, triangle"),
        (TETRAHEDRON, {"triangle": [[0, 1, 2, 3]]}, "triangle cells: expected an array (M, 3), got (1, 4)"),
        (np.array(TETRAHEDRON) * 1j, [[0, 1, 2, 3]], "expected real numbers"),
    ],
)
def test_wrong_arrays_are_refused_with_what_was_expected(positions, cells, message):
    with pytest.raises(resilin.InputError) as caught:
        resilin.Mesh(positions, cells)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_check_tells_what_is_wrong():
    report = resilin.Mesh([*TETRAHEDRON[:3], [0, 0, np.nan]], [[0, 1, 2, 3]]).check()
    assert not report
    assert len(report.errors) == 1


def test_a_box_fills_its_size_and_names_its_sides():
    mesh = resilin.Mesh.box((2, 1, 3), (2, 1, 3), origin=(1, 0, 0))
    np.testing.assert_array_equal(mesh.positions.min(axis=0), [1, 0, 0])
    np.testing.assert_array_equal(mesh.positions.max(axis=0), [3, 1, 3])
    assert len(mesh.cells) == 6 * 6
    np.testing.assert_array_equal(mesh.positions[mesh.groups["x_min"], 0], 1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((1, 1), (1, 1, 1)), "box.size: expected 3 numbers"),
        (((1, 1, 0), (1, 1, 1)), "box.size: expected lengths above 0"),
        (((1, 1, 1), (1, 1, 0)), "box.cells: expected whole numbers of at least 1"),
        (((1, 1, 1), (1, 1, 1.5)), "box.cells: expected whole numbers"),
    ],
)
def test_wrong_boxes_are_refused(arguments, message):
    with pytest.raises(resilin.InputError, match=message):
        resilin.Mesh.box(*arguments)


@pytest.mark.parametrize("extension", ["msh", "vtu"])
def test_a_written_mesh_reads_back(tmp_path, extension):
    mesh = resilin.Mesh.box((1, 1, 1), (2, 1, 1))
    mesh.write(tmp_path / f"box.{extension}")
    read = resilin.read_mesh(tmp_path / f"box.{extension}")
    np.testing.assert_array_equal(read.positions, mesh.positions)
    np.testing.assert_array_equal(read.cells, mesh.cells)


def test_a_missing_file_is_an_input_error(tmp_path):
    with pytest.raises(resilin.InputError, match="no-such.msh"):
        resilin.read_mesh(tmp_path / "no-such.msh")


def test_a_meshio_mesh_brings_its_groups():
    meshio = pytest.importorskip("meshio")
    mesh = resilin.Mesh.from_meshio(
        meshio.Mesh(
            np.array(TETRAHEDRON, dtype=float),
            [("tetra", [[0, 1, 2, 3]]), ("triangle", [[0, 2, 1], [0, 1, 3]])],
            cell_sets={"base": [[], [0]]},
            point_sets={"top": [3]},
        )
    )
    np.testing.assert_array_equal(mesh.cells, [[0, 1, 2, 3]])
    assert mesh.groups["base"].tolist() == [0, 1, 2]
    assert mesh.groups["top"].tolist() == [3]


def test_a_meshio_mesh_in_the_plane_is_two_dimensional():
    meshio = pytest.importorskip("meshio")
    mesh = resilin.Mesh.from_meshio(meshio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [("triangle", [[0, 1, 2]])]))
    assert mesh.dimension == 2


def test_second_order_tetrahedra_of_meshio_come_in_our_order():
    """Edge midpoints: in our order (MSH) the last two are of the edges 2-3 and 1-3, in VTK's the other way round."""
    meshio = pytest.importorskip("meshio")
    corners = np.array(TETRAHEDRON, dtype=float)
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    points = np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in edges]])
    mesh = resilin.Mesh.from_meshio(meshio.Mesh(points, [("tetra10", [list(range(10))])]))
    nodes = mesh.cells_by_kind["tetrahedron10"][0]
    np.testing.assert_array_equal(mesh.positions[nodes[8]], (corners[2] + corners[3]) / 2)
    np.testing.assert_array_equal(mesh.positions[nodes[9]], (corners[1] + corners[3]) / 2)
