"""Installs a wheel in an empty environment and uses it as who has just got it: try_wheel.py WHEEL [PYTHON].

Says how long it took from `pip install` to the first picture.
"""

import os
import pathlib
import re
import select
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

from files import ROOT

TIME_LIMIT = 600  # [s] for one command that hangs
PAGE_LIMIT = 60  # [s] until the page has its address
SCENE = ROOT / "examples" / "jelly_cube.toml"
ADDRESS = re.compile(r"Listening on (\S+)\s")
IMPORT = """
import pathlib, sys, resilin
assert pathlib.Path(resilin.__file__).is_relative_to(sys.prefix), resilin.__file__
simulation = resilin.Simulation(sys.argv[1])
assert simulation.step(), "a step that does not converge"
simulation.plot().save(sys.argv[2])
print(resilin.__version__)
"""


class TrialError(Exception):
    """In one line: what was done, and what came."""


def clean_environment(venv):
    """Nothing of this checkout, nor of an environment that is active."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "RESILIN", "VIRTUAL"))}
    return kept | {"PATH": f"{venv / 'bin'}{os.pathsep}{os.environ['PATH']}"}


def run(command, folder, environment):
    """The output of a command; fails with the end of what it has said."""
    shown = " ".join(map(str, command[:4]))
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=TIME_LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise TrialError(f"{shown}: took more than {TIME_LIMIT} s") from None
    if done.returncode != 0:
        last = " | ".join(done.stdout.strip().splitlines()[-3:])
        raise TrialError(f"{shown}: exit code {done.returncode}: {last}")
    return done.stdout


def require_png(path):
    if not path.is_file() or not path.read_bytes().startswith(b"\x89PNG"):
        raise TrialError(f"{path.name}: expected a picture, got {'another file' if path.is_file() else 'none'}")


def address_of(process):
    """Where a program that was just started listens."""
    said, end = "", time.monotonic() + PAGE_LIMIT
    while time.monotonic() < end:
        if select.select([process.stdout], [], [], 1)[0]:
            part = os.read(process.stdout.fileno(), 4096).decode()
            said += part
            if found := ADDRESS.search(said):
                return found[1]
            if not part:
                break
    raise TrialError(f"resilin view: expected an address, got {said.strip()[-200:]!r}")


def status_and_text(address):
    """Text of an HTTP answer."""
    try:
        with urllib.request.urlopen(address, timeout=PAGE_LIMIT) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, ""
    except OSError as error:
        raise TrialError(f"resilin view: expected an answer, got {error}") from None


def try_page(folder, environment):
    """The page is served to who has its token, and to nobody else."""
    command = ["resilin", "view", str(SCENE), "--port", "0", "--no-browser"]
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE)
    try:
        address = address_of(process)
        status, text = status_and_text(address)
        if status != 200 or '<script id="program"' not in text:
            raise TrialError(f"resilin view: expected the page, got status {status} and {len(text)} characters")
        status, _ = status_and_text(address.split("?")[0] + "?token=0")
        if status != 403:
            raise TrialError(f"resilin view: expected status 403 for a wrong token, got {status}")
    finally:
        process.kill()
        process.wait()


def try_wheel(wheel, python, venv):
    """Seconds from `pip install` to the first picture, in `venv`, which is made anew. Throws TrialError."""
    environment = clean_environment(venv)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        run([python, "-m", "venv", "--clear", venv], folder, environment)
        begin = time.monotonic()
        run([venv / "bin" / "pip", "install", "--quiet", "--disable-pip-version-check", wheel], folder, environment)
        run(["resilin", "run", SCENE, "--out", "out", "--quiet"], folder, environment)
        run(["resilin", "picture", "out", "--out", "first.png"], folder, environment)
        seconds = time.monotonic() - begin
        require_png(folder / "first.png")
        version = run([venv / "bin" / "python", "-c", IMPORT, SCENE, "plot.png"], folder, environment).strip()
        require_png(folder / "plot.png")
        if f"-{version}-" not in wheel.name:
            raise TrialError(f"{wheel.name}: expected the version of its name, got {version}")
        run(["resilin", "doctor"], folder, environment)
        try_page(folder, environment)
    return seconds


def main(wheel, python=sys.executable):
    with tempfile.TemporaryDirectory() as folder:
        try:
            seconds = try_wheel(pathlib.Path(wheel).resolve(), python, pathlib.Path(folder) / "venv")
        except TrialError as failure:
            sys.exit(str(failure))
    print(f"{seconds:.1f} s from pip install to the first picture")


if __name__ == "__main__":
    main(*sys.argv[1:])
