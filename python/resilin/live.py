"""An interactive scene: dragged, pinned and poked while it moves."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from resilin import _core
from resilin.arrays import describe, real_array, refuse
from resilin.live_pages import LivePages
from resilin.mesh import warn
from resilin.present_state import PresentState
from resilin.scene import read_scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from resilin.typing import ControlValue, IntegerArray, Overrides, RealArray, Scene
    from resilin.widget import LiveView

    Floats = NDArray[np.float64]


class LiveScene(PresentState[_core.LiveScene]):
    """The interactive scene of `resilin view`, controlled by a program.

    Steps use backward Euler; static scenes move under their full loads. A scene stays finite under any drag and comes
    to rest after its release.

    Parameters
    ----------
    scene, overrides
        As for `Simulation`.

    Examples
    --------
    >>> scene = resilin.LiveScene("beam.toml")
    >>> scene.grab([1, 0.1, 0.1])
    >>> for height in np.linspace(0.1, 0.5, 30):
    ...     scene.drag([1, 0.1, height])
    ...     scene.step()
    >>> scene.hand_force
    """

    def __init__(self, scene: Scene, overrides: Overrides = ()) -> None:
        self._core = _core.LiveScene(read_scene(scene, overrides))
        self._pages = LivePages(self._core)
        warn(self._core.warnings)

    @classmethod
    def _of(cls, core: _core.LiveScene) -> LiveScene:
        """A live scene of a simulation."""
        scene = cls.__new__(cls)
        scene._core = core
        scene._pages = LivePages(core)
        return scene

    def step(self, seconds: float | None = None) -> _core.LiveReport:
        """Takes one time step of `controls["time_step"]`.

        Parameters
        ----------
        seconds : float, optional
            Time limit: no Newton iteration starts that would end later, as on the page; results then depend on the
            machine. By default each step converges to `controls["tolerance"]`.

        Returns
        -------
        LiveReport
            converged, at_rest, newton_iterations, residual [N], relative_residual, min_volume_ratio, inverted_cells,
            elastic_energy and kinetic_energy [J], words.
        """
        if seconds is not None and not seconds >= 0:
            refuse("seconds", "a number of at least 0", repr(seconds))
        self._core.step(None if seconds is None else float(seconds))
        self._pages.wake()
        return self._core.report()

    def grab(self, place: RealArray) -> int:
        """Grabs the vertex nearest to a point and its neighbourhood; there is one hand.

        Parameters
        ----------
        place : array (d,)
            Point in the present configuration [m].

        Returns
        -------
        int
            The vertex, a row of `positions`.
        """
        vertex = self._core.grab(_numbers(place, "grab"))
        self._pages.wake()
        return vertex

    def drag(self, place: RealArray) -> None:
        """Pulls the grabbed vertex towards a point, with at most `controls["max_force"]`, until `release`.

        Parameters
        ----------
        place : array (d,)
            Target [m].
        """
        self._core.drag(_numbers(place, "drag"))
        self._pages.wake()

    def release(self) -> None:
        """Releases the grabbed vertex."""
        self._core.release()
        self._pages.wake()

    @property
    def is_held(self) -> bool:
        """Whether the hand holds a vertex."""
        return self._core.is_grabbed()

    @property
    def hand_force(self) -> Floats:
        """Force of the hand on the body (d,) [N]; zero if it holds nothing."""
        return np.array(self._core.hand_force())

    def pin(self, vertices: int | IntegerArray) -> None:
        """Fixes vertices at their present positions.

        Parameters
        ----------
        vertices : int or array of int
            Rows of `positions`.
        """
        self._core.pin(_vertices(vertices, "pin"), True)
        self._pages.wake()

    def unpin(self, vertices: int | IntegerArray | None = None) -> None:
        """Releases pinned vertices; boundary conditions of the scene stay.

        Parameters
        ----------
        vertices : int or array of int, optional
            Rows of `positions`; by default all that are pinned.
        """
        if vertices is None:
            self._core.unpin_all()
        else:
            self._core.pin(_vertices(vertices, "unpin"), False)
        self._pages.wake()

    @property
    def pinned(self) -> list[int]:
        """The pinned vertices."""
        return self._core.pinned()

    def poke(self, center: RealArray, radius: float) -> None:
        """Adds a ball that pushes bodies away; it moves towards its target as fast as they allow.

        Parameters
        ----------
        center : (d,)
            Target of its centre [m].
        radius : float
            Radius [m].
        """
        self._core.poke(_numbers(center, "poke"), float(radius))
        self._pages.wake()

    def stop_poking(self) -> None:
        """Removes the ball."""
        self._core.stop_poking()
        self._pages.wake()

    @property
    def ball(self) -> Floats | None:
        """Present centre of the ball (d,) [m]; None without one."""
        center = self._core.ball()
        return None if center is None else np.array(center)

    @property
    def controls(self) -> dict[str, ControlValue]:
        """Parameters for `set`, with present values: material of all bodies, gravity, time step, ground, hand.

        Motors of joints and cables have the names "drive.NAME": `scene.set(**{"drive.crank": 1.5})` [rad].
        """
        return dict(self._core.controls())

    def set(self, **controls: ControlValue | RealArray) -> None:
        """Changes controls: `scene.set(youngs_modulus=2e5, gravity=[0, 0, -1.6])`.

        Parameters
        ----------
        **controls
            Values by name, in the units of `controls`: [Pa], [m/s^2], [s] ...

        Raises
        ------
        InputError
            For an unknown name or a value that is not allowed; then none changes.
        """
        self._core.set([(name, _plain(value, f"controls: {name}")) for name, value in controls.items()])
        self._pages.wake()

    def view(self, height: int = 560) -> LiveView:
        """Interactive page of the scene as a notebook widget.

        While the page is visible the scene runs in real time. Actions on the page and on this object affect the same
        scene. A `step` pauses the page, so that programs continue from a state that nobody moves.

        Parameters
        ----------
        height : int
            [px]

        Returns
        -------
        LiveView
            A widget, displayed at the end of a cell; needs anywidget (`resilin[notebook]`).
        """
        if isinstance(height, bool) or not isinstance(height, int) or height < 1:
            refuse("height", "a positive number of pixels", repr(height))
        try:
            widget = import_module("resilin.widget")
        except ImportError as error:
            raise ImportError(f"view needs anywidget: pip install 'resilin[notebook]' ({error})") from error
        shown: LiveView = widget.LiveView(self._pages, self._core.title() or "Resilin", height)
        return shown

    def reset(self) -> None:
        """Returns to the start; the controls keep their values."""
        self._core.reset()
        self._pages.wake()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._core.time()

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
        return self._core.body_names()

    def __reduce__(self) -> NoReturn:
        raise TypeError("a LiveScene cannot be pickled; pickle its scene")

    def __repr__(self) -> str:
        title = f" {self._core.title()}" if self._core.title() else ""
        return f"<resilin.LiveScene{title}: t = {self.time:.4g} s>"


def _numbers(value: RealArray, place: str) -> list[float]:
    array = real_array(value, place)
    if array.ndim != 1:
        refuse(place, "the coordinates of a point, (d,)", describe(array.shape))
    return [float(number) for number in array]


def _vertices(value: int | IntegerArray, place: str) -> list[int]:
    numbers = np.atleast_1d(np.asarray(value))
    if numbers.size and numbers.dtype.kind not in "iu":
        refuse(place, "numbers of vertices", str(numbers.dtype))
    for number in numbers.ravel():
        if abs(int(number)) > np.iinfo(np.int32).max:
            refuse(place, "numbers of vertices", str(number))
    return [int(number) for number in numbers.ravel()]


def _plain(value: ControlValue | RealArray, place: str) -> ControlValue:
    """As the core wants it: a flag, a number, a text or a list of numbers."""
    if isinstance(value, bool | str):
        return value
    array = real_array(value, place)
    return float(array) if array.ndim == 0 else [float(number) for number in array.ravel()]
