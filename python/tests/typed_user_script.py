"""A user's script for test_types.py: a strict type checker has nothing to say, and it runs."""

# ruff: noqa: N806 - F, H and P are the letters of the field

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import assert_type  # noqa: UP035 - not in typing of Python 3.10

import resilin
from resilin.typing import CurveKind, EnergyReport, FrameReport, Projection, Report, RunStatus, Scene

Floats = NDArray[np.floating[Any]]
Doubles = NDArray[np.float64]
Singles = NDArray[np.float32]
Indices = NDArray[np.int32]


def laws() -> None:
    law = resilin.Material("neo_hookean_quadratic", youngs_modulus=1e6, poissons_ratio=np.float64(0.45))
    F = np.tile(np.eye(3), (5, 1, 1))
    f = np.tile(np.eye(2, dtype=np.float32), (5, 1, 1))
    assert_type(law.energy_density(F), Doubles)
    assert_type(law.energy_density(f), Singles)
    assert_type(law.energy_density([[1, 0], [0, 1.5]]), Floats)
    assert_type(law.first_piola_kirchhoff_stress(F, displacement_gradient=True, out=np.empty_like(F)), Doubles)
    assert_type(law.stress_tangent(f, projection="clamp"), Singles)
    assert_type(law.cauchy_stress(f), Singles)
    assert_type(law.elastic_forces(F, F, np.ones(5)), Doubles)
    assert_type(law.constant_derivatives(F), dict[str, tuple[Doubles, Doubles]])
    assert_type(law.fibres, Doubles | None)
    assert_type(law.info.formula, str)
    assert_type([constant.unit for constant in resilin.laws()["gent"].constants], list[str])
    for number in law.constants.values():
        print(number * 2)
    by_cell = resilin.Material("gent", youngs_modulus=np.linspace(1e5, 1e6, 5), poissons_ratio=0.45, limit=30)
    projections: list[Projection] = [None, "clamp", "absolute"]
    print([by_cell.stress_tangent(F, projection).shape for projection in projections])
    tissue = resilin.Material(
        "holzapfel_gasser_ogden",
        youngs_modulus=1e4,
        poissons_ratio=0.4,
        fibre_modulus=2e3,
        fibre_stiffening=0.8,
        fibres=[[0.9, 0.4, 0], [0.9, -0.4, 0]],
    )
    print(tissue)


def curves(folder: Path) -> None:
    kinds: dict[CurveKind, Floats] = {"uniaxial": np.linspace(0.9, 1.5, 7), "shear": np.linspace(0, 0.5, 3)}
    for kind, stretches in kinds.items():
        curve = resilin.Material("ogden", youngs_modulus=1e6, poissons_ratio=0.49).curve(kind, stretches)
        assert_type(curve.nominal_stress, Doubles)
        assert_type(curve.is_stable, NDArray[np.bool_])
        for limit in curve.limits:
            assert_type(limit.stretch, float)
        curve.to_csv(folder / f"{kind}.csv")


def meshes(folder: Path) -> None:
    mesh = resilin.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], groups={"foot": [0, 1], "top": np.array([2])})
    mesh.write(folder / "triangle.msh")
    mesh = resilin.read_mesh(str(folder / "triangle.msh"))
    report = mesh.check()
    assert_type(report.errors, list[str])
    assert_type(mesh.positions, Doubles)
    assert_type(mesh.cells_by_kind, dict[str, Indices])
    box = resilin.Mesh.box(size=(1, 0.2, 0.2), cells=(4, 1, 1), pattern="five")
    assert_type(box, resilin.Mesh)
    assert_type(resilin.Mesh(box.positions, box.cells_by_kind).cells, Indices)
    print(report if report else "", resilin.embed(box, [[0.5, 0.1, 0.1]]) @ box.positions)


def energies() -> None:
    mesh = resilin.Mesh.rectangle((1, 1), np.array([2, 2]), pattern="alternating")
    body = resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=1e6, poissons_ratio=0.4), element="P2")
    x = body.rest_positions * 1.01
    assert_type(body.value(x), float)
    assert_type(body.gradient(x), Doubles)
    rows, columns, values = body.hessian(x, "absolute", as_triplets=True)
    assert_type(rows, Indices)
    assert_type(values, Doubles)
    assert_type(body.max_step(x, -0.5 * x), float)
    residual = body.mass(density=1000, kind="consistent") @ x.ravel() + body.hessian(x, projection="clamp") @ x.ravel()
    print(residual.shape, columns.shape)
    assert_type(body.cauchy_stresses(x), Doubles)


def simulations(folder: Path) -> None:
    square = resilin.Mesh.rectangle(size=(1, 1), cells=(4, 4))
    law = resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.4)
    scene = {
        "simulation": {"kind": "dynamic", "dimension": 2, "time_step": 0.01, "end_time": 0.05},
        "body": [
            {
                "name": "square",
                "mesh": square,
                "material": {"law": law, "density": 1000},
                "initial_positions": square.positions * [1.3, 1],
            }
        ],
        "probe": [{"name": "corner", "at": [1, 1]}],
    }
    result = resilin.run(scene, folder / "out", overrides={"simulation.end_time": 0.02}, progress=False)
    assert_type(result, resilin.Result)
    assert_type(result.positions, Doubles)
    assert_type(result.fields["von_mises"], Doubles)
    assert_type(list(result.fields), list[str])
    assert_type(result.status, RunStatus)
    assert_type(result.report, Report)
    frame = result.report["frames"][-1]
    assert_type(frame, FrameReport)
    assert_type(frame["energy"], EnergyReport)
    assert_type(frame["probes"]["corner"]["displacement"], list[float])
    assert_type(result.plot("nodal_von_mises", size=(120, 90), view="front", dark=True).pixels, NDArray[np.uint8])
    resilin.picture(folder / "out", scale=2, range=(0, 1e5)).save(folder / "square.png")

    assert_type(result.bodies, list[str])
    assert_type(result.cells(), Indices)
    assert_type(result.positions[-1, result.vertices("square")], Doubles)
    result.to_meshio(fields=["von_mises"]).write(folder / "square.vtu")

    simulation = resilin.Simulation(scene, ["newton.tolerance=1e-8"])
    while not simulation.is_finished:
        step = simulation.step()
        assert_type(step, resilin.Step)
        if not step:
            raise SystemExit(step.reason)
    assert_type(simulation.frame["momentum"]["linear"], list[float])
    assert_type(simulation.bodies[0]["unknowns"], int)
    simulation.set_material("square", resilin.Material("stable_neo_hookean", youngs_modulus=1e5, poissons_ratio=0.3))


def derivatives(scene: Scene, modulus: str) -> None:
    objective = {"volume": {"body": "square", "target": 1.0}}
    run = resilin.value_and_gradient(scene, objective, [modulus], values={modulus: 2e5})
    assert_type(run, resilin.Differentiated)
    assert_type(run.gradients, dict[str, float | Doubles])
    batch = resilin.value_and_gradient(scene, objective, [modulus], values={modulus: [1e5, 2e5]}, batch=True)
    assert_type(batch, resilin.DifferentiatedBatch)
    assert_type(batch.gradients, dict[str, Doubles])
    assert_type(batch.vjp(batch.positions)[modulus], Doubles)
    assert_type(batch[1].positions, Doubles)


def play(scene: Scene) -> None:
    live = resilin.LiveScene(scene)
    live.set(youngs_modulus=2e5, law="stable_neo_hookean", gravity=np.zeros(3))
    corner = live.grab(live.positions[0])
    assert_type(corner, int)
    live.drag(live.positions[corner] + 0.1)
    report = live.step()
    assert_type(report.converged, bool)
    assert_type(report.min_volume_ratio, float)
    assert_type(live.hand_force, Doubles)
    live.pin([1, 2])
    live.unpin(1)
    live.poke([0.0, 2.0], radius=0.1)
    assert_type(live.ball, Doubles | None)
    assert_type(live.pinned, list[int])
    assert_type(live.fields["von_mises"], Doubles)


def scene_of(path: Path, values: dict[str, object]) -> list[Scene]:
    return [path, str(path), values, {"simulation": {"kind": "static"}}]


def first_error() -> str:
    try:
        resilin.Material("neo_hookean", youngs_modulus=1e6, poissons_ratio=0.5)
    except resilin.InputError as error:
        return str(error)
    return ""


def main(folder: Path) -> None:
    resilin.set_num_threads(np.int64(resilin.num_threads()))
    laws()
    curves(folder)
    meshes(folder)
    energies()
    simulations(folder)
    soft = {"name": "square", "mesh": resilin.Mesh.rectangle((1, 1), (2, 2))}
    motion = {"kind": "dynamic", "dimension": 2, "time_step": 0.01, "end_time": 0.02, "gravity": [0, -9.81]}
    derivatives({"simulation": motion, "body": [soft]}, "body.square.material.youngs_modulus")
    play({"simulation": {"dimension": 2}, "body": [{"mesh": resilin.Mesh.rectangle((1, 1), (2, 2))}]})
    print(first_error(), resilin.__version__)
