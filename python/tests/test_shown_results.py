"""Results of a run, read by others' programs."""

import json

import numpy as np
import pytest
from scenes import cantilever, square

import resilin

Usd = pytest.importorskip("pxr.Usd", reason="needs usd-core")
UsdGeom = pytest.importorskip("pxr.UsdGeom")


def stage_of(folder):
    stage = Usd.Stage.Open(str(folder / "result.usda"))
    assert stage.GetDefaultPrim().GetName() == "scene"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    return stage, [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]


def test_a_stage_holds_every_frame_of_a_motion(tmp_path):
    scene = square(end_time=0.1) | {"output": {"formats": ["usda"], "every": 2}}
    scene["body"][0]["name"] = "2 squares"
    result = resilin.run(scene, out=tmp_path)
    stage, (mesh,) = stage_of(tmp_path)
    assert mesh.GetPrim().GetName() == "_2_squares"
    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    codes = mesh.GetPointsAttr().GetTimeSamples()
    assert codes == list(range(len(result.times)))
    np.testing.assert_allclose(np.array(codes) / stage.GetTimeCodesPerSecond(), result.times, rtol=1e-12)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (codes[0], codes[-1])
    for code, positions in zip(codes, result.positions, strict=True):
        points = np.array(mesh.GetPointsAttr().Get(code))
        np.testing.assert_array_equal(points[:, :2], positions.astype(np.float32))
        np.testing.assert_array_equal(mesh.GetExtentAttr().Get(code), [points.min(axis=0), points.max(axis=0)])
    assert set(mesh.GetFaceVertexCountsAttr().Get()) == {3}
    assert UsdGeom.Mesh.ValidateTopology(
        mesh.GetFaceVertexIndicesAttr().Get(), mesh.GetFaceVertexCountsAttr().Get(), len(positions)
    )[0]


def test_a_stage_of_a_solid_holds_its_surface(tmp_path):
    result = resilin.run(cantilever() | {"output": {"formats": ["html", "usda"]}}, out=tmp_path)
    stage, (mesh,) = stage_of(tmp_path)
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert len(mesh.GetPointsAttr().GetTimeSamples()) == len(result.positions)
    points = np.array(mesh.GetPointsAttr().Get(stage.GetEndTimeCode()))
    every = result.positions[-1].astype(np.float32)
    assert 0 < len(points) < len(every)
    assert {tuple(p) for p in points} <= {tuple(p) for p in every}
    # Outward: the divergence theorem gives the volume, which the beam keeps to a few percent.
    a, b, c = points[np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3).T]
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(0.04, rel=0.05)


def test_a_saved_result_has_the_page_of_the_run(tmp_path):
    result = resilin.run(square(end_time=0.05), out=tmp_path / "run")
    result.save(tmp_path / "saved")
    for name in ("recording.bin", "result.html"):
        assert (tmp_path / "run" / name).stat().st_size > 0
    assert (tmp_path / "saved" / "recording.bin").read_bytes() == (tmp_path / "run" / "recording.bin").read_bytes()
    report = json.loads((tmp_path / "saved" / "report.json").read_text())
    assert report["files"]["result.html"] == (tmp_path / "saved" / "result.html").stat().st_size
