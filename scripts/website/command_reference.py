"""The help of every command, as the program prints it."""

import re
import subprocess

from website.pages import code_block

COMMAND = re.compile(r"^ {2}(\w+)\s{2,}(\S.*)$", re.MULTILINE)


def help_of(program, *words):
    """None where a command is a program of its own that is not built here, as the benchmarks are."""
    run = subprocess.run(
        [program, *words, "--help"], capture_output=True, text=True, check=False, env={"COLUMNS": "100"}
    )
    return run.stdout if run.returncode == 0 else None


def command_names(text):
    """Those that the list of commands in the help has."""
    _, _, commands = text.partition("ommands:\n")
    return [name for name, _ in COMMAND.findall(commands)]


def page(program):
    whole = help_of(program)
    names = command_names(whole)
    if "run" not in names:
        raise ValueError(f"the help of {program.name}: expected a list of commands with `run`, got {names}")
    parts = ["# Commands\n", "Help texts of `resilin` and of each of its commands.\n", code_block(whole, "text")]
    for name in names:
        if text := help_of(program, name):
            parts += [f"## resilin {name}\n", code_block(text, "text")]
    return "\n".join(parts)
