"""Steps of scripts/release.sh once all tools are there; see there."""

import argparse
import collections
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import time
import zipfile

import check_python
import interpreters
import try_wheel
from files import ROOT, project_version, relative, repository_files

WORK = ROOT / "build" / "release-parts"
TOOLS = ROOT / "build" / "python" / "venv" / "bin"  # made by setup.sh
SITE_TOOLS = ROOT / "build" / "site" / "venv" / "bin" / "python"  # made by build_site.sh
MODULE = ROOT / "build" / "wasm" / "apps" / "play" / "resilin_play.wasm"  # made by build_wasm.sh
# Files that nobody can build without, of all that the archive of the sources holds.
NEEDED_SOURCES = ("src/", "apps/", "python/", "cmake/", "CMakeLists.txt", "pyproject.toml", "README.md", "LICENSE")


class ReleaseError(Exception):
    """One line, and the end of a log."""


def say(line):
    print(line, flush=True)


def run(name, command, folder=ROOT):
    """Runs a command; of one that fails the end of what it has said."""
    log = WORK / f"{name}.log"
    with log.open("w") as out:
        status = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, cwd=folder, check=False).returncode
    if status != 0:
        last = "\n".join(log.read_text(errors="replace").splitlines()[-20:])
        raise ReleaseError(f"{name}: exit code {status}; the whole log: {log}\n{last}")


def built_wheel(planned):
    """The wheel, where it does not yet count."""
    tag = interpreters.dotted(planned.builder.minor)
    folder = WORK / f"wheel-{tag}"
    shutil.rmtree(folder, ignore_errors=True)
    run(f"wheel-{tag}", [ROOT / "scripts" / "build_wheel.sh", folder, planned.builder.path])
    (wheel,) = folder.glob("resilin-*.whl")
    return wheel


def venv_of(interpreter):
    return WORK / f"try-{interpreters.dotted(interpreter.minor)}"


def tried_wheel(planned):
    """The wheel after everybody whom it serves has tried it. Throws."""
    begin = time.monotonic()
    wheel = built_wheel(planned)
    say(f"{wheel.name}: {wheel.stat().st_size / 2**20:.1f} MiB, built in {time.monotonic() - begin:.0f} s")
    for user in planned.users:
        seconds = try_wheel.try_wheel(wheel, user.path, venv_of(user))
        say(f"    CPython {interpreters.dotted(user.version)}: {seconds:.1f} s from pip install to the first picture")
    return wheel


def run_suite(wheel, interpreter):
    """The Python tests, in the environment in which the wheel was tried. Throws."""
    python = venv_of(interpreter) / "bin" / "python"
    name = f"suite-{interpreters.dotted(interpreter.minor)}"
    extras = f"{wheel}[{','.join(check_python.EXTRAS)}]"
    run(
        f"{name}-tools", [python, "-m", "pip", "install", "--disable-pip-version-check", extras, *check_python.pinned()]
    )
    results, problems = check_python.run_on_wheel(python, f"{name}.xml")
    if problems:
        raise ReleaseError("\n".join([f"{name}:", *problems]))
    outcomes = check_python.outcomes_in(results)
    counts = collections.Counter(status for _, status, _ in outcomes)
    words = ", ".join(f"{counts[status]} {status}" for status in ("passed", "failed", "skipped"))
    say(f"    {name}: {words}")
    if counts["failed"] > 0 or counts["passed"] == 0:
        details = [f"{test}: {detail}" for test, status, detail in outcomes if status == "failed"]
        raise ReleaseError("\n".join([f"{name}: {words}", *details]))


def made_sources():
    """The archive of the sources, from which a wheel with the same files can be built. Throws."""
    folder, clean = WORK / "sources", WORK / "clean"
    for old in (folder, clean):
        shutil.rmtree(old, ignore_errors=True)
    for path in repository_files():  # nothing of what was built here, which takes minutes to look through
        target = clean / relative(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, target)
    code = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    run("sources", [TOOLS / "python", "-c", code, folder], clean)
    (archive,) = folder.glob("resilin-*.tar.gz")
    if missing := missing_sources(archive, map(relative, repository_files())):
        raise ReleaseError(f"{archive.name}: lacks {', '.join(missing[:5])}; see sdist.include in pyproject.toml")
    pip = [TOOLS / "pip", "wheel", "--disable-pip-version-check", "--no-deps", "--no-build-isolation"]
    launcher = os.environ.get("RESILIN_COMPILER_LAUNCHER", "")
    path = f"{TOOLS}{os.pathsep}{os.environ['PATH']}"
    settings = [f"PATH={path}", "CXX=c++", f"CMAKE_CXX_COMPILER_LAUNCHER={launcher}"]  # as build_wheel.sh has them
    run("sources-build", ["env", *settings, *pip, "--wheel-dir", folder, archive])
    (wheel,) = folder.glob("resilin-*.whl")
    with zipfile.ZipFile(wheel) as files:
        if "resilin/bin/resilin" not in files.namelist():
            raise ReleaseError(f"{archive.name}: the wheel that is built of it lacks the program")
    return archive


def missing_sources(archive, names):
    """Needed files of the repository that the archive lacks."""
    with tarfile.open(archive) as members:
        there = {name.partition("/")[2] for name in members.getnames()}
    return [name for name in names if name.startswith(NEEDED_SOURCES) and name not in there]


def made_site(version):
    """The archive of the site; None where its tools are not there."""
    if not SITE_TOOLS.exists():
        say("site: left out, scripts/build_site.sh fetches its tools")
        return None
    run("program", [ROOT / "run", "info"])
    run("site", [SITE_TOOLS, ROOT / "scripts" / "website" / "build.py", "--out", WORK / "site"])
    archive = WORK / f"resilin-{version}-site.tar.gz"
    with tarfile.open(archive, "w:gz") as out:
        out.add(WORK / "site", arcname=f"resilin-{version}-site")
    return archive


def write_checksums(folder):
    """SHA256SUMS over all files of the folder, as sha256sum -c reads it."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != "SHA256SUMS")
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (folder / "SHA256SUMS").write_text("".join(lines), encoding="utf-8")


def attempt(faults, work, *arguments):
    """Result of `work`; an exception is printed and kept, and the rest goes on."""
    try:
        return work(*arguments)
    except (ReleaseError, try_wheel.TrialError) as failure:
        say(f"FAILED {failure}")
        faults.append(str(failure).splitlines()[0])
        return None


def make_wheels(out, faults, with_suite):
    versions = interpreters.supported_versions()
    found, lacked = interpreters.find_interpreters(versions)
    planned = interpreters.planned_wheels(found, interpreters.stable_from())
    for line in [*lacked, *interpreters.lines_about_untried(planned, versions)]:
        say(line)
    if not planned:
        faults.append("no CPython here that a wheel can be built for")
    tested = (min(found), max(found)) if found and with_suite else ()
    for entry in planned:
        wheel = attempt(faults, tried_wheel, entry)
        if wheel is None:
            continue
        before = len(faults)
        for user in entry.users:
            if user.minor in tested:
                attempt(faults, run_suite, wheel, user)
        if len(faults) == before:
            shutil.copy2(wheel, out)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "dist" / "release", metavar="FOLDER")
    for name in ("suite", "site", "play"):
        parser.add_argument(f"--no-{name}", action="store_true")
    options = parser.parse_args()
    out = options.out.resolve()
    if out.exists() and any(out.iterdir()):
        parser.error(f"--out: expected a new or empty folder, got {out}, which holds files; remove it first")
    out.mkdir(parents=True, exist_ok=True)
    WORK.mkdir(parents=True, exist_ok=True)
    if not MODULE.exists():
        say("wheels cannot `resilin export`: scripts/build_wasm.sh has not built what pages carry")
    faults = []
    make_wheels(out, faults, with_suite=not options.no_suite)
    sources = attempt(faults, made_sources)
    if sources is not None:
        shutil.copy2(sources, out)
    site = None if options.no_site else attempt(faults, made_site, project_version())
    if site is not None:
        shutil.copy2(site, out)
    write_checksums(out)
    for path in sorted(out.iterdir()):
        say(f"{path.stat().st_size / 2**20:8.1f} MiB  {path}")
    sys.exit("\n".join(["what failed is not among them:", *faults]) if faults else 0)


if __name__ == "__main__":
    main()
