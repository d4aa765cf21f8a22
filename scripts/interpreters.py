"""The CPython interpreters of this machine that wheels can be built for, and which wheels serve which of them."""

import dataclasses
import json
import os
import pathlib
import subprocess
import tomllib

from files import ROOT

TIME_LIMIT = 60  # [s] for an interpreter that does not answer
# Query of an interpreter: a wheel needs its headers, a trial its venv.
QUESTION = """
import importlib.util, json, os, platform, sys, sysconfig
headers = os.path.join(sysconfig.get_paths()["include"], "Python.h")
lacks = [] if os.path.exists(headers) else ["Python.h"]
lacks += [name for name in ("venv", "ensurepip") if importlib.util.find_spec(name) is None]
print(json.dumps({"kind": platform.python_implementation(), "version": list(sys.version_info[:3]),
                  "free_threaded": bool(sysconfig.get_config_var("Py_GIL_DISABLED")), "lacks": lacks}))
"""


@dataclasses.dataclass(frozen=True)
class Interpreter:
    path: pathlib.Path
    version: tuple  # (3, 10, 13)

    @property
    def minor(self):
        return self.version[:2]


@dataclasses.dataclass(frozen=True)
class PlannedWheel:
    builder: Interpreter
    users: tuple  # those that it is to be tried with; the builder is one of them
    is_stable: bool  # it serves newer ones, too

    @property
    def name(self):
        plus = " and later" if self.is_stable else ""
        return f"CPython {dotted(self.first)}{plus}"

    @property
    def first(self):
        return self.builder.minor if not self.is_stable else stable_from()


def dotted(version):
    return ".".join(map(str, version))


def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def stable_from():
    """(3, 12): the first version whose wheel keeps to the stable ABI."""
    digits = project()["tool"]["scikit-build"]["wheel"]["py-api"].removeprefix("cp")
    return int(digits[0]), int(digits[1:])


def supported_versions():
    """[(3, 10), ...]: those that the classifiers name."""
    last = [line.rsplit(" :: ", 1)[-1] for line in project()["project"]["classifiers"] if "Python :: 3." in line]
    return sorted(tuple(map(int, version.split("."))) for version in last)


def candidates(version, environment):
    """Files that may be an interpreter of this version: on PATH, then pyenv's, the newest first."""
    name = f"python{dotted(version)}"
    for folder in environment.get("PATH", "").split(os.pathsep):
        if folder and os.access(path := pathlib.Path(folder, name), os.X_OK):
            yield path
    pyenv = pathlib.Path(environment.get("PYENV_ROOT") or pathlib.Path(environment.get("HOME", "/"), ".pyenv"))
    kept = [path for path in pyenv.glob(f"versions/{dotted(version)}.*/bin/{name}") if os.access(path, os.X_OK)]
    yield from sorted(kept, key=lambda path: numbers_of(path.parts[-3]), reverse=True)


def numbers_of(version):
    return [int(part) if part.isdigit() else -1 for part in version.split(".")]


def examine(path, version):
    """(interpreter, None), or (None, why it does not serve)."""
    try:
        run = subprocess.run(
            [path, "-I", "-c", QUESTION], capture_output=True, text=True, timeout=TIME_LIMIT, check=True
        )
        answer = json.loads(run.stdout)
    except (OSError, subprocess.SubprocessError, json.JSONDecodeError):
        return None, "does not run"
    found = tuple(answer["version"])
    if found[:2] != version or answer["kind"] != "CPython":
        return None, f"is {answer['kind']} {dotted(found)}"
    if answer["free_threaded"]:
        return None, "is the free-threaded kind, for which there are no wheels"
    if answer["lacks"]:
        return None, f"lacks {', '.join(answer['lacks'])}"
    return Interpreter(path, found), None


def find_interpreters(versions, environment=os.environ):
    """({version: interpreter}, [a line about each version that has none])."""
    found, lines = {}, []
    for version in versions:
        refused = []
        for path in candidates(version, environment):
            interpreter, why = examine(path, version)
            if interpreter:
                found[version] = interpreter
                break
            refused.append(f"{path} {why}")
        else:
            looked = "; ".join(refused) or "neither on PATH nor among pyenv's"
            lines.append(f"CPython {dotted(version)}: none here ({looked})")
    return found, lines


def planned_wheels(found, stable):
    """Wheels for {version: interpreter}: one each before `stable`, one for all from there on, built by the oldest."""
    wheels = [PlannedWheel(found[v], (found[v],), is_stable=False) for v in sorted(found) if v < stable]
    newer = tuple(found[v] for v in sorted(found) if v >= stable)
    return wheels + ([PlannedWheel(newer[0], newer, is_stable=True)] if newer else [])


def lines_about_untried(wheels, versions):
    """Remarks on versions that a wheel serves and nobody has tried it with, and on those without a wheel."""
    tried = {user.minor for wheel in wheels for user in wheel.users}
    stable = [wheel for wheel in wheels if wheel.is_stable]
    lines = []
    for version in versions:
        if version in tried:
            continue
        served = stable and version >= stable[0].first
        lines.append(
            f"CPython {dotted(version)}: "
            + (f"served by the wheel for {stable[0].name}, but not tried here" if served else "no wheel")
        )
    return lines
