"""Pictures of results: shown, saved and refused."""

import numpy as np
import pytest

import resilin

SCENE = {
    "simulation": {"gravity": [0, 0, -9.81]},
    "body": [
        {
            "name": "beam",
            "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": [6, 2, 2]}},
            "material": {"law": "neo_hookean", "youngs_modulus": 5e5, "poissons_ratio": 0.3},
        }
    ],
    "fix": [{"where": {"plane": {"axis": "x", "at": 0}}}],
    "section": [{"name": "middle", "plane": {"axis": "x", "at": 0.5}}],
    "output": {"fields": ["displacement", "von_mises", "nodal_pressure"]},
}


@pytest.fixture(scope="module")
def result():
    return resilin.run(SCENE)


def body_pixels(picture):
    return (picture.pixels != 255).any(axis=2).sum()


def test_plot_shows_the_body_in_the_colours_of_the_field(result):
    stress = result.plot("von_mises", size=(320, 240))
    assert stress.pixels.shape == (240, 320, 3)
    assert body_pixels(stress) > 5000
    assert (result.plot("nodal_pressure", size=(320, 240)).pixels != stress.pixels).any()
    assert (result.plot("von_mises", size=(320, 240)).pixels == stress.pixels).all()
    assert (result.plot("von_mises", size=(320, 240), dark=True).pixels[0, 0] < 60).all()
    assert (result.plot(size=(320, 240), frame=0).pixels != stress.pixels).any()


def test_a_picture_is_shown_and_saved_as_png(result, tmp_path):
    picture = result.plot("displacement.z", size=(100, 80), view=(1, -2, 1), range=(-1, 0), edges=False, rest=True)
    assert picture._repr_png_()[1:4] == b"PNG"
    picture.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == picture._repr_png_()
    with pytest.raises(resilin.InputError, match="missing"):
        picture.save(tmp_path / "missing" / "a.png")


def test_a_folder_is_drawn_like_the_result_in_memory(result, tmp_path):
    result.save(tmp_path / "beam")
    from_folder = resilin.picture(tmp_path / "beam", "nodal_pressure", size=(200, 150))
    assert (from_folder.pixels == result.plot("nodal_pressure", size=(200, 150)).pixels).all()
    # A field that the scene did not ask for is computed from what the folder keeps.
    computed = resilin.picture(tmp_path / "beam", "green_strain.xx", size=(200, 150))
    assert (computed.pixels == result.plot("green_strain.xx", size=(200, 150)).pixels).all()
    (tmp_path / "beam" / "scene.bin").unlink()
    with pytest.raises(resilin.InputError, match="displacement, nodal_pressure, body, von_mises"):
        resilin.picture(tmp_path / "beam", "green_strain.xx")
    with pytest.raises(resilin.InputError, match="nothing there"):
        resilin.picture(tmp_path / "nowhere")


def test_the_bar_and_the_caption_are_left_out_where_asked(result):
    def drawn(**options):
        return result.plot("von_mises", frame=0, size=(300, 200), view="front", **options).pixels

    bare, said, whole = drawn(bar=False, caption=False), drawn(bar=False), drawn()
    rows, columns = (bare != said).any(axis=2).nonzero()
    assert len(rows) > 20 and rows.max() < 30 and columns.max() < 90  # "load 0" in the corner
    assert (bare[:30, 150:] == 255).all() and not (whole[:30, 150:] == 255).all()  # the name of the field


def test_wrong_arguments_are_refused(result):
    for options in ({"size": 3}, {"range": 1}, {"view": "fron"}, {"frame": 99}, {"map": "jet"}):
        with pytest.raises(resilin.InputError):
            result.plot("von_mises", **options)
    with pytest.raises(resilin.InputError, match="did you mean"):
        result.plot("von_misses")


def test_fields_are_there_by_cell_and_smoothed(result):
    cells, vertices = result.fields["von_mises"].shape[1], result.positions.shape[1]
    assert result.fields["nodal_von_mises"].shape == (2, vertices)
    assert result.fields["principal_stress"].shape == (2, cells, 3)
    assert result.fields["nodal_logarithmic_strain"].shape == (2, vertices, 3, 3)
    sigma = result.fields["cauchy_stress"][-1]
    np.testing.assert_allclose(result.fields["principal_stress"][-1], np.linalg.eigvalsh(sigma)[:, ::-1], atol=1e-8)
    np.testing.assert_allclose(result.fields["pressure"][-1], -np.trace(sigma, axis1=1, axis2=2) / 3, atol=1e-8)


def test_the_report_has_extremes_and_sections(result):
    frame = result.report["frames"][-1]
    asked = {"displacement", "von_mises", "nodal_pressure"}
    # By the page of a run, which shows a field by cell that is asked for as averages.
    shown = {"nodal_von_mises", "averaged_von_mises", "averaged_volume_ratio", "averaged_energy_density"}
    assert set(frame["extremes"]) == asked | shown
    largest = frame["extremes"]["von_mises"]["max"]
    stress = result.fields["von_mises"][-1]
    assert largest["value"] == stress.max()
    assert largest["cell"] == stress.argmax()
    assert largest["body"] == "beam"
    # Half of the beam hangs on the section: 0.02 m^3 of 1000 kg/m^3.
    np.testing.assert_allclose(frame["sections"]["middle"]["force"], [0, 0, -20 * 9.81], atol=1e-4)


def test_colliders_are_drawn_unless_they_are_not_wanted(tmp_path):
    ball = {"name": "ball", "kind": "sphere", "center": [0.5, 0.1, 0.5], "radius": 0.1}
    result = resilin.run({**SCENE, "collider": [ball]})
    shown = result.plot(size=(200, 150))
    assert (shown.pixels != result.plot(size=(200, 150), colliders=False).pixels).any()
    result.save(tmp_path / "beam")
    assert (resilin.picture(tmp_path / "beam", size=(200, 150)).pixels == shown.pixels).all()
