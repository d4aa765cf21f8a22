"""Runs every line of README.md and docs/ that a reader may type, as it stands and in its order: shell and Python.

A folder stands for the clone: its program, data, examples and docs are those of the clone, and what lines write stays
in it. README.md comes first; what it leaves, such as beam.toml, is there for the pages after it. What takes minutes or
the network (pip, npm, cmake, gmsh, ./test, the site) is only looked at here, by stand-ins that check whether what they
are asked for is there; the steps `wheel`, `browser` and `consumer` of ./test run it, and check_site.py builds the site.
"""

import contextlib
import dataclasses
import json
import os
import pathlib
import re
import select
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.request

from files import ROOT

PROGRAM = ROOT / "build" / "release" / "apps" / "cli" / "resilin"
PACKAGE = ROOT / "build" / "release" / "python"
INTERPRETER = ROOT / "build" / "python" / "venv" / "bin" / "python"  # made by setup.sh
TIME_LIMIT = 600  # [s] for one line that hangs; they take seconds
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TYPED = re.compile(r"^ {4}((?:resilin|\./run|\./test|python) .*)$", re.MULTILINE)  # an indented line that is a command
WRITES = re.compile(r"^Write this file as `(\w+\.toml)`:\s*\n\Z", re.MULTILINE)  # text before such a scene
PRINTS = re.compile(r"\s*`(\./run (\w+\.toml))` prints\s*\n+```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)
EXPORTS = re.compile(r"^(?:\./run|resilin) export ")
MODULE = ROOT / "build" / "wasm" / "apps" / "play" / "resilin_play.wasm"  # made by build_wasm.sh
SERVES = re.compile(r"^(?:\./run|resilin) view ")
# Serves a page until it is stopped; says where.
ADDRESS = re.compile(r"Listening on (\S+)\s")
# Numbers that differ from machine to machine and from version to version.
NUMBER = re.compile(r"[-+]?\b\d+(?:\.\d+)?(?:e[-+]?\d+)?\b")
# A progress line, printed about once a second: one on a quick machine, several on a slow one.
PROGRESS = re.compile(r"\s*\d+ %  ")
LONG_TIME = re.compile(r"\b\d+ (?:h \d\d min|min \d\d s)\b")  # durations that are given in seconds below a minute

DRIVER = """
import json, sys, traceback
names = {"__name__": "__main__"}
for line in sys.stdin:
    page, code = json.loads(line)
    try:
        exec(compile(code, page, "exec"), names)
        answer = ""
    except BaseException:
        answer = traceback.format_exc()
    print(json.dumps(answer), file=sys.__stderr__, flush=True)
"""

STAND_INS = {
    "bin/pip": """
        [ "$1" = install ] || exit 1
        shift
        for what in "$@"; do
          case $what in
            .) [ -f pyproject.toml ] ;;
            */*) [ -f "$what" ] ;;
            *) [ -n "$what" ] ;;
          esac || { echo "pip: $what: not there" >&2; exit 1; }
        done""",
    "bin/npm": """
        case $1 in
          ci) [ -f package-lock.json ] ;;
          test) grep -q '"test":' package.json ;;
          run) grep -q "\\"$2\\":" package.json ;;
          *) false ;;
        esac || { echo "npm $*: no such script here" >&2; exit 1; }""",
    "bin/cmake": """
        while [ $# -gt 0 ]; do
          case $1 in
            --preset)
              grep -q "\\"name\\": \\"$2\\"" CMakePresets.json || { echo "cmake: no preset $2" >&2; exit 1; }
              shift ;;
            -S) [ -f "$2/CMakeLists.txt" ] || { echo "cmake: $2: no CMakeLists.txt" >&2; exit 1; }; shift ;;
          esac
          shift
        done""",
    "bin/gmsh": """
        exec resilin mesh filled.msh --box 1 1 1 --cells 9 9 9""",
    "bin/ctest": """
        [ "$1" = --preset ] && grep -q "\\"name\\": \\"$2\\"" CMakePresets.json""",
    "test": """
        for step in "$@"; do grep -q "\\"$step\\":" scripts/run_tests.py || exit 1; done""",
    "scripts/build_site.sh": """
        [ $# -eq 0 ] && [ -f scripts/website/build.py ]""",
    "scripts/build_wasm.sh": """
        true""",
    "scripts/release.sh": """
        [ $# -eq 0 ] && [ -f scripts/release.py ]""",
    "scripts/build_wheel.sh": """
        mkdir -p dist && touch dist/resilin-stand-in.whl""",
}


@dataclasses.dataclass
class Line:
    """Text that a reader types: a line of the shell, or a block of Python."""

    page: str
    number: int  # number of its first line in the page
    kind: str  # "sh" or "python"
    text: str
    prints: str | None = None  # output that the page claims

    @property
    def name(self):
        shown = self.text.split("#")[0].strip() if self.kind == "sh" else "Python"
        return f"{self.page}:{self.number}: {shown}"


def readme():
    return [ROOT / "README.md"]


def all_pages():
    """README first, then the others."""
    others = sorted((ROOT / "docs").rglob("*.md"))
    return [*readme(), *others, ROOT / "CONTRIBUTING.md", ROOT / "examples" / "README.md"]


def lines_of(text, page):
    """Text to type in a page, in its order."""
    found = []
    for match in FENCE.finditer(text):
        number = text.count("\n", 0, match.start(2)) + 1
        if match[1] == "python":
            found.append(Line(page, number, "python", match[2]))
        elif match[1] == "sh":
            for i, line in enumerate(match[2].splitlines()):
                if line.strip() and not line.startswith("#"):
                    found.append(Line(page, number + i, "sh", line))
        elif match[1] == "toml" and (named := WRITES.search(text[: match.start()])):
            write = f"cat > {named[1]} <<'END'\n{match[2]}END\nresilin run {named[1]} --quiet"
            found.append(Line(page, number, "sh", write))
        elif match[1] == "toml" and (printed := PRINTS.match(text, match.end())):
            number = text.count("\n", 0, printed.start(1)) + 1
            write = f"cat > {printed[2]} <<'END'\n{match[2]}END\n{printed[1]}"
            found.append(Line(page, number, "sh", write, printed[3]))
    for match in TYPED.finditer(FENCE.sub(lambda fence: "\n" * fence[0].count("\n"), text)):
        found.append(Line(page, text.count("\n", 0, text.index(match[0])) + 1, "sh", match[1]))
    return sorted(found, key=lambda line: line.number)


def make_place(folder):
    """The folder that stands for the clone."""
    for entry in ROOT.iterdir():
        if entry.name not in (".git", "build", "out", "scripts", "test", "run", "dist"):
            (folder / entry.name).symlink_to(entry)
    (folder / "scripts").mkdir()
    for entry in (ROOT / "scripts").iterdir():
        (folder / "scripts" / entry.name).symlink_to(entry)
    (folder / "bin").mkdir()
    run = f'PATH=${{PATH#*:}} exec "{ROOT / "run"}" "$@"'  # with the real tools
    for name, code in {**STAND_INS, "run": run}.items():
        path = folder / name
        path.unlink(missing_ok=True)
        path.write_text(f"#!/bin/sh\n{code.strip()}\n", encoding="utf-8")
        path.chmod(0o755)
    (folder / "bin" / "resilin").symlink_to(PROGRAM)


class Place:
    """Runs lines in a folder; one Python program for each page."""

    def __init__(self, folder):
        self.folder = folder
        hidden = {"DISPLAY", "WAYLAND_DISPLAY", "BROWSER"}
        self.environment = {key: value for key, value in os.environ.items() if key not in hidden}
        self.environment["PATH"] = f"{folder / 'bin'}:{os.environ['PATH']}"
        self.environment |= {"HOME": str(folder), "PYTHONPATH": str(PACKAGE), "MPLBACKEND": "Agg"}
        self.shell_folder = folder  # a page may say `cd`
        self.python = None

    def problems_of(self, line):
        """None when it cannot be run here."""
        if line.kind == "python":
            return self.problems_of_python(line)
        if EXPORTS.match(line.text) and not MODULE.is_file():
            return None
        return self.problems_of_view(line) if SERVES.match(line.text) else self.problems_of_shell(line)

    def problems_of_shell(self, line):
        script = f"set -e\n{line.text}\npwd > {self.folder / 'pwd.txt'}"
        run = subprocess.run(
            ["bash", "-c", script],
            cwd=self.shell_folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            timeout=TIME_LIMIT,
        )
        if run.returncode != 0:
            return [f"exit code {run.returncode}", *(run.stdout + run.stderr).splitlines()[-20:]]
        self.shell_folder = pathlib.Path((self.folder / "pwd.txt").read_text(encoding="utf-8").strip())
        return [] if line.prints is None else differences(line.prints, run.stdout)

    def problems_of_view(self, line):
        """It serves the page, and ends when it is interrupted."""
        view = subprocess.Popen(
            ["bash", "-c", f"exec {line.text}"],
            cwd=self.shell_folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        try:
            end = time.monotonic() + TIME_LIMIT
            said = ""
            while not ADDRESS.search(said):
                # Not `readline`: what it keeps for the next call, `select` does not see.
                ready, _, _ = select.select([view.stdout], [], [], max(0, end - time.monotonic()))
                if not ready:
                    return [f"it did not serve the page within {TIME_LIMIT} s", *said.splitlines()[-20:]]
                word = os.read(view.stdout.fileno(), 4096).decode(errors="replace")
                if not word:
                    return ["it ended before it served the page", *said.splitlines()[-20:]]
                said += word
            with urllib.request.urlopen(ADDRESS.search(said)[1], timeout=60) as page:
                served = page.read()
            view.send_signal(signal.SIGINT)
            code = view.wait(60)
            return [] if b"Resilin" in served and code == 0 else [f"exit code {code}, {len(served)} bytes of a page"]
        finally:
            view.kill()
            view.wait()

    def problems_of_python(self, line):
        if not INTERPRETER.exists() or not (PACKAGE / "resilin").exists():
            return None
        if self.python is None:
            self.python = subprocess.Popen(
                [INTERPRETER, "-c", DRIVER],
                cwd=self.folder,
                env=self.environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            )
        self.python.stdin.write(json.dumps([line.page, "\n" * (line.number - 1) + line.text]) + "\n")
        self.python.stdin.flush()
        said = []
        for word in self.python.stderr:  # warnings come before the answer
            with contextlib.suppress(json.JSONDecodeError):
                answer = json.loads(word)
                return answer.splitlines()[-20:]
            said.append(word.rstrip())
        return ["Python ended", *said[-20:]]

    def end_page(self):
        self.shell_folder = self.folder
        if self.python is not None:
            self.python.kill()
            self.python.wait()
            self.python = None


def differences(expected, got):
    """Lines that a page shows otherwise than they are, but for their numbers and for what depends on the clock."""

    def masked(text):
        lines = [line for line in text.splitlines() if not PROGRESS.match(line)]
        return [NUMBER.sub("#", LONG_TIME.sub("1 s", line)).rstrip() for line in lines]

    if masked(expected) == masked(got):
        return []
    return ["the page says that it prints", *expected.splitlines(), "but it prints", *got.splitlines()]


def problems_of_data(text, page):
    """Blocks of TOML and JSON can be read."""
    problems = []
    for match in FENCE.finditer(text):
        number = text.count("\n", 0, match.start(2)) + 1
        content = match[2]
        try:
            if match[1] == "toml":
                tomllib.loads(content)
            elif match[1] == "json":
                json.loads(content if content.lstrip().startswith(("{", "[")) else "{" + content + "}")
        except ValueError as error:
            problems.append(f"{page}:{number}: {error}")
    return problems


def outcomes(pages):
    """(name, list of problems or None) of each line of these pages as it has been run."""
    with tempfile.TemporaryDirectory(prefix="resilin-docs-") as name:
        folder = pathlib.Path(name)
        make_place(folder)
        place = Place(folder)
        for path in pages:
            page = path.relative_to(ROOT).as_posix()
            text = path.read_text(encoding="utf-8")
            yield f"{page}: blocks of data", problems_of_data(text, page)
            for line in lines_of(text, page):
                try:
                    problems = place.problems_of(line)
                except subprocess.TimeoutExpired:
                    problems = [f"took more than {TIME_LIMIT} s"]
                yield line.name, problems
            place.end_page()


def find_faults_of_this_check():
    """Lines that are wrong are seen to be, in the order of a page."""
    page = (
        "```sh\necho one > a.txt\ncat a.txt b.txt\ncd docs\nls README.md\n```\n\n    resilin rum\n\n"
        "```python\nx = 1\n```\n\n```python\nassert x == 2\n```\n\n```sh\npip install nowhere/a.whl\n```\n"
    )
    lines = lines_of(page, "a.md")
    faults = []
    if [line.kind for line in lines] != ["sh"] * 5 + ["python"] * 2 + ["sh"]:
        faults.append(f"the lines of a page: got {[line.text for line in lines]}")
    with tempfile.TemporaryDirectory(prefix="resilin-docs-") as name:
        make_place(pathlib.Path(name))
        place = Place(pathlib.Path(name))
        wrong = [bool(place.problems_of(line)) for line in lines if line.kind == "sh"]
        place.end_page()
    if wrong != [False, True, False, True, True, True]:
        faults.append(f"lines that are wrong: got {wrong}")
    if not differences("took 1.5 s\n", "took 2 min\n") or differences("a 1.5e-3 b 2\n", "a 7 b -3.2\n"):
        faults.append("what a line prints is compared but for its numbers")
    if differences("took 1.5 s (solving 0.3 s)\n", "took 1 min 02 s (solving 12.5 s)\n"):
        faults.append("a time of more than a minute is not taken for one in seconds")
    slow = "  4 %  step 0, assembling\n100 %  step 1, load 1, 5 Newton\ndone: 1\n"
    if differences("100 %  step 1, load 1, 5 Newton\ndone: 1\n", slow) or not differences("done: 1\n", slow + "more\n"):
        faults.append("lines of progress, which depend on the clock, are compared, or others are not")
    scene = lines_of("Write this file as `a.toml`:\n\n```toml\nx = 1\n```\n", "a.md")
    if len(scene) != 1 or not scene[0].text.endswith("END\nresilin run a.toml --quiet"):
        faults.append(f"a scene that is to be written is run: got {scene}")
    return faults


if __name__ == "__main__":
    failed = False
    for name, problems in outcomes(all_pages()):
        print("skipped" if problems is None else "FAILED" if problems else "passed", name, flush=True)
        for problem in problems or []:
            print("   ", problem)
        failed = failed or bool(problems)
    sys.exit(failed)
