# SPDX-License-Identifier: Apache-2.0
"""tools/mutants in a small test project, with a fake cmake:  mutants_test.py TOOLS_MUTANTS"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

MUTANTS = None
# "Compiles" a source by copying it; fails if the source contains "syntax".
CMAKE = """#!/bin/sh
[ "$1" = --preset ] && exit 0
mkdir -p build/release/bin
grep -q syntax source.sh && { echo "error: syntax"; exit 1; }
cp source.sh build/release/bin/a_test && chmod +x build/release/bin/a_test
"""
SOURCE = """#!/bin/sh
limit=3
unwatched=4
echo '[==========] 1 test from 1 test suite ran.'
[ $limit = 3 ] || { echo '[  FAILED  ] Limit.Holds (0 ms)'; exit 1; }
"""
DROPPED = ("dropped", "limit=3", "limit=9")


class Mutants(unittest.TestCase):
    def setUp(self):
        temp = tempfile.TemporaryDirectory()
        self.addCleanup(temp.cleanup)
        self.root = pathlib.Path(temp.name).resolve() / "project"
        for name, text in (("source.sh", SOURCE), ("bin/cmake", CMAKE), (".gitignore", "build\nbin\n")):
            self.write(name, text)
        (self.root / "bin/cmake").chmod(0o755)
        (self.root / "tools").mkdir()
        shutil.copy(MUTANTS, self.root / "tools/mutants")
        subprocess.run(["git", "init", "--quiet"], cwd=self.root, check=True)

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text)

    def mutants(self, rows, *arguments, chosen="*"):
        """Exit code and output of tools/mutants for a list of (name, old, new)."""
        self.write("tests/mutants/mutants.toml", "".join(
            f'[[mutant]]\nname = "{name}"\nfile = "source.sh"\nold = "{old}"\nnew = "{new}"\nmeans = "m"\n'
            f'tests = ["a_test"]\nfilter = "{chosen}"\n' for name, old, new in rows))
        done = subprocess.run([sys.executable, self.root / "tools/mutants", *arguments], capture_output=True, text=True,
                              env={**os.environ, "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}"})
        return done.returncode, done.stdout + done.stderr

    def test_detected_mutant_passes_and_names_its_test(self):
        code, said = self.mutants([DROPPED])
        self.assertEqual(code, 0, said)
        self.assertIn("dropped: detected by Limit.Holds", said)
        self.assertIn("1 of 1 mistakes were detected", said)
        self.assertEqual((self.root / "source.sh").read_text(), SOURCE)

    def test_surviving_mutant_fails(self):
        code, said = self.mutants([DROPPED, ("alive", "unwatched=4", "unwatched=5")])
        self.assertEqual(code, 1, said)
        self.assertIn("1 of 2 mistakes were detected; not: alive", said)

    def test_each_mutant_is_reverted_before_the_next(self):
        code, said = self.mutants([DROPPED, ("alive", "unwatched=4", "unwatched=5"), ("again", "limit=3", "limit=1")])
        self.assertEqual(code, 1, said)
        self.assertIn("2 of 3 mistakes were detected; not: alive", said)

    def test_mutant_that_does_not_apply_or_compile_fails(self):
        code, said = self.mutants([("gone", "limit=7", "limit=9"), ("broken", "limit=3", "syntax")])
        self.assertEqual(code, 1, said)
        self.assertIn("gone: ITS OLD LINE OCCURS 0 TIMES", said)
        self.assertIn("broken: DOES NOT COMPILE", said)

    def test_check_builds_nothing(self):
        self.assertEqual(self.mutants([DROPPED], "--check")[0], 0)
        code, said = self.mutants([DROPPED, ("gone", "limit=7", "limit=9")], "--check")
        self.assertEqual(code, 1)
        self.assertIn("1 of 2 mistakes can be made", said)
        self.assertFalse((self.root / "build").exists())

    def test_failing_tests_without_a_mutant_are_an_error(self):
        self.write("source.sh", SOURCE.replace("limit=3\n", "limit=2 # limit=3\n"))
        code, said = self.mutants([DROPPED])
        self.assertEqual(code, 2, said)
        self.assertIn("without any mistake Limit.Holds fails", said)

    def test_table_of_the_list_alone_claims_no_result(self):
        code, said = self.mutants([DROPPED], "--table")
        self.assertEqual(code, 0, said)
        self.assertIn("`mutants.toml` lists 1.", said)
        self.assertIn("## Recorded runs\n\nNone.\n", said)
        self.assertIn("| dropped | m | `source.sh` | `a_test`: `*` |\n", said)
        self.assertNotIn("failed in the last run", said)
        self.assertFalse((self.root / "build").exists())

    def test_table_shows_the_recorded_runs(self):
        run = '[[run]]\ndate = "2026-01-02"\ncommit = "abc"\nlisted = 3\nmade = 2\ndetected = 1\n'
        self.write("tests/mutants/runs.toml", run)
        self.assertIn("| 2026-01-02 | `abc` | 3 | 2 | 1 |", self.mutants([DROPPED], "--table")[1])
        self.write("tests/mutants/runs.toml", run.replace("made = 2\n", ""))
        code, said = self.mutants([DROPPED], "--table")
        self.assertEqual(code, 2, said)
        self.assertIn("run 1: made is missing", said)

    def test_table_names_the_test_that_detected_the_mutant(self):
        self.assertIn("listed = 1\nmade = 1\ndetected = 1\n", self.mutants([DROPPED])[1])
        code, said = self.mutants([DROPPED], "--table")
        self.assertEqual(code, 0, said)
        self.assertIn("| dropped | m | `source.sh` | `a_test`: `*` | `Limit.Holds` |", said)
        # A recorded result does not apply to another mistake of the same name.
        self.assertNotIn("Limit.Holds", self.mutants([("dropped", "limit=3", "limit=1")], "--table")[1])
        self.mutants([("alive", "unwatched=4", "unwatched=5")])
        code, said = self.mutants([("alive", "unwatched=4", "unwatched=5"), DROPPED], "--table")
        self.assertEqual(code, 1, said)
        self.assertIn("| **none**: lives: no test failed |", said)

    def test_wrong_usage_is_refused(self):
        self.assertEqual(self.mutants([DROPPED], "--only", "nothing")[0], 2)
        self.assertEqual(self.mutants([DROPPED, DROPPED])[0], 2)
        self.assertEqual(self.mutants([("", "limit=3", "limit=9")])[0], 2)


if __name__ == "__main__":
    MUTANTS = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
