"""Results in notebooks: the page with the motion, of bounded size."""

import base64
import copy
import html
import json
import pathlib
import pickle
import re

import pytest
from scenes import cantilever, square

import resilin
from resilin import notebook


def frame_of(shown):
    """The page in an iframe, and the words on it."""
    found = re.fullmatch(r'<iframe srcdoc="([^"]*)" sandbox="[\w -]*" title="([^"]*)" .*</iframe>', shown)
    assert found, shown[:300]
    return html.unescape(found[1]), html.unescape(found[2])


def recording_size(page):
    """[bytes]"""
    data = base64.b64decode(re.search(r'<script id="recording" type="text/plain">([^<]*)</script>', page)[1])
    return len(data)


def test_a_result_shows_itself_as_the_page_of_result_html(tmp_path):
    result = resilin.run(square(end_time=0.05), progress=False)
    page, words = frame_of(result._repr_html_())
    assert words == repr(result)
    result.save(tmp_path)
    written = (tmp_path / "result.html").read_text()
    script = '<script id="{}"'
    for part in ("recording", "report"):
        assert script.format(part) in page
    assert page.split(script.format("recording"))[0] == written.split(script.format("recording"))[0]
    recording = re.compile(r'<script id="recording" type="text/plain">([^<]*)</script>')
    assert recording.search(page)[1] == recording.search(written)[1]
    report = json.loads(re.search(r'<script id="report" type="application/json">(.*?)</script>', page, re.DOTALL)[1])
    assert report["frames"] == result.report["frames"]


def test_a_scene_that_writes_no_page_has_one_in_a_notebook():
    result = resilin.run(cantilever() | {"output": {"formats": ["vtu"]}}, progress=False)
    page, _ = frame_of(result._repr_html_())
    assert '<script id="recording"' in page


def test_a_long_motion_is_thinned_out_to_what_a_notebook_can_hold():
    result = resilin.run(square(end_time=1.0), progress=False)
    count = len(result.times)
    whole = notebook.page_of(result._core, count)
    least = len(notebook.page_of(result._core, count, 10**9)) - recording_size(whole) * 4 // 3
    room = least + (len(whole) - least) // 3
    thin = notebook.page_of(result._core, count, room)
    assert thin is not None and len(thin) <= room < len(whole)
    assert recording_size(thin) > recording_size(whole) / 20
    assert notebook.page_of(result._core, count, 1000) is None


def test_a_result_that_is_too_large_shows_a_picture(monkeypatch):
    result = resilin.run(square(end_time=0.02), progress=False)
    monkeypatch.setattr(notebook, "page_of", lambda *_: None)
    shown = result._repr_html_()
    assert shown.startswith('<img src="data:image/png;base64,')
    assert "too large" in shown


def test_what_words_hold_does_not_leave_the_frame():
    scene = square(end_time=0.01) | {"title": '"><script>alert(1)</script>&'}
    shown = resilin.run(scene, progress=False)._repr_html_()
    page, _ = frame_of(shown)
    assert "<script>alert(1)" not in shown
    assert "<script>alert(1)" not in page


def test_nothing_is_left_behind(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    resilin.run(square(end_time=0.01), progress=False)._repr_html_()
    assert list(pathlib.Path(tmp_path).iterdir()) == []


@pytest.mark.parametrize("again", ["pickle", "copy"])
def test_a_result_from_elsewhere_shows_itself_too(again):
    result = resilin.run(square(end_time=0.02), progress=False)
    other = pickle.loads(pickle.dumps(result)) if again == "pickle" else copy.copy(result)
    assert other._repr_html_() == result._repr_html_()
    assert (other.cells() == result.cells()).all()
