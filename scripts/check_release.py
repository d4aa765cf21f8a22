"""Tests of the release script without a build: which interpreters serve, what is tried, what counts."""

import contextlib
import hashlib
import io
import pathlib
import re
import subprocess
import tarfile
import tempfile

import interpreters
import release
import try_wheel
from files import ROOT, project_version

PYTHON = """#!/bin/sh
echo '{{"kind": "{kind}", "version": {version}, "free_threaded": {free}, "lacks": {lacks}}}'
"""


def put_interpreter(path, version, kind="CPython", free="false", lacks="[]"):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(PYTHON.format(kind=kind, version=version, free=free, lacks=lacks), encoding="utf-8")
    path.chmod(0o755)


def problems_of_search(folder):
    """Shims that do not run, missing headers and other kinds are passed over, and said."""
    versions = [(3, minor) for minor in range(9, 16)]
    path, pyenv = folder / "bin", folder / "pyenv" / "versions"
    put_interpreter(path / "python3.9", [3, 9, 1], lacks='["Python.h"]')
    put_interpreter(path / "python3.10", [3, 10, 1])
    put_interpreter(path / "python3.11", [3, 11, 1], kind="PyPy")
    put_interpreter(pyenv / "3.11.9" / "bin" / "python3.11", [3, 11, 9])
    put_interpreter(pyenv / "3.11.10" / "bin" / "python3.11", [3, 11, 10])
    (path / "python3.12").write_text("#!/bin/sh\nexit 127\n", encoding="utf-8")
    (path / "python3.12").chmod(0o755)
    put_interpreter(path / "python3.13", [3, 13, 0], free="true")
    (path / "python3.14").write_text("not executable", encoding="utf-8")
    environment = {"PATH": f"{folder / 'nowhere'}:{path}", "PYENV_ROOT": str(folder / "pyenv")}
    found, lines = interpreters.find_interpreters(versions, environment)
    problems = []
    if {version: one.version for version, one in found.items()} != {(3, 10): (3, 10, 1), (3, 11): (3, 11, 10)}:
        problems.append(f"interpreters: expected 3.10.1 and 3.11.10, got {found}")
    for line, words in zip(
        lines, ("lacks Python.h", "does not run", "free-threaded", "neither", "neither"), strict=True
    ):
        if words not in line:
            problems.append(f"interpreters: expected a line with {words!r}, got {line!r}")
    return problems


def wheels_for(*minors):
    found = {(3, m): interpreters.Interpreter(pathlib.Path(f"python3.{m}"), (3, m, 0)) for m in minors}
    wheels = interpreters.planned_wheels(found, (3, 12))
    plan = [(wheel.builder.minor[1], [user.minor[1] for user in wheel.users]) for wheel in wheels]
    return plan, interpreters.lines_about_untried(wheels, [(3, m) for m in range(10, 15)])


def problems_of_plan():
    cases = [  # interpreters here, (builder, users) of each wheel, words about the others
        ((10, 11, 12, 13), [(10, [10]), (11, [11]), (12, [12, 13])], ["3.14: served"]),
        ((11, 14), [(11, [11]), (14, [14])], ["3.10: no wheel", "3.12: served", "3.13: served"]),
        ((10,), [(10, [10])], [f"3.{minor}: no wheel" for minor in (11, 12, 13, 14)]),
        ((), [], [f"3.{minor}: no wheel" for minor in (10, 11, 12, 13, 14)]),
    ]
    problems = []
    for here, plan, words in cases:
        found, lines = wheels_for(*here)
        agrees = len(lines) == len(words) and all(w in line for w, line in zip(words, lines, strict=True))
        if found != plan or not agrees:
            problems.append(f"plan for {here}: expected {plan} and {words}, got {found} and {lines}")
    if interpreters.stable_from() not in interpreters.supported_versions():
        problems.append("pyproject.toml: wheel.py-api is none of the versions that the classifiers name")
    return problems


def problems_of_recipe():
    """conda's recipe is of the version that CMakeLists.txt names."""
    text = (ROOT / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    version = re.search(r'^  version: "(.*)"$', text, re.MULTILINE)[1]
    return [] if version == project_version() else [f"packaging/conda/recipe.yaml: is of version {version}"]


def problems_of_archive(folder):
    source = folder / "core.hpp"
    source.write_text("#pragma once\n", encoding="utf-8")
    archive = folder / "resilin-1.tar.gz"
    with tarfile.open(archive, "w:gz") as out:
        out.add(source, arcname="resilin-1/src/core.hpp")
    names = ["src/core.hpp", "src/lost.cpp", "docs/page.md", "pyproject.toml"]
    missing = release.missing_sources(archive, names)
    return [] if missing == ["src/lost.cpp", "pyproject.toml"] else [f"archive of the sources: got {missing}"]


def problems_of_checksums(folder):
    """sha256sum agrees, and finds a file that has changed."""
    folder.mkdir()
    (folder / "a.whl").write_bytes(b"one")
    (folder / "b.tar.gz").write_bytes(b"two")
    release.write_checksums(folder)
    release.write_checksums(folder)  # its own file is not among them
    check = ["sha256sum", "--check", "--strict", "--quiet", "SHA256SUMS"]
    problems = []
    if subprocess.run(check, cwd=folder, capture_output=True, check=False).returncode != 0:
        problems.append("checksums: sha256sum does not read them")
    if hashlib.sha256(b"one").hexdigest() + "  a.whl" not in (folder / "SHA256SUMS").read_text().splitlines():
        problems.append("checksums: the line of a.whl is wrong")
    (folder / "a.whl").write_bytes(b"other")
    if subprocess.run(check, cwd=folder, capture_output=True, check=False).returncode == 0:
        problems.append("checksums: a file that has changed is not found")
    return problems


def problems_of_failures(folder):
    """A failure is said in one line, does not count, and does not keep the rest from being made."""
    faults = []

    def fails():
        try_wheel.require_png(folder / "no.png")

    with contextlib.redirect_stdout(io.StringIO()) as said:
        results = [release.attempt(faults, work) for work in (fails, lambda: 7)]
    words = "no.png: expected a picture, got none"
    if (results, faults, said.getvalue()) != ([None, 7], [words], f"FAILED {words}\n"):
        return [f"what fails: expected one line of words, got {results}, {faults} and {said.getvalue()!r}"]
    environment = try_wheel.clean_environment(folder)
    leaks = [name for name in environment if name.startswith(("PYTHON", "RESILIN"))]
    return [f"the environment of a trial has {', '.join(leaks)}"] if leaks else []


def find_problems():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        return [
            *problems_of_search(folder / "search"),
            *problems_of_plan(),
            *problems_of_recipe(),
            *problems_of_archive(folder),
            *problems_of_checksums(folder / "sums"),
            *problems_of_failures(folder),
        ]
