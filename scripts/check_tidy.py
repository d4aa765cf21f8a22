"""clang-tidy over the library and the programs: all of them, what changed last, or files named on the command line.

A file takes about five seconds, most of them in Eigen's headers, so ./test looks at what the last commit and the work
since then touched, and `./test tidy` at everything. A file whose text, headers of this project and settings have not
changed since it last came out clean is not looked at again (build/tools/tidy holds the memory).
"""

import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

from files import ROOT, relative, repository_files

BUILD = ROOT / "build" / "tidy"
MEMORY = ROOT / "build" / "tools" / "tidy"
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def with_headers(path, seen):
    """Adds `path` and all headers of this project that it sees to `seen`."""
    if path in seen:
        return
    seen.add(path)
    for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
        for candidate in (ROOT / "src" / name, path.parent / name):
            if candidate.is_file():
                with_headers(candidate, seen)
                break


def fingerprint(path):
    seen = set()
    with_headers(path, seen)
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    digest.update((ROOT / ".pre-commit-config.yaml").read_bytes())
    for file in sorted(seen):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def problems_of_file(path):
    memory = MEMORY / relative(path).replace("/", "-")
    print_of_now = fingerprint(path)
    if memory.exists() and memory.read_text() == print_of_now:
        return []
    # The precompiled headers there are the compiler's; clang-tidy reads the headers themselves. It knows neither all of
    # g++'s names of warnings nor its parameters, and counts signs to -Wconversion, which g++ does not in C++.
    names = ("ignored-gch", "unknown-warning-option", "unused-command-line-argument", "sign-conversion")
    unlike_gcc = [f"--extra-arg=-Wno-{name}" for name in names]
    command = ["clang-tidy", "--quiet", "-p", BUILD, "--warnings-as-errors=*", *unlike_gcc, path]
    run = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    if run.returncode == 0:
        MEMORY.mkdir(parents=True, exist_ok=True)
        memory.write_text(print_of_now)
        return []
    return [
        line.replace(f"{ROOT}/", "") for line in run.stdout.splitlines() if ": error:" in line or ": warning:" in line
    ] or [f"{relative(path)}: clang-tidy failed: {run.stderr.strip()[-300:]}"]


def library_sources():
    return [path for path in repository_files(".cpp") if relative(path).startswith(("src/", "apps/"))]


def changed_sources():
    """Sources that the last commit or the work since then touched, themselves or by the header of the same name.

    None where nobody knows: without git, in an unpacked archive, in a clone without history.
    """
    command = ["git", "-C", ROOT, "diff", "--name-only", "HEAD~1"]
    try:
        listing = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
    stems = {name.rsplit(".", 1)[0] for name in listing.splitlines() if name.endswith((".cpp", ".hpp"))}
    return [path for path in library_sources() if relative(path).removesuffix(".cpp") in stems]


def configure():
    """Writes a command for each source, which `release`, where sources are compiled in groups, does not have."""
    settings = ["-DRESILIN_UNITY=OFF", "-DRESILIN_INSTRUCTION_SETS=all", "-DRESILIN_BUILD_TESTS=OFF"]
    command = ["cmake", "--preset", "release", "-B", BUILD, *settings]
    return subprocess.run(command, capture_output=True, check=False, cwd=ROOT).returncode == 0


def find_problems(files):
    if shutil.which("clang-tidy") is None or not configure():
        return None
    commands = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    counts = collections.Counter(pathlib.Path(command["file"]).resolve() for command in commands)
    # Kernels are compiled once for each instruction set and speak g++'s vector extensions, which clang reads otherwise.
    built = {file for file, count in counts.items() if count == 1}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return sorted({line for lines in pool.map(problems_of_file, built.intersection(files)) for line in lines})


def find_problems_everywhere():
    return find_problems(library_sources())


def find_problems_in_changes():
    changed = changed_sources()
    return None if changed is None else find_problems(changed)


if __name__ == "__main__":
    found = find_problems([pathlib.Path(name).resolve() for name in sys.argv[1:]] or library_sources())
    if found is None:
        sys.exit("clang-tidy is not there, or cmake --preset release fails: run ./test rules once")
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))
