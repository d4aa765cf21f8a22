"""Scenes of a sweep on the workers of a Dask cluster (the package distributed)."""

from __future__ import annotations

import importlib
import pickle
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from resilin import _core
from resilin.arrays import refuse
from resilin.sweep_definition import make_sweep

if TYPE_CHECKING:
    from collections.abc import Iterator

    from resilin.progress import SweepProgress
    from resilin.sweep_definition import Definition

TASK_SECONDS = 0.5  # a task is at least so long, for handing it out takes a millisecond
MOST_SCENES = 256  # in one task
TASKS_PER_THREAD = 4
BETWEEN_COUNTS = 2.0  # [s]: how often the workers are counted anew
BETWEEN_TABLES = 30.0  # [s]

Task = tuple[int, str]  # number and hash of a scene


class Row(NamedTuple):
    """Result of a scene that a worker sends back."""

    hash: str
    line: str
    is_done: bool
    seconds: float


_made: dict[bytes, _core.Sweep] = {}  # sweeps of this worker


def given(definition: bytes) -> bytes:
    """A task of its own, so that the definition travels once to each worker and is there again when one dies."""
    return definition


def run_scenes(definition: bytes, tasks: list[Task], folder: str, threads: int) -> list[Row]:
    """Runs one scene on a worker."""
    sweep = _made.get(definition)
    if sweep is None:
        if len(_made) >= 4:
            _made.clear()
        sweep = _made[definition] = make_sweep(pickle.loads(definition))
    if _core.num_threads() != threads:
        _core.set_num_threads(threads)
    rows = []
    for scene, wanted in tasks:
        if sweep.hash(scene) != wanted:
            refuse(
                f"worker: scene {scene}",
                "the files and the version that the client has",
                "others",
                "give the workers the same version of resilin and the same files",
            )
        line, is_done, seconds = _core.run_scene(sweep, scene, folder)
        rows.append(Row(wanted, line, is_done, seconds))
    return rows


class ClusterRun:
    """A sweep on a cluster while it goes on."""

    def __init__(
        self,
        client: Any,
        definition: Definition,
        sweep: _core.Sweep,
        folder: _core.SweepFolder,
        queue: _core.SceneQueue,
        path: str,
        shard: str,
        retries_failed: bool,
        threads: int,
        in_flight: int,
        line: SweepProgress,
    ) -> None:
        distributed: Any = importlib.import_module("distributed")
        self._client = client
        self._sweep = sweep
        self._folder = folder
        self._queue = queue
        self._path = path
        self._threads = threads
        self._wanted_in_flight = in_flight
        self._line = line
        self._definition = client.submit(given, pickle.dumps(definition), pure=False)
        self._completed = distributed.as_completed(loop=client.loop)
        self._handed_out: dict[str, tuple[Any, list[Task]]] = {}
        self._suspects: list[Task] = []  # tasks of a worker that died; each is to be run alone
        self._is_alone = False  # the one task that is handed out is a suspect
        self._start = time.monotonic()
        self._next_count = self._next_table = 0.0
        self._room = 1
        self._scenes, self._done, self._failed = folder.count(shard)
        if retries_failed:
            self._failed = 0
        self._run = 0
        self._seconds = 0.0

    def run(self) -> None:
        """Hands out the scenes of the queue, a bounded number of them at once, and keeps their rows as they come."""
        threads_before = _core.num_threads()  # the workers may be threads of this process
        try:
            self._hand_out()
            for future in self._completed:
                _, tasks = self._handed_out.pop(future.key)
                self._take(future, tasks)
                future.release()
                self._show()
                self._hand_out()
        finally:
            self._cancel()
            _core.set_num_threads(threads_before)
            self._folder.write_table()

    def _cancel(self) -> None:
        """Takes back what has not ended."""
        futures = [future for future, _ in self._handed_out.values()]
        if futures:
            self._client.cancel(futures)
        for _, tasks in self._handed_out.values():
            for _, scene_hash in tasks:
                self._folder.release(scene_hash)
        for _, scene_hash in self._suspects:
            self._folder.release(scene_hash)
        self._handed_out.clear()

    def _hand_out(self) -> None:
        room = self._room_now()
        while len(self._handed_out) < room:
            tasks = list(self._next_tasks())
            if not tasks:
                break
            self._is_alone = False
            self._submit(tasks)
        if not self._handed_out and self._suspects:
            self._is_alone = True
            self._submit([self._suspects.pop()])

    def _submit(self, tasks: list[Task]) -> None:
        future = self._client.submit(run_scenes, self._definition, tasks, self._path, self._threads, pure=False)
        self._handed_out[future.key] = (future, tasks)
        self._completed.add(future)

    def _next_tasks(self) -> Iterator[Task]:
        mean = self._seconds / self._run if self._run else TASK_SECONDS
        for _ in range(max(1, min(MOST_SCENES, int(TASK_SECONDS / max(mean, 1e-6))))):
            task = self._queue.next()
            if task is None:
                return
            yield task

    def _room_now(self) -> int:
        """Clusters grow and shrink."""
        now = time.monotonic()
        if self._wanted_in_flight > 0:
            return self._wanted_in_flight
        if now >= self._next_count:
            self._room = max(1, TASKS_PER_THREAD * sum(self._client.nthreads().values()))
            self._next_count = now + BETWEEN_COUNTS
        return self._room

    def _take(self, future: Any, tasks: list[Task]) -> None:
        if future.status == "finished":
            for row in future.result():
                self._keep(row)
            return
        error = future.exception() if future.status == "error" else None
        if isinstance(error, _core.InputError):
            for _, scene_hash in tasks:
                self._folder.release(scene_hash)
            raise error
        if error is None and self._client.status in ("closed", "closing"):
            raise RuntimeError("the client of the sweep was closed")
        if error is None:  # lost with its worker
            self._submit(tasks)
            return
        if not self._is_alone:  # another one may be to blame, which the worker had beside it
            self._suspects.extend(tasks)
            return
        ((scene, scene_hash),) = tasks
        reason = f"{type(error).__name__}: {error}"
        self._keep(Row(scene_hash, _core.failed_row(self._sweep, scene, reason), False, 0.0))

    def _keep(self, row: Row) -> None:
        self._folder.append(row.hash, row.line)
        self._run += 1
        self._seconds += row.seconds
        if row.is_done:
            self._done += 1
        else:
            self._failed += 1

    def _show(self) -> None:
        elapsed = time.monotonic() - self._start
        left = max(self._scenes - self._done - self._failed, 0)
        self._line.show(self._done, self._failed, self._scenes, elapsed / self._run * left if self._run else None)
        now = time.monotonic()
        if now >= self._next_table:
            if self._next_table > 0:
                self._folder.write_table()
            self._next_table = time.monotonic() + max(BETWEEN_TABLES, 20 * (time.monotonic() - now))
