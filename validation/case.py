"""The rows of a validation case, how one is run and how its numbers are compared with the expected ones.

`expected.json` of a case holds its title, its topic and what it is compared with (in a few words, for the summary of
the page), its source and what is measured, and `rows`. A row has
    name, quick (./test runs it), scene (default scene.toml), set (values of the scene, as for `resilin run --set`)
    or, in place of scene, generate: the name of a function of contact_scenes with its arguments
    or, in place of scene and set, commands: lists of arguments for `resilin`, each of which prints JSON
    may_end_unsolved: steps without a solution (exit code 2) are no reason against the row; an expectation counts them
    remark (what to know about a row that fails)
    expect: a list of
        what        in words
        at          where it stands in the report: frames/-1/probes/tip/displacement/2, or frames/load=0.5/energy/total;
                    {} stands for each of `over`
        measure     or else a function of measures.py with its arguments
        value       expected, one for each of `over`; lists are vectors
        relative    tolerance, relative to the largest component of the value; or
        absolute    tolerance in the value's unit; or
        at_least, at_most    bounds, in place of value
        plus        [number, why]: stands in the expected value, but not in ours
What `every_row` holds is part of every row; its `expect` comes after the row's own.
"""

import dataclasses
import json
import math
import pathlib
import subprocess
import tempfile

from contact_scenes import scenes
from measures import MEASURES
from toml_text import toml

FOLDER = pathlib.Path(__file__).resolve().parent
TIME_LIMIT = 1800  # [s] for one run


@dataclasses.dataclass
class Comparison:
    """One number, or vector, beside its expectation; of several (`over`) the one that fits least."""

    what: str
    expected: str
    got: str
    error: float  # relative; outside of bounds: by how much
    tolerance: float  # relative; nan for bounds
    note: str = ""

    @property
    def passed(self):
        return self.error <= (0 if math.isnan(self.tolerance) else self.tolerance)


@dataclasses.dataclass
class Result:
    row: dict
    comparisons: list
    newton_iterations: int | None = None
    problem: str = ""  # why there is nothing to compare

    @property
    def passed(self):
        return not self.problem and all(comparison.passed for comparison in self.comparisons)


def cases():
    """Name of folder -> contents of its expected.json."""
    files = sorted(FOLDER.glob("*/expected.json"))
    return {file.parent.name: with_common(json.loads(file.read_text(encoding="utf-8"))) for file in files}


def with_common(case):
    common = case.get("every_row", {})
    case["rows"] = [
        {**common, **row, "expect": row.get("expect", []) + common.get("expect", [])} for row in case["rows"]
    ]
    return case


def run_row(program, case_name, row, out=None):
    """Runs a row in a folder of its own, or in `out`, and compares."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(out or temporary)
        try:
            report = reports_of_commands(program, row) if "commands" in row else run(program, case_name, row, folder)
            comparisons = [compare(entry, report, folder) for entry in row["expect"]]
        except (RuntimeError, OSError, LookupError, StopIteration, subprocess.TimeoutExpired) as error:
            return Result(row, [], problem=f"{type(error).__name__}: {error}")
    iterations = None
    if isinstance(report, dict):
        iterations = sum(frame.get("newton_iterations", 0) for frame in report["frames"]) or None
    return Result(row, comparisons, iterations)


def run(program, case_name, row, out):
    """The report of a scene; raises RuntimeError when the run does not come to its end."""
    scene = FOLDER / case_name / row.get("scene", "scene.toml")
    if "generate" in row:
        arguments = dict(row["generate"])
        scene = scenes.write(arguments.pop("name"), out / "scene", **arguments)
    command = [program, "run", scene, "--out", out, "--quiet", "--threads", "1"]
    for key, value in row.get("set", {}).items():
        command += ["--set", f"{key}={toml(value)}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIME_LIMIT)
    if done.returncode == 0 or (done.returncode == 2 and row.get("may_end_unsolved")):
        return json.loads((out / "report.json").read_text(encoding="utf-8"))
    reason = done.stderr.strip()
    if done.returncode == 2:
        reason = json.loads((out / "report.json").read_text(encoding="utf-8"))["reason"]
    raise RuntimeError(f"exit code {done.returncode}: {reason}".replace(f"{FOLDER}/", ""))


def reports_of_commands(program, row):
    reports = []
    for arguments in row["commands"]:
        done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False, timeout=TIME_LIMIT)
        if done.returncode != 0:
            raise RuntimeError(f"exit code {done.returncode}: {done.stderr.strip()}")
        reports.append(json.loads(done.stdout))
    return reports


def find(report, path):
    """The value at a path of keys, indices and key=number, which is the entry of a list that has it."""
    value = report
    for part in path.split("/"):
        if isinstance(value, dict):
            value = value[part]
        elif "=" in part:
            value = entry_with(value, *part.split("="))
        else:
            value = value[int(part)]
    return value


def entry_with(entries, key, number):
    return next(entry for entry in entries if math.isclose(entry[key], float(number), rel_tol=1e-9))


def compare(entry, report, folder):
    """The worst of the values that an expectation is about."""
    if "measure" in entry:
        arguments = dict(entry["measure"])
        measured = [MEASURES[arguments.pop("name")](report, folder, **arguments)]
    else:
        places = entry.get("over", [None])
        measured = [find(report, entry["at"].replace("{}", str(place))) for place in places]
    listed = [entry.get(key) if "over" in entry else [entry.get(key)] for key in ("value", "at_least", "at_most")]
    columns = [column or [None] * len(measured) for column in listed]
    found = [compare_one(entry, *values) for values in zip(measured, *columns, strict=True)]
    worst = max(range(len(found)), key=lambda i: math.inf if math.isnan(found[i].error) else found[i].error)
    if "over" in entry:
        found[worst].note = f"worst of {len(found)}, at {place_name(entry['at'], entry['over'][worst])}"
    return found[worst]


def place_name(path, place):
    """Reads the text in place of {} in a path, with its name: load=0.5, modes 3."""
    before, _, _ = path.partition("{}")
    name = before.rsplit("/", 1)[-1] or before.split("/")[-2] + " "
    return f"{name}{place}"


def compare_one(entry, got, value, at_least, at_most):
    if value is None:
        return compare_with_bounds(entry["what"], got, at_least, at_most)
    shift = entry.get("plus", [0.0])[0]
    expected = value if isinstance(value, list) else [value - shift]
    ours = got if isinstance(got, list) else [got]
    scale = max(map(abs, expected))
    error = max(abs(a - b) for a, b in zip(ours, expected, strict=True)) / scale
    tolerance = entry["relative"] if "relative" in entry else entry["absolute"] / scale
    return Comparison(entry["what"], short(value), short(got + shift if shift else got), error, tolerance)


def compare_with_bounds(what, got, at_least, at_most):
    bounds, distances = [], [0.0]
    if at_least == at_most:
        bounds.append(short(at_least))
        distances.append(abs(got - at_least))
    elif at_least is not None:
        bounds.append(f">= {short(at_least)}")
        distances.append(at_least - got)
    if at_most is not None and at_most != at_least:
        bounds.append(f"<= {short(at_most)}")
        distances.append(got - at_most)
    error = max(distances) if math.isfinite(got) else math.inf
    return Comparison(what, ", ".join(bounds), short(got), error, math.nan)


def short(value):
    """Ten digits; vectors in brackets."""
    if isinstance(value, list):
        return "(" + ", ".join(map(short, value)) + ")"
    return f"{value:.10g}"
