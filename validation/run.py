#!/usr/bin/env python3
"""Runs the validation cases with a `resilin` program and compares with what other codes, papers and formulas say.

validation/run.py build/release/apps/cli/resilin                 every row; exit code 1 when one fails
validation/run.py PROGRAM --quick                                what ./test runs
validation/run.py PROGRAM --only cook_2d                         rows whose case/name contains the text
validation/run.py PROGRAM --report docs/validation.md            writes the page with its pictures, too
"""

import argparse
import concurrent.futures
import os
import pathlib
import sys
import tempfile
import time

import page
from case import cases, run_row


def run_rows(program, chosen, jobs, announce=lambda case_name, result, seconds: None, folders=None):
    """[(name of the case, Result)] in the order of `chosen`, [(name of the case, row)]; `jobs` at a time.

    `folders` {(name of the case, name of the row): folder} says which results are kept.
    """

    def work(entry):
        case_name, row = entry
        start = time.monotonic()
        result = run_row(program, case_name, row, (folders or {}).get((case_name, row["name"])))
        announce(case_name, result, time.monotonic() - start)
        return result

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(work, chosen))
    return [(case_name, result) for (case_name, _), result in zip(chosen, results, strict=True)]


def choose(only="", quick=False):
    """[(name of the case, row)] whose case/name contains `only`; of `quick` ones alone."""
    return [
        (case_name, row)
        for case_name, case in cases().items()
        for row in case["rows"]
        if only in f"{case_name}/{row['name']}" and (row.get("quick") or not quick)
    ]


def describe(case_name, result, seconds):
    """One line for a row, and one more for each number that is not as expected."""
    lines = [f"{'passed' if result.passed else 'FAILED'}  {case_name}/{result.row['name']}  {seconds:.1f} s"]
    if result.problem:
        lines.append(f"        {result.problem}")
    for found in result.comparisons:
        if not found.passed:
            note = f" ({found.note})" if found.note else ""
            lines.append(
                f"        {found.what}{note}: expected {found.expected}, got {found.got}, error {found.error:.1e}"
            )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the resilin program")
    parser.add_argument("--only", default="", metavar="TEXT", help="rows whose case/name contains this")
    parser.add_argument("--quick", action="store_true", help="quick rows only")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time; default all cores")
    parser.add_argument("--report", type=pathlib.Path, metavar="FILE", help="write the page, with pictures beside it")
    arguments = parser.parse_args()
    if arguments.report and (arguments.only or arguments.quick):
        parser.error("--report: expected every row, got some; leave out --only and --quick")
    program = arguments.program.resolve()
    chosen = choose(arguments.only, arguments.quick)

    def announce(*what):
        print(describe(*what), flush=True)

    with tempfile.TemporaryDirectory() as parent:
        folders = page.folders_of_pictures(parent) if arguments.report else {}
        results = run_rows(program, chosen, arguments.jobs, announce, folders)
        if arguments.report:
            page.write(arguments.report, program, results, folders)
    failed = sum(not result.passed for _, result in results)
    print(f"{len(results) - failed} passed, {failed} failed")
    return 1 if failed or not results else 0


if __name__ == "__main__":
    sys.exit(main())
