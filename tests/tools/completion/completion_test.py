#!/usr/bin/env python3
"""Completion as bash asks for it: completion_test.py BIN_FOLDER"""

import os
import pathlib
import subprocess
import sys
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "tools/completion/fovea.bash"
BIN = pathlib.Path(sys.argv.pop(1)).resolve()


def complete(line):
    """The words offered for the last word of `line`."""
    words = line.split(" ")
    ask = f"""
        source {SCRIPT}
        COMP_WORDS=({" ".join(f"'{word}'" for word in words)})
        COMP_CWORD={len(words) - 1}
        _fovea '{words[0]}' '{words[-1]}' '{words[-2]}'
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-c", ask], cwd=SCRIPT.parent, env=environment, capture_output=True, text=True,
                          timeout=30, check=True)
    return done.stdout.split()


class Completion(unittest.TestCase):
    def test_sub_commands_of_a_program(self):
        self.assertEqual(complete("fovea rep"), ["report", "replay"])

    def test_options_of_a_sub_command(self):
        self.assertIn("--target", complete("fovea atlas --ta"))
        self.assertNotIn("--target", complete("fovea report --"))

    def test_choices_of_an_option(self):
        self.assertEqual(sorted(complete("fovea detect --target s")), ["sphere", "square"])

    def test_scenarios(self):
        self.assertIn("ball-moving", complete("fovea-sim run ball-m"))

    def test_keys(self):
        self.assertEqual(complete("fovea-sim run ball --set servo.lambda_n"), ["servo.lambda_near="])

    def test_files_of_the_folder(self):
        self.assertIn("fovea.bash", complete("fovea detect fovea.b"))


if __name__ == "__main__":
    unittest.main()
