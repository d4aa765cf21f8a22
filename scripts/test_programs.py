"""Runs the GoogleTest programs of a build folder, many tests to a process: a process takes longer to start than most
tests take to run, with sanitizers above all.
"""

import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

TESTS_OF_A_SHARD = 25


def registered_tests(folder):
    """(name, command, labels) of each test that ctest knows there."""
    command = ["ctest", "--test-dir", folder, "--show-only=json-v1"]
    listing = subprocess.run(command, capture_output=True, text=True, check=True)
    return [(test["name"], test.get("command", []), labels_of(test)) for test in json.loads(listing.stdout)["tests"]]


def labels_of(test):
    return [label for entry in test.get("properties", []) if entry["name"] == "LABELS" for label in entry["value"]]


def shards_of(folder, left_out):
    """[(name, command, environment, XML file or None)]: commands that run all tests but those with the label
    `left_out`, and how many tests these are."""
    programs, shards = {}, []
    for name, command, labels in registered_tests(folder):
        if not command:
            shards.append((name, None, {}, None))
        elif any(part.startswith("--gtest_filter=") for part in command):
            programs.setdefault(command[0], []).append((name, command[1].partition("=")[2], left_out in labels))
        else:
            shards.append((name, command, {}, None))
    wanted = len(shards)
    for program, tests in sorted(programs.items(), key=lambda entry: -len(entry[1])):
        excluded = [test for _, test, is_left_out in tests if is_left_out]
        wanted += len(tests) - len(excluded)
        count = -(-(len(tests) - len(excluded)) // TESTS_OF_A_SHARD)
        for i in range(count):
            results = pathlib.Path(f"{program}-{i}.xml")
            command = [program, f"--gtest_filter=-{':'.join(excluded)}", f"--gtest_output=xml:{results}"]
            environment = {"GTEST_TOTAL_SHARDS": str(count), "GTEST_SHARD_INDEX": str(i)}
            shards.append((tests[0][0].partition("/")[0], command, environment, results))
    return shards, wanted


def run_shard(shard, environment, time_limit):
    """[(name, status, detail)] of the tests of one shard."""
    name, command, of_shard, results = shard
    if command is None:
        return [(name, "failed", "the program was not built")]
    if results:
        results.unlink(missing_ok=True)
    try:
        run = subprocess.run(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
            timeout=time_limit,
            cwd=pathlib.Path(command[0]).parent,
            env={**os.environ, **environment, **of_shard},
        )
        output, code = run.stdout, run.returncode
    except subprocess.TimeoutExpired as error:
        output, code = (error.stdout or b"").decode(errors="replace"), f"none within {time_limit} s"
    outcomes = read_results(results, name) if results and results.exists() else []
    if not results:
        outcomes = [(name, "passed" if code == 0 else "failed", "" if code == 0 else output)]
    elif not outcomes or (code != 0 and all(status != "failed" for _, status, _ in outcomes)):
        last = re.findall(r"^\[ RUN      \] (\S+)", output, re.MULTILINE)[-1:] or ["before the first test"]
        outcomes.append((f"{name}/{last[0]}", "failed", f"exit code {code}\n{output}"))
    return outcomes


def read_results(file, name):
    outcomes = []
    for case in ElementTree.parse(file).getroot().iter("testcase"):
        if case.get("status") != "run" and case.get("result") != "skipped":
            continue  # belongs to another shard, or is left out
        failures = [failure.text or "" for failure in case.findall("failure")]
        status = "failed" if failures else "skipped" if case.get("result") == "skipped" else "passed"
        outcomes.append((f"{name}/{case.get('classname')}.{case.get('name')}", status, "\n".join(failures)))
    return outcomes


def run_programs(folder, left_out, environment, time_limit):
    """[(name, status, detail)] of all tests of a build folder but those with the label `left_out`, which may be
    None; fewer than ctest knows there are a failure."""
    shards, wanted = shards_of(folder, left_out)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        lists = pool.map(lambda shard: run_shard(shard, environment, time_limit), shards)
        outcomes = [outcome for outcomes in lists for outcome in outcomes]
    if len(outcomes) < wanted:
        outcomes.append(("all tests are run", "failed", f"expected {wanted} of them, got {len(outcomes)}"))
    return outcomes
