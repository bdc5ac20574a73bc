# SPDX-License-Identifier: Apache-2.0
"""tools/results in a small test project, with fake programs:  results_test.py TOOLS_RESULTS"""

import argparse
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RESULTS = None
ROWS = """
[[table]]
title = "Accuracy"
[[table.row]]
what = "ball"
run = "fovea-sim run ball"
figure = "{error_px:.2f} px, {limits.torque*100:.0f} %"
fixed = true

[[table]]
title = "Speed"
[[table.row]]
what = "tick"
run = "fovea-bench tick"
figure = "{tick_ns/1000:.1f} us, {kdl_ns/tick_ns:.1f} times"
goal = "{tick_ns.goal/1000:.0f} us"

[[table]]
title = "Board"
needs = ["no-such-compiler"]
without = "Not measured: the compiler is not installed."
[[table.row]]
what = "board"
run = "fovea-bench mcu"
figure = "{x}"
"""
SUMMARY = {"renderer": "llvmpipe", "error_px": 0.0614, "limits": {"torque": 0.25}}
FIGURES = [{"name": "tick_ns", "value": 2650.0, "unit": "ns", "goal": 5000}, {"name": "kdl_ns", "value": 5300, "goal": None}]


def load():
    loader = importlib.machinery.SourceFileLoader("results", RESULTS)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("results", loader))
    loader.exec_module(module)
    return module


def is_running(process_id):
    state = pathlib.Path("/proc", process_id.strip(), "stat")
    return state.exists() and ") Z " not in state.read_text()


class Extractors(unittest.TestCase):
    def setUp(self):
        self.results = load()

    def test_summary_is_read_by_dotted_names(self):
        values = self.results.values_of({}, json.dumps(SUMMARY))
        self.assertEqual(self.results.fill("{error_px:.2f}; {limits.torque*100:.0f} %", values), "0.06; 25 %")

    def test_figures_are_read_by_name_with_their_goals(self):
        values = self.results.values_of({}, json.dumps(FIGURES))
        self.assertEqual(self.results.fill("{tick_ns/1000:.2f} (goal {tick_ns.goal})", values), "2.65 (goal 5000)")
        self.assertEqual(self.results.fill("{kdl_ns/tick_ns:.1f}, {kdl_ns - tick_ns:.0f}", values), "2.0, 2650")
        self.assertEqual(self.results.fill("{e:.1f}; {e*1e3:.0f}", {"e": 0.5}), "0.5; 500")

    def test_printed_text_is_read_by_named_groups(self):
        output = "ball: 0.061 px\nworst 1e-14 m\nworst 3e-13 m\nlambda 3: nan\n"
        patterns = [r"^ball: (?P<px>\S+) px", r"^worst (?P<max_m>\S+) m", r"worst (?P<first>\S+)"]
        values = self.results.values_of({"find": patterns}, output)
        self.assertEqual(values, {"px": 0.061, "max_m": 3e-13, "first": 1e-14})

    def test_digits_are_grouped_from_five_on(self):
        self.assertEqual(self.results.fill("{a:,}; {b:,}", {"a": 27057.4, "b": 1101}), "27 057; 1101")

    def test_missing_figure_is_named(self):
        for template, values in (("{a}", {}), ("{a}", {"a": None}), ("{b/a}", {"b": 1})):
            with self.assertRaisesRegex(self.results.NoFigure, "no figure a"):
                self.results.fill(template, values)
        with self.assertRaisesRegex(self.results.NoFigure, "no match"):
            self.results.values_of({"find": ["^ball (?P<px>.*)"]}, "square 1\n")

    def test_output_without_text_is_named(self):
        for row in ({}, {"find": ["^ball (?P<px>.*)"]}):
            with self.assertRaisesRegex(self.results.NoFigure, "printed nothing"):
                self.results.values_of(row, "\n")

    def test_only_finite_figures_are_accepted(self):
        for word in ("NaN", "Infinity", "-Infinity"):
            values = self.results.values_of({}, f'{{"a": {word}, "b": 1}}')
            self.assertEqual(self.results.fill("{b}", values), "1")
            for template in ("{a:.2f}", "{b/a:.2f}", "{a*2:,}"):
                with self.assertRaisesRegex(self.results.NoFigure, "the figure a is"):
                    self.results.fill(template, values)
        with self.assertRaisesRegex(self.results.NoFigure, "is inf"):
            self.results.fill("{b*1e9:.0f}", {"b": 1e300})
        with self.assertRaisesRegex(self.results.NoFigure, "max_m is nan"):  # a largest value would hide it
            self.results.values_of({"find": [r"^worst (?P<max_m>\S+)"]}, "worst 1\nworst nan\n")
        with self.assertRaisesRegex(self.results.NoFigure, "not JSON"):
            self.results.values_of({}, "error")

    def test_figures_agree_up_to_one_in_the_last_digit(self):
        for new, old, same in (("0.06 px, 27 057", "0.07 px, 27 057", True), ("0.06 px", "0.08 px", False),
                               ("0.06 px", "0.06 mm", False), ("1e-14", "2e-14", True), ("27 057", "27 157", False),
                               ("1, 2", "1", False)):
            self.assertEqual(self.results.agree(new, old), same, f"{new} against {old}")

    def test_every_row_of_the_list_is_valid(self):
        self.assertGreater(sum(len(table["row"]) for table in self.results.read_tables()), 50)


class Command(unittest.TestCase):
    def setUp(self):
        temp = tempfile.TemporaryDirectory()
        self.addCleanup(temp.cleanup)
        self.root = pathlib.Path(temp.name).resolve()
        self.page = self.root / "tools/bench/RESULTS.md"
        self.page.parent.mkdir(parents=True)
        shutil.copy(RESULTS, self.root / "tools/results")
        shutil.copy(pathlib.Path(RESULTS).parent / "bench/figures.py", self.page.parent)
        (self.page.parent / "results.toml").write_text(ROWS)
        (self.page.parent / "campaigns.md").write_text("# Long campaigns\n\nA day: no fault.\n")
        self.page.write_text("the old page")
        self.program("fovea-sim", SUMMARY)
        self.program("fovea-bench", FIGURES)

    def program(self, name, output, code=0):
        """A fake program that prints `output`, appends its arguments to calls, and exits with `code`."""
        file = self.root / "build/release/bin" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"#!/bin/sh\n[ \"$1\" = --version ] && echo {name} 0.1 abc1234 && exit\n"
                        f"echo {name} >> {self.root}/calls\ncat << 'EOF'\n{json.dumps(output, indent=1)}\nEOF\n"
                        f"exit {code}\n")
        file.chmod(0o755)

    def calls(self):
        file = self.root / "calls"
        return file.read_text().split() if file.exists() else []

    def results(self, *arguments):
        """Exit code and output."""
        done = subprocess.run([sys.executable, self.root / "tools/results", *arguments], capture_output=True, text=True,
                              env={**os.environ, "GIT_CEILING_DIRECTORIES": str(self.root.parent)})
        return done.returncode, done.stdout + done.stderr

    def test_page_is_written_with_its_origin(self):
        code, said = self.results()
        self.assertEqual(code, 0, said)
        page = self.page.read_text()
        for text in ("Written by `tools/results`", "`abc1234`", "GL renderer: llvmpipe", "A day: no fault.",
                     "| ball | 0.06 px, 25 % | `fovea-sim run ball` |", "Not measured: the compiler is not installed.",
                     "| tick | 2.6 us, 2.0 times | 5 us | `fovea-bench tick` |"):
            self.assertIn(text, page)
        self.assertEqual([path.name for path in self.page.parent.glob("RESULTS*")], ["RESULTS.md"])

    def test_missing_program_is_refused_before_any_run(self):
        (self.root / "build/release/bin/fovea-bench").unlink()
        code, said = self.results()
        self.assertEqual(code, 2, said)
        self.assertEqual(len(said.splitlines()), 1, said)
        self.assertIn("has no fovea-bench: cmake --build --preset release", said)
        self.assertEqual(self.calls(), [])

    def test_failure_leaves_the_page(self):
        for output, exit_code, why in ((SUMMARY, 3, "exit code 3"), ({"error_px": None}, 0, "no figure error_px"),
                                       ("text", 0, "no figure")):
            self.program("fovea-sim", output, exit_code)
            code, said = self.results()
            self.assertEqual(code, 1, said)
            self.assertIn("NO FIGURE: ball", said)
            self.assertIn(why, said)
            self.assertEqual(self.page.read_text(), "the old page")

    def test_command_that_does_not_end_is_killed_with_its_children(self):
        (self.root / "build/release/bin/fovea-sim").write_text(f"#!/bin/sh\nsleep 1000 & echo $! > {self.root}/child\nwait\n")
        code, said = self.results("--limit", "1")
        self.assertEqual(code, 1, said)
        self.assertIn("still running after 1 s", said)
        self.assertFalse(is_running((self.root / "child").read_text()))

    def test_check_names_the_rows_that_differ(self):
        self.assertEqual(self.results()[0], 0)
        code, said = self.results("--check")
        self.assertEqual(code, 0, said)
        self.assertIn("1 of 1 figures agree", said)
        self.program("fovea-sim", {**SUMMARY, "error_px": 0.09})
        written = self.page.read_text()
        code, said = self.results("--check")
        self.assertEqual(code, 1, said)
        self.assertIn("DIFFERS: Accuracy: ball: now 0.09 px, 25 %; the page has 0.06 px, 25 %", said)
        self.assertEqual(self.page.read_text(), written)

    def test_programs_of_another_commit_write_no_page(self):
        git = ["git", "-C", self.root, "-c", "user.name=a", "-c", "user.email=a@localhost"]
        subprocess.run([*git, "init", "-q"], check=True)
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "one"], check=True)
        code, said = self.results()
        self.assertEqual(code, 2, said)
        self.assertIn("the programs are of commit abc1234, the working tree is of", said)
        self.assertEqual(self.calls(), [])
        self.assertEqual(self.page.read_text(), "the old page")

    def test_another_renderer_is_not_compared(self):
        self.assertEqual(self.results()[0], 0)
        self.program("fovea-sim", {**SUMMARY, "renderer": "another", "error_px": 0.5})
        code, said = self.results("--check")
        self.assertEqual(code, 77, said)
        self.assertIn("not compared: the renderer is another, the page's is llvmpipe", said)
        self.program("fovea-sim", SUMMARY, 3)
        self.assertEqual(self.results("--check")[0], 1)

    def test_skipped_check_hides_no_difference(self):
        """Another renderer: the rows that nothing rendered are still compared."""
        rows = ROWS + '[[table]]\ntitle = "Exact"\n[[table.row]]\nwhat = "steps"\nrun = "fovea-bench tick"\n' \
                      'figure = "{tick_ns:.0f}"\nfixed = true\n'
        (self.page.parent / "results.toml").write_text(rows)
        self.assertEqual(self.results()[0], 0)
        self.program("fovea-sim", {**SUMMARY, "renderer": "another"})
        code, said = self.results("--check")
        self.assertEqual(code, 0, said)
        self.assertIn("1 of 1 figures agree", said)
        self.program("fovea-bench", [{"name": "tick_ns", "value": 1, "goal": 5000}])
        code, said = self.results("--check")
        self.assertEqual(code, 1, said)
        self.assertIn("DIFFERS: Exact: steps: now 1; the page has 2650", said)

    def test_check_without_the_needed_program_compares_nothing(self):
        (self.page.parent / "results.toml").write_text(ROWS.replace('figure = "{x}"', 'figure = "{x}"\nfixed = true'))
        code, said = self.results("--check", "--only", "Board")
        self.assertEqual(code, 77, said)
        self.assertIn("Not measured: the compiler is not installed.", said)

    def test_wrong_list_is_refused_in_one_line(self):
        for rows, why in (("", "must contain [[table]]"), ("[table]\n", "must contain [[table]]"),
                          ("tabel = 1\n" + ROWS, "nothing else"), ("table = [1]\n", "must contain [[table]]"),
                          (ROWS.replace("fixed = true", "fixed = 1"), "ball: fixed is unknown, or has the wrong type"),
                          (ROWS.replace("fixed = true", "exit = true"), "ball: exit is unknown, or"),
                          (ROWS.replace("fixed = true", "fixt = true"), "ball: fixt is unknown, or"),
                          (ROWS.replace('["no-such-compiler"]', "[1]"), "Board: needs is unknown, or"),
                          (ROWS.replace("fixed = true", 'find = ["("]'), "ball: missing )"),
                          (ROWS.replace('run = "fovea-sim run ball"\n', ""), "ball: run is missing"),
                          (ROWS.replace("fovea-sim run", "../fovea-sim run"), "ball: run must begin with the name"),
                          (ROWS.replace("fovea-sim run ball", ""), "ball: run must begin with the name"),
                          (ROWS.replace("fovea-sim run", "fovea-sim 'run"), "ball: No closing quotation")):
            (self.page.parent / "results.toml").write_text(rows)
            module = load()
            module.ROWS = self.page.parent / "results.toml"
            with self.assertRaises(module.Refused) as refused:
                module.read_tables()
            self.assertEqual(len(str(refused.exception).splitlines()), 1)
            self.assertIn(why, str(refused.exception))
        code, said = self.results()  # the last of them
        self.assertEqual((code, said), (2, "tools/results: results.toml: ball: No closing quotation\n"))
        (self.page.parent / "results.toml").write_text(ROWS.replace("fovea-sim run", "fovea-simm run"))
        code, said = self.results()
        self.assertEqual((code, len(said.splitlines())), (2, 1))
        self.assertIn("has no fovea-simm", said)
        self.assertEqual(self.calls(), [])

    def test_limit_is_a_time(self):
        for limit in ("0", "-1", "nan", "inf", "1e300"):
            with self.assertRaisesRegex(argparse.ArgumentTypeError, "expected a number of seconds"):
                load().limit_s(limit)
        for limit in ("0", "ten"):
            code, said = self.results("--limit", limit)
            self.assertEqual(code, 2, said)
            self.assertIn("argument --limit: ", said)
        self.assertEqual(self.calls(), [])

    def test_page_that_cannot_be_written_is_refused_before_any_run(self):
        (self.page.parent / "campaigns.md").write_text("# Long campaigns\n\n")
        code, said = self.results()
        self.assertEqual(code, 2)
        self.assertEqual(said, "tools/results: tools/bench/campaigns.md has no text below '# Long campaigns'\n")
        (self.page.parent / "campaigns.md").unlink()
        code, said = self.results()
        self.assertEqual(code, 2, said)
        self.assertIn("campaigns.md", said)
        (self.page.parent / "campaigns.md").write_text("# Long campaigns\n\nA day: no fault.\n")
        self.page.unlink()
        self.page.mkdir()
        self.assertEqual(self.results(), (2, "tools/results: tools/bench/RESULTS.md is a folder\n"))
        self.assertEqual(self.calls(), [])

    def test_signal_ends_the_command_too(self):
        for stop in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
            child = self.root / "child"
            child.unlink(missing_ok=True)
            (self.root / "build/release/bin/fovea-sim").write_text(
                f"#!/bin/sh\necho $$ > {child}.new\nmv {child}.new {child}\nsleep 1000\n")
            process = subprocess.Popen([sys.executable, self.root / "tools/results", "--only", "ball"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            while not child.exists():
                self.assertIsNone(process.poll())
                time.sleep(0.02)
            process.send_signal(stop)
            self.assertIn("interrupted", process.communicate(timeout=30)[1])
            self.assertEqual(process.returncode, 1)
            self.assertFalse(is_running(child.read_text()))

    def test_only_prints_and_writes_no_page(self):
        code, said = self.results("--only", "Accuracy")
        self.assertEqual(code, 0, said)
        self.assertIn("| ball | 0.06 px, 25 % |", said)
        self.assertEqual(self.calls(), ["fovea-sim"])
        self.assertEqual(self.page.read_text(), "the old page")
        code, said = self.results("--only", "nothing")
        self.assertEqual(code, 2, said)

    def test_kept_outputs_are_used_by_the_same_build_only(self):
        for _ in range(2):
            self.assertEqual(self.results("--keep", str(self.root / "kept"))[0], 0)
        self.assertEqual(sorted(self.calls()), ["fovea-bench", "fovea-sim"])
        self.program("fovea-sim", {**SUMMARY, "error_px": 0.5})
        self.assertEqual(self.results("--keep", str(self.root / "kept"))[0], 0)
        self.assertIn("| ball | 0.50 px", self.page.read_text())


if __name__ == "__main__":
    RESULTS = sys.argv.pop(1)
    unittest.main(verbosity=2)
