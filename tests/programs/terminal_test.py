# SPDX-License-Identifier: Apache-2.0
"""What the programs print on a pseudo-terminal and into a pipe:  terminal_test.py FOVEA_SIM FOVEA [TEST]..."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import tempfile
import termios
import unittest

SIM = None
FOVEA = None
COLOUR = re.compile(r"\x1b\[\d*m")
# Prints a table with long rows, the same each time.
GAINS = ["gains", "--mass", "2", "--damping", "0", "--stiffness", "0", "--closed-loop-stiffness", "800",
         "--damping-ratio", "0.7", "--delay-ms", "2.5"]


def run(arguments, columns=None, environment=None, only=(1, 2)):
    """Runs a program. Output streams in `only` are a terminal with `columns`, if given; the others are pipes. Returns the
    exit code and the text of standard output and standard error; on a terminal they are one text."""
    given = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "TERM")}
    given.update({"TERM": "xterm", **(environment or {})})
    with tempfile.TemporaryDirectory() as folder:
        if columns is None:
            done = subprocess.run(arguments, cwd=folder, env=given, stdin=subprocess.DEVNULL, capture_output=True,
                                  text=True, timeout=240)
            return done.returncode, done.stdout, done.stderr
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("4H", 40, columns, 0, 0))
        streams = [theirs if number in only else subprocess.PIPE for number in (1, 2)]
        process = subprocess.Popen(arguments, cwd=folder, env=given, stdin=subprocess.DEVNULL, stdout=streams[0],
                                   stderr=streams[1])
        os.close(theirs)
        shown = b""
        try:
            while part := os.read(ours, 65536):
                shown += part
        except OSError:  # the end of a terminal whose last user has closed it
            pass
        finally:
            os.close(ours)
        piped = [part.decode() if part else "" for part in process.communicate(timeout=240)]
        terminal = shown.decode().replace("\r\n", "\n")
        texts = [terminal if number in only else piped[number - 1] for number in (1, 2)]
        return process.returncode, *texts


class Terminal(unittest.TestCase):
    def check_width(self, text, columns):
        for line in COLOUR.sub("", text).replace("\x1b[K", "").splitlines():
            is_one_word = len(line.split("  ")[-1].split()) == 1  # e.g. a hash, which nothing can break
            self.assertTrue(len(line) <= columns or is_one_word, line)

    def check_colours(self, text):
        """Each line ends without a colour."""
        for line in text.splitlines():
            if codes := COLOUR.findall(line):
                self.assertEqual(codes[-1], "\x1b[0m", repr(line))

    def test_table_breaks_on_a_terminal_and_is_whole_in_a_pipe(self):
        code, whole, _ = run([FOVEA, *GAINS])
        self.assertEqual(code, 0)
        longest = max(map(len, whole.splitlines()))
        self.assertGreater(longest, 80, whole)
        self.assertNotIn("\x1b", whole)
        for columns, width in ((40, 60), (60, 60), (80, 80), (200, 100)):
            code, shown, _ = run([FOVEA, *GAINS], columns)
            self.assertEqual(code, 0)
            self.check_width(shown, width)
            self.assertEqual(COLOUR.sub("", shown).split(), whole.split(), "the same words")
            self.assertEqual(len(shown.splitlines()) > len(whole.splitlines()), longest > width)

    def test_verdict_has_a_colour_on_a_terminal_only(self):
        command = [SIM, "run", "theory/pd-regulator", "--no-report", "--out", "out"]
        code, shown, _ = run(command, 80)
        self.assertEqual(code, 0, shown)
        self.assertRegex(shown, r"  verdict +\x1b\[32m[^\x1b\n]+\x1b\[0m\n")
        self.check_width(shown, 80)
        self.check_colours(shown)
        for columns, environment in ((None, {}), (80, {"NO_COLOR": "1"}), (80, {"TERM": "dumb"})):
            code, text, _ = run(command, columns, environment)
            self.assertEqual(code, 0)
            self.assertRegex(text, r"(?m)^  verdict ")
            self.assertIsNone(COLOUR.search(text), text)
            if columns is None or "TERM" in environment:
                self.assertNotIn("\x1b", text, "no bar either")

    def test_bad_verdict_is_red_on_each_of_its_lines(self):
        code, shown, _ = run([SIM, "run", "ball", "--set", "run.duration_s=0.2", "--no-report", "--out", "out"], 60)
        self.assertEqual(code, 1, shown)
        row = re.search(r"  verdict +(.*?)\n  \w", shown, re.DOTALL)[1].splitlines()
        self.assertGreater(len(row), 1, shown)
        for line in row:
            self.assertRegex(line, r"^ *\x1b\[31m[^\x1b]+\x1b\[0m$")
        self.check_width(shown, 60)

    def test_help_is_bold_on_a_terminal_only(self):
        for program in (SIM, FOVEA):
            code, shown, _ = run([program, "--help"], 72)
            self.assertEqual(code, 0)
            self.assertRegex(shown, r"(?m)^\x1b\[1m[A-Z]\w*:\x1b\[0m$")
            self.check_width(shown, 72)
            self.check_colours(shown)
            code, whole, _ = run([program, "--help"])
            self.assertEqual(code, 0)
            self.assertNotIn("\x1b", whole)
            self.check_width(whole, 100)

    def test_error_is_one_line_in_a_pipe_and_breaks_on_a_terminal(self):
        command = [SIM, "run", "no-such-scenario"]
        code, out, whole = run(command)
        self.assertEqual((code, out), (2, ""))
        self.assertEqual(whole.count("\n"), 1)
        self.assertGreater(len(whole), 100)
        code, out, shown = run(command, 60, only=(2,))
        self.assertEqual((code, out), (2, ""))
        self.check_width(shown, 60)
        self.assertEqual(shown.split(), whole.split())

    def test_each_stream_decides_for_itself(self):
        code, piped, _ = run([FOVEA, *GAINS], 60, only=(2,))
        self.assertEqual(code, 0)
        self.assertEqual(piped, run([FOVEA, *GAINS])[1])


if __name__ == "__main__":
    FOVEA = sys.argv.pop(2)
    SIM = sys.argv.pop(1)
    unittest.main(verbosity=2)
