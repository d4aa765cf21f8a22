"""Checks the page of `resilin view`: its types and format, that the built file is that of its source, and its tests in
a real browser with the program of the release build."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from files import ROOT

WEB = ROOT / "apps" / "viewer" / "web"
PAGE = WEB / "dist" / "page.html"
TIME_LIMIT = 1800  # [s] for all tests in the browser when one hangs; they take about a minute on quiet cores


def run_node(*command, environment=None, **options):
    variables = {**os.environ, "NO_COLOR": "1", **(environment or {})}
    return subprocess.run(command, cwd=WEB, capture_output=True, text=True, check=False, env=variables, **options)


def problems_of(*command):
    run = run_node(*command)
    lines = (run.stdout + run.stderr).strip().splitlines()[-30:]
    return [f"{' '.join(command)}: exit code {run.returncode}", *lines] if run.returncode else []


def tool(name):
    return str(WEB / "node_modules" / ".bin" / name)


def find_type_problems():
    return problems_of(tool("tsc"), "--noEmit")


def find_format_problems():
    check = (tool("prettier"), "--config=package.json", "--check", "--log-level=warn")
    return problems_of(*check, ".") + problems_of(*check, "../../../python/resilin/widget.js")


def find_lock_problems():
    """A lock file that names a host would send everyone there."""
    lock = (WEB / "package-lock.json").read_text(encoding="utf-8")
    problems = [
        f"package-lock.json: names a host: {line.strip()}" for line in lock.splitlines() if '"resolved"' in line
    ]
    package = (WEB / "package.json").read_text(encoding="utf-8")
    dependencies = re.search(r'"devDependencies": \{(.*?)\}', package, re.DOTALL)[1]
    loose = re.findall(r'"(\S+)": "[^0-9]', dependencies)
    return problems + [f"package.json: {name}: expected one exact version" for name in loose]


def find_difference_of_built_page():
    """The committed page is what its source gives, byte by byte."""
    with tempfile.TemporaryDirectory() as folder:
        built = pathlib.Path(folder) / "page.html"
        problems = problems_of("node", "build.mjs", str(built))
        if problems:
            return problems
        if built.read_bytes() != PAGE.read_bytes():
            return [f"{PAGE.relative_to(ROOT)} is not what its source gives: npm run build in {WEB.relative_to(ROOT)}"]
    return []


def is_installed():
    return shutil.which("node") is not None and (WEB / "node_modules" / "installed").is_file()


def page_checks():
    if not is_installed():
        return {"the page": lambda: None}
    return {
        "types of the page": find_type_problems,
        "format of the page": find_format_problems,
        "the lock file of the page names no host": find_lock_problems,
        "the built page is that of its source": find_difference_of_built_page,
    }


def browser_outcomes(*names, **environment):
    """(name, status, detail) of each test in the browser; `names` of files, by default those of the program alone."""
    try:
        run = run_node("node", "tests/run.mjs", *names, timeout=TIME_LIMIT, environment=environment)
    except subprocess.TimeoutExpired:
        return [("tests in the browser", "failed", f"took more than {TIME_LIMIT} s")]
    outcomes = outcomes_of_tap(run.stdout)
    if not outcomes or (run.returncode != 0 and not any(status == "failed" for _, status, _ in outcomes)):
        lines = (run.stdout + run.stderr).strip().splitlines()[-30:]
        outcomes.append(("tests in the browser", "failed", "\n".join([f"exit code {run.returncode}", *lines])))
    return outcomes


def outcomes_of_tap(text):
    outcomes = []
    for block in re.split(r"^(?=(?:not )?ok \d+ - )", text, flags=re.MULTILINE):
        head = re.match(r"(not )?ok \d+ - (.*?)(?: # SKIP (.*))?\n", block)
        if head:
            failed, name, lack = head.groups()
            status = "failed" if failed else "skipped" if lack else "passed"
            outcomes.append((name, status, block.strip() if failed else lack or ""))
    return outcomes


def find_faults_of_this_check():
    """The output of node's test runner is read rightly."""
    text = (
        "TAP version 13\n# Subtest: a\nok 1 - a\n  ---\n  ...\n# Subtest: b\nnot ok 2 - b\n  error: 'why'\n"
        "# Subtest: c\nok 3 - c # SKIP no browser\n1..3\n"
    )
    first, (name, status, why), third = outcomes_of_tap(text)
    right = (("a", "passed", ""), ("b", "failed"), ("c", "skipped", "no browser"))
    wrong = (first, (name, status), third) != right or "why" not in why
    return [f"outcomes_of_tap: got {outcomes_of_tap(text)}"] if wrong else []
