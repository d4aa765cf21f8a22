"""Meshes, materials, bodies and results go through pickle, so that other processes can have them."""

import copy
import multiprocessing
import pickle
import warnings

import numpy as np
import pytest
from every_law import LAWS, material_of
from scenes import cantilever, square

import resilin

WAYS = {
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
    "oldest protocol": lambda value: pickle.loads(pickle.dumps(value, protocol=2)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


@pytest.fixture(params=WAYS)
def through(request):
    return WAYS[request.param]


def meshes(folder):
    tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    box = resilin.Mesh.box((1, 0.5, 0.25), (3, 2, 1))
    box.write(folder / "box.msh")
    box.write(folder / "box.vtu")
    return {
        "box": box,
        "hexahedra": resilin.Mesh.box((1, 1, 1), (2, 2, 2), pattern="hexahedra"),
        "in the plane": resilin.Mesh.rectangle((1, 1), (3, 3), pattern="alternating"),
        "from arrays": resilin.Mesh(tetrahedron, [[0, 1, 2, 3]], {"base": [2, 0, 1], "tip \u00fc": [3]}, name="one"),
        "of several kinds": resilin.Mesh(tetrahedron, {"tetrahedron": [[0, 1, 2, 3]], "triangle": [[0, 2, 1]]}),
        "of no use": resilin.Mesh([*tetrahedron[:3], [0, 0, np.nan]], [[0, 1, 2, 3]]),
        "from MSH": resilin.read_mesh(folder / "box.msh"),
        "from VTU": resilin.read_mesh(folder / "box.vtu"),
    }


def assert_same_mesh(ours, theirs):
    assert type(ours) is type(theirs)
    assert repr(ours) == repr(theirs)
    np.testing.assert_array_equal(ours.positions, theirs.positions)
    assert ours.cells_by_kind.keys() == theirs.cells_by_kind.keys()
    for kind, cells in theirs.cells_by_kind.items():
        np.testing.assert_array_equal(ours.cells_by_kind[kind], cells)
    assert ours.groups.keys() == theirs.groups.keys()
    for name, vertices in theirs.groups.items():
        np.testing.assert_array_equal(ours.groups[name], vertices)
    assert not ours.positions.flags.writeable
    assert ours.check().errors == theirs.check().errors  # in the numbers of the file
    assert ours.check().warnings == theirs.check().warnings


def test_meshes_stay_what_they_are(through, tmp_path):
    for mesh in meshes(tmp_path).values():
        assert_same_mesh(through(mesh), mesh)


def test_a_mesh_written_after_pickling_is_the_same_file(tmp_path):
    for name, mesh in meshes(tmp_path).items():
        if name == "of no use":
            continue
        mesh.write(tmp_path / "before.msh")
        pickle.loads(pickle.dumps(mesh)).write(tmp_path / "after.msh")
        assert (tmp_path / "after.msh").read_bytes() == (tmp_path / "before.msh").read_bytes()


@pytest.mark.parametrize("law", LAWS)
def test_materials_stay_what_they_are(law, through):
    material = material_of(law)
    states = np.eye(3) + 0.1 * np.random.default_rng(0).standard_normal((5, 3, 3))
    other = through(material)
    assert repr(other) == repr(material)
    np.testing.assert_array_equal(other.stress_tangent(states), material.stress_tangent(states))


@pytest.mark.parametrize("element", ["P1", "P2", "P2P0", "Q1", "Q1P0"])
@pytest.mark.parametrize("dim", [2, 3])
def test_bodies_stay_what_they_are(element, dim, through):
    if dim == 3:
        mesh = resilin.Mesh.box((1, 1, 1), (2, 1, 1), pattern="hexahedra" if element[0] == "Q" else "kuhn6")
    else:
        mesh = resilin.Mesh.rectangle((1, 1), (2, 2), pattern="quadrilaterals" if element[0] == "Q" else "uniform")
    law = resilin.Material("neo_hookean_isochoric", youngs_modulus=np.float64(1e5), poissons_ratio=0.4)
    body = resilin.Elastic(mesh, law, element=element)
    x = body.rest_positions + 0.02 * np.random.default_rng(1).standard_normal(body.rest_positions.shape)
    other = through(body)
    assert (other.element, other.quadrature, repr(other)) == (body.element, body.quadrature, repr(body))
    assert other.value(x) == body.value(x)
    np.testing.assert_array_equal(other.gradient(x), body.gradient(x))
    np.testing.assert_array_equal(other.hessian(x).data, body.hessian(x).data)
    np.testing.assert_array_equal(other.cauchy_stresses(x), body.cauchy_stresses(x))


def test_a_body_with_warnings_comes_back_in_silence():
    """They were said when it was made."""
    tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [5, 5, 5]]
    law = resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.4)
    with pytest.warns(UserWarning, match="inverted"):
        body = resilin.Elastic(resilin.Mesh(tetrahedron, [[0, 2, 1, 3]]), law)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pickle.loads(pickle.dumps(body)).value(body.rest_positions) == 0


RUNS = {
    "statics": lambda: cantilever(),
    "motion": lambda: square(end_time=0.05),
    "motion in adaptive steps": lambda: square(end_time=0.03, adaptive={"tolerance": 1e-2}),
    "vibrations": lambda: cantilever(kind="modes", gravity=[0, 0, 0]),
    "colliders, loads, sections, values by cell": lambda: detailed(),
}


def detailed():
    mesh = resilin.Mesh.box((1, 0.2, 0.2), (5, 1, 1))
    scene = cantilever(kind="dynamic", time_step=0.01, end_time=0.03)
    scene["body"][0] |= {"mesh": mesh, "rotate": [0, 0, 1, 30], "initial_velocities": 0.1 * mesh.positions}
    scene["body"][0]["material"]["youngs_modulus"] = np.linspace(5e5, 6e5, len(mesh.cells))
    scene["body"][0]["damping"] = {"mass": 0.1}
    scene["load"] = [
        {
            "kind": "traction",
            "where": {"group": "x_max"},
            "value": [0, 0, -100],
            "time_function": {"table": [[0, 0], [1, 1]]},
        },
        {"kind": "pressure", "where": {"group": "z_max"}, "value": 10},
    ]
    scene["collider"] = [{"name": "floor", "kind": "half_space", "point": [0, 0, -1], "normal": [0, 0, 1]}]
    scene["section"] = [{"name": "middle", "body": "beam", "plane": {"axis": "x", "at": 0.4}}]
    return scene


@pytest.mark.parametrize("name", RUNS)
def test_results_stay_what_they_are(name, through, tmp_path):
    result = resilin.run(RUNS[name]())
    other = through(result)
    for attribute in ("positions", "velocities", "times", "loads"):
        np.testing.assert_array_equal(getattr(other, attribute), getattr(result, attribute))
    assert other.report == result.report
    assert repr(other) == repr(result)
    for field in result.fields:
        np.testing.assert_array_equal(other.fields[field], result.fields[field])
    np.testing.assert_array_equal(other.plot(size=(80, 64)).pixels, result.plot(size=(80, 64)).pixels)
    result.save(tmp_path / "ours")
    other.save(tmp_path / "theirs")
    files = {path.relative_to(tmp_path / "ours") for path in (tmp_path / "ours").rglob("*") if path.is_file()}
    for file in sorted(files):
        if file.name in ("report.json", "result.html"):  # they tell times
            continue
        assert (tmp_path / "theirs" / file).read_bytes() == (tmp_path / "ours" / file).read_bytes(), file


def test_a_damaged_pickle_of_a_result_is_refused():
    image = resilin.run(square(end_time=0.01))._core.__getstate__()
    core = resilin.run(square(end_time=0.01))._core
    for size in (0, 7, 8, len(image) // 2, len(image) - 1):
        with pytest.raises(resilin.InputError, match="damaged"):
            type(core).__new__(type(core)).__setstate__(image[:size])


def tip_of(scene):
    return resilin.run(scene)


def test_processes_hand_results_back():
    """A sweep over processes that are started afresh, each with libraries of its own."""
    moduli = [4e5, 8e5]
    scenes = [cantilever() for _ in moduli]
    for scene, modulus in zip(scenes, moduli, strict=True):
        scene["body"][0]["material"]["youngs_modulus"] = modulus
        scene["body"][0]["mesh"] = resilin.Mesh.box((1, 0.2, 0.2), (4, 1, 1))
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        results = pool.map(tip_of, scenes)
    for scene, result in zip(scenes, results, strict=True):
        np.testing.assert_array_equal(result.positions, resilin.run(scene).positions)


def test_a_simulation_says_what_to_pickle_instead():
    with pytest.raises(TypeError, match="pickle its scene, or the Result of a run"):
        pickle.dumps(resilin.Simulation(square()))
