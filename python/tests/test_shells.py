"""Completion in the shells themselves, and the page for man, against what --help says."""

import os
import pty
import re
import select
import shutil
import subprocess
import time

import pytest

import resilin
from resilin.__main__ import PROGRAM

TIME_LIMIT = 120  # [s]: a shell that hangs, on a busy machine
ALL, TAB = "\x1b*", "\t"  # inserts every completion; the usual key


def output(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=True).stdout


def commands():
    listed = output("--help").split("Subcommands:\n")[1].split("\n\n")[0]
    return re.findall(r"^  ([\w-]+) ", listed, re.MULTILINE)


def options_of(command):
    return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", output(command, "--help"), re.MULTILINE))


@pytest.fixture
def place(tmp_path):
    """A folder with files of several kinds."""
    for name in ("beam.toml", "beam.msh", "notes.txt", "a b.toml"):
        (tmp_path / name).touch()
    (tmp_path / "out").mkdir()
    return tmp_path


def answer(argv, typed, end, folder):
    """Output of a shell on a terminal of its own by the time that `end` comes."""
    master, slave = pty.openpty()
    environment = {"PATH": f"{PROGRAM.parent}:{os.environ['PATH']}", "TERM": "dumb", "HOME": str(folder), "LC_ALL": "C"}
    with subprocess.Popen(
        argv, stdin=slave, stdout=slave, stderr=slave, env=environment, cwd=folder, start_new_session=True
    ) as shell:
        os.close(slave)
        os.write(master, typed.encode())
        shown, limit = b"", time.monotonic() + TIME_LIMIT
        while end.encode() not in shown and time.monotonic() < limit:
            if select.select([master], [], [], 0.1)[0]:
                try:
                    shown += os.read(master, 65536)
                except OSError:  # it has ended
                    break
        shell.kill()
    os.close(master)
    return shown.decode(errors="replace").replace("\r", "")


def words_given(shown):
    """The words that the shell has called `resilin` with, which prints them there."""
    found = re.findall(r"^GIVEN(.*)$", shown, re.MULTILINE)
    assert found, shown
    return found[-1].split("|")[1:-1]


def in_bash(line, folder, key=ALL):
    (folder / ".rc").write_text(
        """
bind 'set enable-bracketed-paste off' 'set page-completions off' 'set completion-query-items 0'
source <(resilin completion bash)
resilin() { printf 'GIVEN|'; printf '%s|' "$@"; printf '\\n%s\\n' END-OF-LINE; }
"""
    )
    argv = ["bash", "--noprofile", "--rcfile", str(folder / ".rc"), "-i"]
    return words_given(answer(argv, f"{line}{key}\r", "\nEND-OF-LINE", folder))


def test_bash_offers_every_option_that_help_lists(place):
    names = [name for name in commands() if name != "bench"]  # another program answers
    assert {"run", "view", "materials", "doctor", "completion"} <= set(names)
    for name in names:
        offered = {word.split("=")[0] for word in in_bash(f"resilin {name} --", place)[1:]}
        assert offered == options_of(name), name


def test_bash_offers_commands_files_and_words_of_the_catalogues(place):
    assert set(in_bash("resilin ", place)) == set(commands())
    assert in_bash("resilin ru", place, TAB) == ["run"]
    assert in_bash("resilin run ", place) == ["run", "a b.toml", "beam.toml", "out"]
    assert in_bash("resilin run beam.toml --out ", place, TAB)[-1] == "out/"
    assert in_bash("resilin check beam", place) == ["check", "beam.msh", "beam.toml"]
    assert set(in_bash("resilin materials ", place)[1:]) == set(resilin.laws())
    assert in_bash("resilin materials neo_hookean --curve eq", place, TAB)[-1] == "equibiaxial"
    assert in_bash("resilin picture out --out a.png --view fr", place, TAB)[-1] == "front"
    assert in_bash("resilin picture out --field nodal_von", place, TAB)[-1] == "nodal_von_mises"
    assert set(in_bash("resilin run --formats ", place)[2:]) == {"vtu", "html", "usda"}
    assert in_bash("resilin run --formats vtu,us", place, TAB)[-1] == "vtu,usda"
    assert in_bash("resilin run --resume=an", place, TAB)[-1] == "--resume=anyway"
    assert set(in_bash("resilin completion ", place)[1:]) == {"bash", "fish", "zsh"}


def test_bash_offers_keys_of_the_scene_and_what_they_take(place):
    assert in_bash("resilin run beam.toml --set simulation.grav", place, TAB)[-1] == "simulation.gravity="
    assert "body.0.material.youngs_modulus=" in in_bash("resilin run --set body.0.material.y", place)
    assert in_bash("resilin run --set body.0.element=P", place)[-3:] == ["body.0.element=P1", "P2", "P2P0"]
    assert in_bash("resilin run --set body.0.material.law=stab", place, TAB)[-1].endswith("=stable_neo_hookean")
    # Behind a whole value comes the scene again, and behind a number of an option its next one.
    assert in_bash("resilin run --set newton.tolerance=1e-6 beam.t", place, TAB)[-1] == "beam.toml"
    assert in_bash("resilin picture --size 800 600 --range -1 2 ou", place, TAB)[-1] == "out/"


def needs(program):
    if shutil.which(program) is None:
        pytest.skip(f"there is no {program}")


def test_fish_offers_the_same(place):
    needs("fish")

    def offered(line):
        script = f"resilin completion fish | source; complete -C '{line}'"
        environment = os.environ | {"PATH": f"{PROGRAM.parent}:{os.environ['PATH']}", "HOME": str(place)}
        command = ["fish", "--no-config", "-c", script]
        run = subprocess.run(command, capture_output=True, text=True, cwd=place, env=environment, check=True)
        assert run.stderr == ""
        return [line.split("\t")[0] for line in run.stdout.splitlines()]

    assert set(commands()) <= set(offered("resilin "))
    for name in commands():
        if name != "bench":
            assert {word.split("=")[0] for word in offered(f"resilin {name} --")} == options_of(name), name
    assert set(offered("resilin run --formats ")) == {"vtu", "html", "usda"}
    assert set(offered("resilin materials neo_")) == {law for law in resilin.laws() if law.startswith("neo_")}
    assert "beam.toml" in offered("resilin run be")
    assert offered("resilin run --out ") == ["out/"]
    assert "body.0.element=P2" in offered("resilin run --set body.0.element=P")


def in_zsh(line, folder):
    (folder / ".zshrc").write_text(
        """
autoload -Uz compinit && compinit -u
source <(command resilin completion zsh)
resilin() { printf 'GIVEN|'; printf '%s|' "$@"; printf '\\n%s\\n' END-OF-LINE; }
unsetopt zle_bracketed_paste; unset zle_bracketed_paste; PROMPT='> '; setopt no_always_last_prompt
"""
    )
    return words_given(answer(["zsh", "-i"], f"{line}\t\r", "\nEND-OF-LINE", folder))


def test_zsh_completes_the_same(place):
    needs("zsh")
    assert in_zsh("resilin mater", place) == ["materials"]
    assert in_zsh("resilin run beam.toml --thr", place)[-1] == "--threads"
    assert in_zsh("resilin run bea", place)[-1] == "beam.toml"
    assert in_zsh("resilin run beam.toml --out ou", place)[-1] == "out"
    assert in_zsh("resilin materials neo_hookean_q", place)[-1] == "neo_hookean_quadratic"
    assert in_zsh("resilin run beam.toml --formats us", place)[-1] == "usda"
    assert in_zsh("resilin run beam.toml --set simulation.grav", place)[-1] == "simulation.gravity="
    assert in_zsh("resilin run beam.toml --set body.0.element=P2P", place)[-1] == "body.0.element=P2P0"


def test_the_page_for_man_has_every_command_and_option(tmp_path):
    needs("mandoc")
    page = tmp_path / "resilin.1"
    page.write_text(output("info", "--man-page"))
    lint = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", page], capture_output=True, text=True, check=False)
    assert [line for line in lint.stdout.splitlines() if "missing date" not in line] == []
    text = subprocess.run(["mandoc", "-T", "ascii", page], capture_output=True, text=True, check=True).stdout
    text = re.sub(".\b", "", text)
    for name in commands():
        assert re.search(rf"^ +resilin {name}\b", text, re.MULTILINE), name
        if name != "bench":
            section = text.split(f"\n   resilin {name}\n")[1].split("\n   resilin ")[0]
            assert options_of(name) == set(re.findall(r"^ +(--[\w-]+)", section, re.MULTILINE)), name
    assert re.search(r"\s--set KEY=VALUE\s", text)


def test_help_of_run_has_its_options_in_groups():
    text = output("run", "--help")
    headings = re.findall(r"^(\w[\w ]*):$", text, re.MULTILINE)
    assert {"Scene", "Results", "Computing"} <= set(headings)
    results = text.split("\nResults:\n")[1].split("\n\n")[0]
    assert "--out" in results and "--formats" in results and "--threads" not in results
