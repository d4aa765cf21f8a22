"""Runs the steps of ./test after the build; closes with a table of times and a line: N passed, N failed[, N skipped].

Every GoogleTest case, house rule, example, quick row of validation and the consumer project counts as one test.
With CI=true in the environment a skipped test counts as failed, since a machine that checks everything must be able to;
those that need what is LACKED_EVERYWHERE are named and not counted.
"""

import argparse
import concurrent.futures
import dataclasses
import itertools
import os
import pathlib
import sys
import time

import check_browser
import check_consumer
import check_containers
import check_docs
import check_examples
import check_format
import check_includes
import check_petsc
import check_python
import check_release
import check_repository
import check_setup
import check_site
import check_tidy
import check_validation
import check_words
import test_programs

ROOT = pathlib.Path(__file__).resolve().parent.parent
# torch.func came with torch 2: Debian 12 has 1.13, and PyPI's brings gigabytes of CUDA's libraries along.
LACKED_EVERYWHERE = (".test_torch_func.",)
TIME_LIMIT = 600  # [s] for one GoogleTest case that hangs; the longest takes seconds, more on a busy machine


@dataclasses.dataclass
class Outcome:
    """Outcome of one test; `status` is "passed", "failed" or "skipped"."""

    name: str
    status: str
    detail: str = ""


def run_check(name, check):
    """One test from a function that returns a list of problems, or None when it cannot be run here."""
    problems = check()
    if problems is None:
        return Outcome(name, "skipped", "a tool that it needs, or the history of git, is not there")
    return Outcome(name, "failed" if problems else "passed", "\n".join(problems))


def run_rules():
    checks = {
        "the direction check finds a violation": check_includes.find_faults_of_this_check,
        "modules include only those below them": check_includes.find_problems,
        "the house rules check finds violations": check_repository.find_faults_of_this_check,
        "house rules": check_repository.find_problems,
        "the check of words finds violations": check_words.find_faults_of_this_check,
        "words": check_words.find_problems,
        "clang-format": check_format.find_cpp_problems,
        "ruff": check_format.find_python_problems,
        "set-up installs what is missing and nothing else": check_setup.find_problems,
        "a release is made of what was tried": check_release.find_problems,
        "shell scripts": check_format.find_shell_problems,
        "clang-tidy on what changed last": check_tidy.find_problems_in_changes,
    }
    return [run_check(name, check) for name, check in checks.items()]


def run_tidy():
    return [run_check("clang-tidy on everything", check_tidy.find_problems_everywhere)]


def run_gtest(preset, left_out=None, environment=None):
    """Runs the test programs of a build folder, without the tests that have the label `left_out`."""
    results = test_programs.run_programs(ROOT / "build" / preset, left_out, environment or {}, TIME_LIMIT)
    return [Outcome(f"{name} ({preset})", status, detail) for name, status, detail in results]


def run_release():
    return run_gtest("release")


def run_sanitizers():
    environment = {
        "ASAN_OPTIONS": "detect_stack_use_after_return=1:strict_string_checks=1",
        "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    }
    return run_gtest("asan", "not_when_sanitized", environment)


def run_examples():
    return [run_check(f"example {name}", check) for name, check in check_examples.all_checks().items()]


def run_docs():
    name = "the check of README and docs finds lines that are wrong"
    return [
        run_check(name, check_docs.find_faults_of_this_check),
        run_check("the check of the site finds links that lead nowhere", check_site.find_faults_of_this_check),
        *(Outcome(*result) for result in check_site.outcomes()),
    ] + [
        run_check(f"docs: {line}", lambda problems=problems: problems)
        for line, problems in check_docs.outcomes(check_docs.all_pages())
    ]


def run_readme():
    return [
        run_check(f"readme: {line}", lambda problems=problems: problems)
        for line, problems in check_docs.outcomes(check_docs.readme())
    ]


def run_validation():
    outcomes = [
        Outcome(f"validation {name}", "failed" if problem else "passed", problem)
        for name, problem in check_validation.quick_rows(os.cpu_count())
    ]
    return [run_check("docs/validation.md names the rows that exist", check_validation.problems_of_page), *outcomes]


def run_consumer():
    return [
        run_check("a project outside the tree finds, builds with and runs the library", check_consumer.find_problems),
        run_check("the check of the containers reads what they install", check_containers.find_faults_of_this_check),
        run_check("containers have the libraries that their programs ask for", check_containers.find_problems),
    ]


def run_pytest(name, results_or_problems):
    """Outcomes of the JUnit file that pytest wrote, or one failure when it could not even start."""
    results, problems = results_or_problems
    if problems:
        return [Outcome(name, "failed", "\n".join(problems))]
    return [Outcome(f"{test} ({name})", status, detail) for test, status, detail in check_python.outcomes_in(results)]


def run_python():
    return run_pytest("python", check_python.run_in_build_folder())


def run_torch():
    return run_pytest("torch", check_python.run_what_the_wheel_leaves_out())


def run_browser():
    checks = {"the results of the browser's tests are read rightly": check_browser.find_faults_of_this_check}
    outcomes = [run_check(name, check) for name, check in {**checks, **check_browser.page_checks()}.items()]
    if any(outcome.status == "skipped" for outcome in outcomes):
        return outcomes
    return outcomes + [
        Outcome(f"browser: {name}", status, detail) for name, status, detail in check_browser.browser_outcomes()
    ]


def run_petsc():
    return [run_check(f"processes: {name}", check) for name, check in check_petsc.all_checks().items()]


def run_wheel():
    return run_pytest("wheel", check_python.run_in_empty_environment())


STEPS = {
    "rules": run_rules,
    "tidy": run_tidy,
    "release": run_release,
    "examples": run_examples,
    "docs": run_docs,
    "readme": run_readme,
    "validation": run_validation,
    "consumer": run_consumer,
    "python": run_python,
    "torch": run_torch,
    "petsc": run_petsc,
    "wheel": run_wheel,
    "browser": run_browser,
    "sanitizers": run_sanitizers,
}
# Each keeps one core busy, or waits for a browser; the others divide their work among all cores themselves.
ONE_CORE_STEPS = {"examples", "docs", "readme", "consumer", "python", "torch", "petsc", "wheel", "browser"}
NEEDED_BUILD = dict.fromkeys(ONE_CORE_STEPS | {"release", "validation"}, "release")
NEEDED_BUILD |= {"petsc": "petsc", "sanitizers": "asan"}


def spent_time(text):
    """("build (release)", 412) of "build (release)=412"."""
    name, _, seconds = text.rpartition("=")
    return name, int(seconds)


def run_step(step):
    """(outcomes, seconds) of one step."""
    start = time.monotonic()
    print(f"Testing: {step} ...", file=sys.stderr, flush=True)
    outcomes = STEPS[step]()
    seconds = time.monotonic() - start
    print(f"    {step}: {seconds:.0f} s", file=sys.stderr, flush=True)
    return outcomes, seconds


def run_steps(steps):
    """[(step, outcomes, seconds)]: neighbours of one core each run side by side, as many as there are cores."""
    results = []
    for is_narrow, group in itertools.groupby(steps, key=ONE_CORE_STEPS.__contains__):
        names = list(group)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count() if is_narrow else 1) as pool:
            results += [(name, *result) for name, result in zip(names, pool.map(run_step, names), strict=True)]
    return results


def table_of(spent, whole):
    """Lines: how long each step took, in its order, and all of them, some of which ran side by side."""
    rows = [*spent, ("all", whole)]
    width = max(len(name) for name, _ in rows)
    return [f"    {name:{width}}  {seconds:6.0f} s" for name, seconds in rows]


def report(outcomes, spent, whole):
    """Prints what needs a look, the table of times [s], then the closing line; returns the exit code."""
    if os.environ.get("CI") == "true":
        skipped = [o.name for o in outcomes if o.status == "skipped"]
        lacked = [name for name in skipped if any(part in name for part in LACKED_EVERYWHERE)]
        if lacked:
            print("\nNOT RUN, nor counted", *(f"    {name}" for name in lacked), sep="\n")
        outcomes = [o for o in outcomes if o.name not in lacked]
        for outcome in outcomes:
            if outcome.status == "skipped":
                outcome.status, outcome.detail = "failed", f"skipped, which counts as failed here\n{outcome.detail}"
    for outcome in outcomes:
        if outcome.status == "failed":
            lines = outcome.detail.strip().splitlines()
            print(f"\nFAILED {outcome.name}", *(f"    {line}" for line in lines[-40:]), sep="\n")
    counts = {status: sum(o.status == status for o in outcomes) for status in ("passed", "failed", "skipped")}
    if counts["skipped"]:
        print("\nSKIPPED", *(f"    {o.name}" for o in outcomes if o.status == "skipped"), sep="\n")
    print("\nTIMES", *table_of(spent, whole), "", sep="\n")
    line = f"{counts['passed']} passed, {counts['failed']} failed"
    print(line + (f", {counts['skipped']} skipped" if counts["skipped"] else ""), flush=True)
    return 0 if counts["failed"] == 0 and counts["passed"] > 0 else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--failed-build", action="append", default=[], metavar="PRESET")
    parser.add_argument("--spent", action="append", default=[], type=spent_time, metavar="NAME=SECONDS")
    parser.add_argument("steps", nargs="+", metavar="STEP", help=", ".join(STEPS))
    arguments = parser.parse_args()
    for step in arguments.steps:
        if step not in STEPS:
            parser.error(f"step: expected one of {', '.join(STEPS)}, got {step}")

    spent = arguments.spent
    outcomes = [Outcome(f"build ({preset})", "failed", "see above") for preset in arguments.failed_build]
    start = time.monotonic()
    set_up = sum(seconds for _, seconds in spent)
    runnable = [step for step in arguments.steps if NEEDED_BUILD.get(step) not in arguments.failed_build]
    for step, found, seconds in run_steps(runnable):
        outcomes += found
        spent.append((step, seconds))
    return report(outcomes, spent, set_up + time.monotonic() - start)


if __name__ == "__main__":
    sys.exit(main())
