#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Completion in bash and zsh:  completion_test.py BIN_FOLDER [CLASS]...

The classes that end in Sim need fovea-sim.
"""

import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[3] / "tools/completion"
BIN = pathlib.Path(sys.argv.pop(1)).resolve()


def run(command, **environment):
    environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", **environment}
    return subprocess.run(command, cwd=SCRIPTS, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=60, check=True).stdout


class Bash:
    def complete(self, line, **environment):
        """The words offered for the last word of `line`."""
        words = line.split(" ")
        ask = f"""
            source {shlex.quote(str(SCRIPTS / "fovea.bash"))}
            COMP_WORDS=({" ".join(map(shlex.quote, words))})
            COMP_CWORD={len(words) - 1}
            _fovea {shlex.join([words[0], words[-1], words[-2]])}
            printf '%s\\n' "${{COMPREPLY[@]}}"
        """
        return run(["bash", "-c", ask], **environment).split()


# An interactive zsh that has typed $LINE and pressed the key of $KEY_PRESSED. It leaves its line in the file $TYPED.
ZSHRC = """
    fpath=($FOLDER $fpath)
    autoload -U compinit && compinit -u -D
    setopt no_list_beep
    every-match() { _main_complete; compstate[insert]=all }
    zle -C every-match complete-word every-match
    zle-line-init() {
      BUFFER=$LINE
      CURSOR=$#BUFFER
      zle $KEY_PRESSED
      print -rn -- $BUFFER > $TYPED
      BUFFER=exit
      zle accept-line
    }
    zle -N zle-line-init
"""


class Zsh:
    FOLDER = SCRIPTS

    def press(self, widget, line, **environment):
        """The content of the command line after the key."""
        with tempfile.TemporaryDirectory() as home:
            pathlib.Path(home, ".zshrc").write_text(ZSHRC)
            typed = pathlib.Path(home, "typed")
            # A pseudo-terminal, read until zsh ends.
            run(["zsh", "-fc", "zmodload zsh/zpty; zpty z zsh -d; while zpty -r z; do :; done"], ZDOTDIR=home,
                FOLDER=str(self.FOLDER), LINE=line, KEY_PRESSED=widget, TYPED=str(typed), TERM="dumb", **environment)
            return typed.read_text()

    def complete(self, line, **environment):
        kept = line[:line.rindex(" ") + 1]
        typed = self.press("every-match", line, **environment)
        self.assertEqual(typed[:len(kept)], kept)
        return typed[len(kept):].split()


class Tools:
    """Programs that every build has."""

    def test_sub_commands_of_a_program(self):
        self.assertEqual(sorted(self.complete("fovea rep")), ["replay", "report"])

    def test_options_of_a_sub_command(self):
        self.assertIn("--target", self.complete("fovea atlas --ta"))
        self.assertNotIn("--target", self.complete("fovea report --"))

    def test_choices_of_an_option(self):
        self.assertEqual(sorted(self.complete("fovea detect --target s")), ["sphere", "square"])

    def test_configurations_of_the_robot(self):
        self.assertEqual(self.complete("fovea-hw loop"), ["loopback"])

    def test_keys_of_the_robot_and_of_a_replay(self):
        for line in ["fovea-hw panda --set ", "fovea replay out --set "]:
            self.assertEqual(self.complete(f"{line}servo.lambda_n"), ["servo.lambda_near="])
            self.assertEqual([key for key in self.complete(f"{line}f") if "=" in key], [], "no simulated faults")
        self.assertEqual(self.complete("fovea-hw panda --set robot.speed_s"), ["robot.speed_scale="])

    def test_options_of_a_program_by_its_path(self):
        self.assertEqual(self.complete(f"{BIN}/fovea-hw --no-m"), ["--no-motion"])

    def test_a_path_from_home(self):
        self.assertEqual(self.complete("~/fovea-hw --no-m", HOME=str(BIN)), ["--no-motion"])

    def test_files_of_the_folder(self):
        self.assertIn("fovea.bash", self.complete("fovea detect fovea.b"))


class Simulator:
    """Completion of fovea-sim."""

    def test_scenarios(self):
        self.assertIn("ball-moving", self.complete("fovea-sim run ball-m"))
        self.assertIn("ball-moving", self.complete("fovea-sim pictures ball-m"))

    def test_keys(self):
        self.assertEqual(self.complete("fovea-sim run ball --set servo.lambda_n"), ["servo.lambda_near="])

    def test_keys_and_scenarios_of_a_comparison(self):
        self.assertEqual(self.complete("fovea compare out --set arm.load_ma"), ["arm.load_mass="])
        self.assertEqual([key for key in self.complete("fovea compare out --set truth.arm.load_ma") if "=" in key], [])
        self.assertIn("ball-moving", self.complete("fovea compare out --scenario ball-m"))

    def test_keys_of_a_program_off_the_path(self):
        self.assertEqual(self.complete(f"{BIN}/fovea-sim run ball --set servo.lambda_n", PATH="/usr/bin:/bin"),
                         ["servo.lambda_near="])


class BashTools(Bash, Tools, unittest.TestCase):
    pass


class ZshTools(Zsh, Tools, unittest.TestCase):
    def test_a_word_that_is_complete_ends_in_a_space(self):
        self.assertEqual(self.press("expand-or-complete", "fovea-hw --no-m"), "fovea-hw --no-motion ")

    def test_a_file_is_quoted(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "my picture.png").touch()
            self.assertEqual(self.press("expand-or-complete", f"fovea detect {folder}/my"),
                             f"fovea detect {folder}/my\\ picture.png ")


class ZshToolsInstalled(Zsh, unittest.TestCase):
    def test_it_finds_the_installed_completion_for_bash(self):
        with tempfile.TemporaryDirectory() as share:
            for name, place in [("fovea.bash", "bash-completion/completions/fovea"),
                                ("_fovea", "zsh/site-functions/_fovea")]:
                file = pathlib.Path(share, place)
                file.parent.mkdir(parents=True)
                file.write_bytes((SCRIPTS / name).read_bytes())
            self.FOLDER = file.parent
            self.assertEqual(self.complete("fovea-hw --no-m"), ["--no-motion"])


class BashSim(Bash, Simulator, unittest.TestCase):
    pass


class ZshSim(Zsh, Simulator, unittest.TestCase):
    def test_a_key_waits_for_its_value(self):
        self.assertEqual(self.press("expand-or-complete", "fovea-sim run ball --set servo.lambda_n"),
                         "fovea-sim run ball --set servo.lambda_near=")


if __name__ == "__main__":
    unittest.main()
