"""Parameter sweeps of a base scene, in this process or on a Dask cluster; see docs/sweep.md."""

from __future__ import annotations

import os
import pathlib
import tempfile
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from resilin import _core
from resilin.arrays import file_path, refuse
from resilin.progress import SweepProgress
from resilin.sweep_definition import Definition, make_sweep
from resilin.sweep_table import SweepTable, read_sweep

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Literal

    from resilin.typing import AnyPath, Scene, SweepMethod, SweepParameters, SweepQuantity

__all__ = ["SweepTable", "read_sweep", "sweep"]


def sweep(
    base: Scene,
    parameters: SweepParameters | None = None,
    *,
    method: SweepMethod = "grid",
    samples: int | None = None,
    seed: int = 0,
    quantities: Sequence[SweepQuantity] = (),
    keep: Literal["none", "all", "failed"] | Sequence[int] = "none",
    out: AnyPath | None = None,
    client: Any = None,
    shard: str = "1/1",
    jobs: int = 0,
    threads: int = 0,
    in_flight: int = 0,
    retry_failed: bool = False,
    update: bool = False,
    progress: bool | None = None,
) -> SweepTable:
    """Runs a scene for many parameter values; scenes finished in `out` are not run again.

    The folder is that of `resilin sweep`, and both may work in it at once.

    Parameters
    ----------
    base : path or dict
        The scene; a dict may hold arrays and `Mesh` objects. Without `parameters` the path of a SWEEP.toml.
    parameters : dict
        {"body.beam.material.youngs_modulus": [1e5, 1e6]}: a list of values for each key (as after --set), or
        {"linspace": [a, b, n]}, {"logspace": [a, b, n]}, {"range": [a, b, step]}, and for sampling methods {"uniform":
        [a, b]}, {"log_uniform": [a, b]}. Values may be arrays and `Mesh` objects.
    method : str
        "grid": all combinations, the last parameter varies fastest; "list": the first values together, the second ...;
        "latin_hypercube" and "sobol": `samples` scenes drawn with `seed`.
    quantities : list
        Columns of the table: "probe.tip.displacement.z", {"name": "peak", "of": "max.von_mises", "over": "max"}; by
        default probes, reactions, elastic energy and smallest volume ratio at the end.
    keep : str or list of int
        Scenes whose result folder is kept.
    out : path, optional
        Folder; by default a temporary one, deleted with the table.
    client : distributed.Client, optional
        Runs the scenes on its workers. They need the files of the scene under the same paths, and `out` where results
        are kept. By default they are run by threads of this process.
    shard : str
        "i/n": only part i of n.
    jobs : int
        Without a client: scenes at once; 0 chooses.
    threads : int
        Without a client: of all scenes together, 0 all cores. With one: of each scene, 0 one, for a worker runs as many
        scenes at once as it has threads.
    in_flight : int
        With a client: tasks that are handed out at once, which bounds the memory of client and scheduler; 0 means four
        for each thread of the workers.
    retry_failed : bool
        Runs failed scenes again.
    update : bool
        After a change of the sweep: keeps rows that still belong to it.
    progress : bool, optional
        Whether to show a progress line; by default in a terminal and in a notebook.

    Returns
    -------
    SweepTable

    Raises
    ------
    InputError
        For keys that the scene does not have, a folder of another sweep ...; a wrong scene is a row of the table.

    Examples
    --------
    >>> table = resilin.sweep("beam.toml", {"body.beam.material.youngs_modulus": np.geomspace(1e5, 1e7, 20)})
    >>> table["probe.tip.displacement.z"]
    """
    definition = _definition(base, parameters, method, samples, seed, quantities, keep)
    made = make_sweep(definition)
    owner = tempfile.TemporaryDirectory(prefix="resilin-sweep-") if out is None else None
    path = owner.name if owner is not None else os.path.abspath(file_path(out or "", "out"))
    folder = _core.SweepFolder(path, made, update)
    line = SweepProgress(progress)
    try:
        if client is None:
            folder.run(shard, retry_failed, int(jobs), int(threads), line.show if line.is_shown else None)
        else:
            from resilin.cluster import ClusterRun

            queue = _core.SceneQueue(folder, shard, retry_failed)
            ClusterRun(
                client,
                definition,
                made,
                folder,
                queue,
                path,
                shard,
                retry_failed,
                int(threads) or 1,
                int(in_flight),
                line,
            ).run()
    finally:
        line.end()
    return SweepTable(pathlib.Path(path), owner)


def _definition(
    base: Scene,
    parameters: SweepParameters | None,
    method: str,
    samples: int | None,
    seed: int,
    quantities: Sequence[SweepQuantity],
    keep: str | Sequence[int],
) -> Definition:
    if parameters is None:
        if isinstance(base, Mapping):
            refuse("parameters", "a dict of keys and their values", "none")
        return Definition(os.path.abspath(file_path(base, "base")), {}, "")
    if not isinstance(parameters, Mapping):
        refuse("parameters", "a dict of keys and their values", type(parameters).__name__)
    values: dict[str, Any] = {
        "base": dict(base) if isinstance(base, Mapping) else os.path.abspath(file_path(base, "base")),
        "parameters": dict(parameters),
        "method": method,
        "seed": int(seed),
        "keep": keep if isinstance(keep, str) else [int(number) for number in keep],
    }
    if samples is not None:
        values["samples"] = int(samples)
    if quantities:
        values["quantities"] = [dict(q) if isinstance(q, Mapping) else str(q) for q in quantities]
    return Definition("", values, os.getcwd())
