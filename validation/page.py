"""The page docs/validation.md: every row of validation with what was expected, what came and how far off it is."""

import math
import pathlib
import re
import subprocess

from case import cases

HEAD = """# Validation

What Resilin computes beside what other codes, papers and closed forms say. This page is written by
`validation/run.py build/release/apps/cli/resilin --report docs/validation.md`; `./test` runs the quick rows again on
every machine. Scenes, meshes and expected numbers lie in [validation](../validation), one folder for each case.

A relative error is the largest difference of a component over the largest component that is expected. Newton:
iterations of the whole run, over all its load or time steps.
"""
TABLE = """| row | quantity | expected | got | relative error | tolerance | Newton | |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""
COLUMNS = 8


def write(file, program, results, folders):
    """Writes the page, and beside it one picture for each case that has a folder of results in `folders`."""
    sections = []
    for name, case in cases().items():
        of_case = [result for case_name, result in results if case_name == name]
        picture = None
        if "picture" in case:
            folder = folders[name, case["picture"]["row"]]
            target = file.parent / "images" / "validation" / f"{name}.png"
            picture = draw(target, program, folder, case["picture"]["options"])
        sections.append(section(name, case, of_case, picture))
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    text = "\n".join([HEAD, summary(version, results), *sections])
    file.write_text(text, encoding="utf-8")


def summary(version, results):
    numbers = [found for _, result in results for found in result.comparisons]
    failed = [(case_name, result) for case_name, result in results if not result.passed]
    errors = sorted(found.error for found in numbers if found.tolerance <= 1e-6)
    text = f"""**{len(results)} rows, {len(numbers)} numbers, {len(failed)} rows failed**, by version {version}.
{len(errors)} numbers are compared to 1e-6 or closer, on the same mesh with the same element: the worst is off by
{errors[-1]:.1e}, half of them by less than {errors[len(errors) // 2]:.0e}.
"""
    if failed:
        lines = [f"- {case_name}/{result.row['name']}: {why(result)}\n" for case_name, result in failed]
        text += "\nRows that failed, with what is known about them below their tables:\n" + "".join(lines)
    return text


def why(result):
    return result.problem or ", ".join(found.what for found in result.comparisons if not found.passed)


def section(name, case, results, picture):
    lines = [f"## {case['title']}", f"[validation/{name}](../validation/{name})", "", case["measured"], ""]
    lines += [f"Source: {case['source']}", "", f"Tolerances: {case['tolerances']}", ""]
    if picture:
        lines += [f"![{case['title']}](images/validation/{picture.name})", ""]
    if "units" in case:
        lines += [f"Units: {case['units']}.", ""]
    return "\n".join(lines) + "\n" + TABLE + "".join(rows_of(result) for result in results) + remarks(results)


def remarks(results):
    """What is known about rows that failed."""
    known = [result.row for result in results if not result.passed and "remark" in result.row]
    return "".join(f"\n*{row['name']}*: {row['remark']}.\n" for row in known)


def rows_of(result):
    """The lines of the table for a row; its name and its iterations stand in the first."""
    newton = "" if result.newton_iterations is None else result.newton_iterations
    if result.problem:
        return table_line(result.row["name"], result.problem, "", "", "", "", newton, "**failed**")
    text = ""
    for number, found in enumerate(result.comparisons):
        what = found.what + (f" ({found.note})" if found.note else "")
        is_bound = math.isnan(found.tolerance)
        error = "" if is_bound and found.passed else f"{found.error:.1e}"
        tolerance = "" if is_bound else f"{found.tolerance:.1e}".replace(".0e", "e")
        verdict = "passed" if found.passed else "**failed**"
        first = (result.row["name"], newton) if number == 0 else ("", "")
        text += table_line(first[0], what, found.expected, found.got, error, tolerance, first[1], verdict)
    return text


def table_line(*columns):
    return "| " + " | ".join(str(column).replace("|", "\\|").replace("\n", " ") for column in columns) + " |\n"


def folders_of_pictures(parent):
    """{(name of the case, name of the row): folder below `parent` for the results that will be drawn}."""
    pictured = [(name, case["picture"]["row"]) for name, case in cases().items() if "picture" in case]
    return {key: pathlib.Path(parent) / key[0] for key in pictured}


def draw(file, program, results, options):
    """Lets `resilin picture` draw the folder `results`."""
    file.parent.mkdir(parents=True, exist_ok=True)
    command = [program, "picture", results, "--out", file, "--size", "640", "480", *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return file


def rows_named_in(text):
    """{(name of the case, name of the row)} that the tables of a page hold."""
    named = set()
    case_name = None
    for line in text.splitlines():
        heading = re.match(r"\[validation/(\w+)\]", line)
        if heading:
            case_name = heading[1]
        columns = [column.strip() for column in re.split(r"(?<!\\)\|", line)[1:-1]]
        if case_name and len(columns) == COLUMNS and columns[0] not in ("", "row", "---"):
            named.add((case_name, columns[0]))
    return named


def problems_of_page(file):
    """A line for each row that the page lacks or that exists no more."""
    named = rows_named_in(pathlib.Path(file).read_text(encoding="utf-8"))
    exist = {(name, row["name"]) for name, case in cases().items() for row in case["rows"]}
    cure = "write the page again (validation/run.py)"
    return [f"{file}: the row {name}/{row} is not in it; {cure}" for name, row in sorted(exist - named)] + [
        f"{file}: there is no row {name}/{row} any more; {cure}" for name, row in sorted(named - exist)
    ]
