"""Live scenes in notebooks: what pages say and are told, and that the Python object is where the page has led it."""

import json
import struct
import subprocess
import sys
import time

import numpy as np
import pytest
from scenes import cantilever, square

import resilin
from resilin import live_pages

TIME_LIMIT = 60  # [s] for what takes a fraction of a second on a quiet machine


def weightless():
    """A block that hangs on a wall without weight, so that nothing moves before somebody pulls."""
    scene = cantilever(gravity=[0, 0, 0])
    scene["body"][0]["material"]["density"] = 1000
    return scene


def wait_until(holds):
    end = time.monotonic() + TIME_LIMIT
    while not holds():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


class Page:
    """A page that does not draw: it keeps what it is told and answers each frame, as docs/view_protocol.md asks."""

    def __init__(self, pages):
        self.texts, self.frames, self.words = [], [], []
        self.answers = True
        self.pages = pages
        self.number = pages.open(self.hear, self.words.append)

    def hear(self, message):
        if isinstance(message, str):
            self.texts.append(json.loads(message))
        else:
            self.frames.append(message)

    def answer(self):
        """Answers the last frame from the test's thread, as a notebook does it from its own."""
        if self.frames and self.frames[-1][:4] == b"RSF1" and self.answers:
            self.pages.receive(self.number, b"\1\0\0\0" + self.frames[-1][4:8])

    def say(self, **message):
        self.pages.receive(self.number, json.dumps(message))

    def drag(self, number, target):
        self.pages.receive(self.number, struct.pack("<4BI3f", 2, 0, 0, 0, number, *target))

    def last(self, kind):
        found = [text for text in self.texts if text["type"] == kind]
        return found[-1] if found else None

    @property
    def state(self):
        return self.last("state") or self.last("hello")["state"]

    def until(self, holds):
        def held():
            self.answer()
            return holds()

        wait_until(held)


def vertex_near(page, place):
    """The drawn vertex nearest to a place, read off the topology."""
    topology = page.frames[0]
    (num_parts,) = struct.unpack_from("<I", topology, 4)
    hello = page.last("hello")
    sizes = [(3 * p["num_triangles"] + 2 * p["num_edges"] + 4 * p.get("num_tetrahedra", 0)) for p in hello["parts"]]
    assert num_parts == len(sizes)
    num_vertices = sum(part["num_vertices"] for part in hello["parts"])
    rest = np.frombuffer(topology, "<f4", 3 * num_vertices, 8 + 4 * sum(sizes)).reshape(-1, 3)
    return int(np.linalg.norm(rest - place, axis=1).argmin())


def pull(page, place, target):
    vertex = vertex_near(page, place)
    page.say(type="grab", vertex=vertex, point=place)
    page.until(lambda: page.state["grabbed_by"] == page.number)
    page.drag(1, target)


def test_a_pull_on_the_page_moves_the_python_object_and_back():
    live = resilin.LiveScene(weightless())
    page = Page(live._pages)
    hello = page.last("hello")
    assert hello["client"] == page.number and hello["saves"] is False
    assert page.frames[0][:4] == b"RST1"
    tip = live.positions[:, 0].argmax()
    pull(page, [1, 0.1, 0.1], [1, 0.1, 0.4])
    page.until(lambda: live.positions[tip, 2] - live.rest_positions[tip, 2] > 0.05)
    assert live.is_held and live.time > 0
    page.say(type="release")
    page.until(lambda: not live.is_held)
    # A change by the program is on the page.
    live.set(damping=7)
    corner = int(np.linalg.norm(live.rest_positions - [1, 0, 0], axis=1).argmin())
    live.pin(corner)
    page.until(lambda: page.state["values"]["damping"] == 7 and len(page.state["pinned"]) == 1)
    assert page.state["pinned"] == [vertex_near(page, live.rest_positions[corner])]
    page.say(type="reset")
    page.until(lambda: np.array_equal(live.positions, live.rest_positions))
    page.pages.end("over")
    assert page.words == ["over"]
    assert page.pages._thread is None


@pytest.mark.parametrize("scene", [weightless(), square(end_time=0.1)])
def test_a_simulation_is_where_its_page_has_led_it_and_goes_on_from_there(scene):
    simulation = resilin.Simulation(scene)
    for _ in range(2):
        simulation.step()
    time_before, start = simulation.time, simulation.positions
    live = resilin.LiveScene._of(simulation._core.play())
    np.testing.assert_array_equal(live.positions, start)
    np.testing.assert_array_equal(simulation.positions, start)
    dim = start.shape[1]
    place = live.positions[live.positions[:, 0].argmax()]
    live.grab(place)
    live.drag(place + 0.2 * np.eye(dim)[0])
    for _ in range(5):
        live.step()
    moved = simulation.positions
    assert np.abs(moved - start).max() > 1e-3
    np.testing.assert_array_equal(moved, live.positions)
    if simulation._core.is_dynamic:
        np.testing.assert_array_equal(simulation.velocities, live.velocities)
    assert simulation.time == time_before
    assert simulation.frame["energy"]["elastic"] == pytest.approx(
        resilin.LiveScene._of(simulation._core.play())._core.report().elastic_energy, rel=1e-9
    )
    live.release()
    if not simulation.is_finished:
        assert simulation.step()
        assert simulation.time > time_before
    np.testing.assert_array_equal(live.positions, simulation.positions)


def test_a_step_of_the_program_pauses_the_page():
    simulation = resilin.Simulation(square(end_time=0.5))
    simulation.view_pages = resilin.LiveScene._of(simulation._core.play())
    page = Page(simulation.view_pages._pages)
    page.until(lambda: page.last("status") and simulation.view_pages.time > 0)
    simulation.step()
    page.pages.wake()
    page.until(lambda: page.state["paused"])
    still = simulation.positions
    frames = len(page.frames)
    page.say(type="set", key="damping", value=1)  # does something, and moves nothing
    page.until(lambda: len(page.frames) > frames)
    np.testing.assert_array_equal(simulation.positions, still)
    page.say(type="play")
    page.until(lambda: not np.array_equal(simulation.positions, still))
    page.pages.end()


def test_nobody_looks_and_nothing_moves(monkeypatch):
    monkeypatch.setattr(live_pages, "PATIENCE", 0.05)
    live = resilin.LiveScene(square())
    page = Page(live._pages)
    page.answers = False
    wait_until(lambda: page.pages._thread is None)
    still = live.time
    time.sleep(0.1)
    assert live.time == still
    page.answers = True
    page.until(lambda: live.time > still)
    page.pages.close(page.number)
    wait_until(lambda: page.pages._thread is None)


def test_what_a_page_holds_is_let_go_with_it():
    live = resilin.LiveScene(weightless())
    page = Page(live._pages)
    pull(page, [1, 0.1, 0.1], [1, 0.1, 0.4])
    page.until(lambda: live.is_held)
    page.pages.close(page.number)
    assert not live.is_held
    page.pages.receive(page.number, "late")  # passed over
    other = Page(live._pages)
    assert other.number != page.number and other.last("hello")
    other.pages.end()


def test_nonsense_is_refused_in_words_and_a_page_that_cannot_be_reached_is_gone():
    live = resilin.LiveScene(weightless())
    page = Page(live._pages)
    for nonsense in ("", "{}", "\x00", '{"type": "grab"}', '{"type": "fly"}', b"", b"\xff" * 65, "[" * 5000):
        page.pages.receive(page.number, nonsense)
        page.until(lambda: page.last("error"))
        assert "\n" not in page.last("error")["message"]
        page.texts = [text for text in page.texts if text["type"] != "error"]

    def fails(_):
        raise OSError("no such comm")

    page.pages.open(fails, fails)
    assert list(page.pages._pages) == [page.number]
    page.pages.end()


def test_bodies_that_the_simulation_cannot_go_on_with_are_refused_and_leave_it_as_it_was():
    scene = square(gravity=[0, -9.81])
    scene["collider"] = [{"name": "floor", "kind": "half_space", "point": [0, -0.05], "normal": [0, 1]}]
    simulation = resilin.Simulation(scene)
    before = simulation.positions
    played = resilin.LiveScene._of(simulation._core.play())
    played.set(ground=False)  # as a page may
    for _ in range(30):
        played.step()
    assert played.positions[:, 1].min() < -0.1
    for _ in range(2):
        with pytest.raises(resilin.InputError, match="^view: expected a state .*reset the scene on its page"):
            _ = simulation.positions
    played.reset()
    np.testing.assert_array_equal(simulation.positions, before)
    assert simulation.step()


def test_vibrations_are_not_pulled_at():
    scene = cantilever(kind="modes", modes={"count": 2})
    scene["body"][0]["material"]["density"] = 1000
    with pytest.raises(resilin.InputError, match="view: expected a static or dynamic scene, got modal analysis"):
        resilin.Simulation(scene).view()


def test_a_program_that_ends_while_a_page_moves_ends_well():
    code = """
import resilin
scene = resilin.LiveScene({
    "simulation": {"kind": "dynamic", "time_step": 0.01, "end_time": 1, "gravity": [0, 0, -9.81]},
    "body": [{"mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}}}],
})
scene._pages.open(lambda message: None, print)
assert scene._pages._thread.is_alive()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_without_anywidget_it_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "resilin.widget", raising=False)
    with pytest.raises(ImportError, match=r"^view needs anywidget: pip install 'resilin\[notebook\]'"):
        resilin.LiveScene(weightless()).view()


def test_heights_that_are_none_are_refused():
    for wrong in (0, -3, 2.5, "tall", True, None):
        with pytest.raises(resilin.InputError, match="^height: expected a positive number of pixels"):
            resilin.LiveScene(weightless()).view(height=wrong)


class Cell:
    """The widget's module in a notebook, as far as Python hears of it."""

    def __init__(self, widget, monkeypatch):
        self.widget = widget
        self.told = []
        monkeypatch.setattr(widget, "send", lambda content, buffers=(): self.told.append((content, list(buffers))))

    def say(self, kind, *buffers, **more):
        self.widget._handle_custom_msg({"page": "p1", "kind": kind, **more}, [memoryview(b) for b in buffers])

    def kinds(self):
        return [content["kind"] for content, _ in self.told]


def test_the_widget_is_the_page_and_carries_its_words(monkeypatch):
    pytest.importorskip("anywidget")
    simulation = resilin.Simulation(weightless())
    widget = simulation.view(height=400)
    assert (widget.height, "export default" in widget._esm) == (400, True)
    cell = Cell(widget, monkeypatch)
    cell.say("html")
    html = bytes(cell.told[0][1][0]).decode()
    assert '<script id="source" type="application/json">{"kind": "hosted"}</script>' in html
    cell.say("open")
    wait_until(lambda: "bytes" in cell.kinds())
    hello = json.loads(next(content for content, _ in cell.told if content["kind"] == "text")["text"])
    assert hello["type"] == "hello"
    cell.say("bytes", b"\1\0\0\0\1\0\0\0")
    cell.say("text", text=json.dumps({"type": "fly"}))
    wait_until(lambda: any("fly" in content.get("text", "") for content, _ in cell.told))
    assert simulation.view() is not widget  # another cell, the same scene
    assert simulation.view()._pages is widget._pages
    simulation.set_material("beam", resilin.Material("neo_hookean", youngs_modulus=2e5, poissons_ratio=0.3))
    assert cell.told[-1][0] == {
        "page": "p1",
        "kind": "end",
        "text": "A body has another material now; call view() again.",
    }
    assert simulation.view()._pages is not widget._pages
    widget.close()
