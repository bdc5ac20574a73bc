# SPDX-License-Identifier: Apache-2.0
"""tools/tidy in a small test project, with fake clang-tidy and ninja:  tidy_test.py TOOLS_TIDY"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

TIDY = None
# Fails for sources that contain "bad".
CLANG_TIDY = """#!/bin/sh
[ "$1" = --version ] && exit 0
for source; do :; done
! grep -q bad "$source"
"""
NINJA = """#!/bin/sh
for unit in a b; do printf '%s.o: #deps 2\\n    ../../%s.cpp\\n    ../../both.hpp\\n' $unit $unit; done
"""


class Tidy(unittest.TestCase):
    def setUp(self):
        temp = tempfile.TemporaryDirectory()
        self.addCleanup(temp.cleanup)
        self.root = pathlib.Path(temp.name).resolve() / "project"
        for name, text in ((".clang-tidy", ""), ("a.cpp", ""), ("b.cpp", ""), ("both.hpp", ""),
                           ("tests/consumer/project/main.cpp", ""), ("bin/clang-tidy", CLANG_TIDY), ("bin/ninja", NINJA)):
            self.write(name, text)
        for name in ("clang-tidy", "ninja"):
            (self.root / "bin" / name).chmod(0o755)
        (self.root / "tools").mkdir()
        shutil.copy(TIDY, self.root / "tools/tidy")
        self.write("build/release/compile_commands.json", json.dumps(
            [{"file": str(self.root / f"{unit}.cpp"), "command": "cc", "output": f"{unit}.o"} for unit in "ab"]))
        self.write(".gitignore", "build\nbin\n")
        self.git("init", "--quiet")
        self.commit()

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text)

    def git(self, *arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=self.root, check=True)

    def commit(self):
        self.git("add", "-A")
        self.git("commit", "--quiet", "--message", "a")

    def tidy(self, *arguments):
        """Exit code and output."""
        done = subprocess.run([sys.executable, self.root / "tools/tidy", *arguments], capture_output=True, text=True,
                              env={**os.environ, "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}",
                                   "XDG_CACHE_HOME": str(self.root / "build/cache")})
        return done.returncode, done.stdout + done.stderr

    def test_precompiled_headers_are_left_out_of_the_commands(self):
        command = "cc -O3 -Winvalid-pch -include /b/x.dir/cmake_pch.hxx -o a.o -c a.cpp"
        self.write("build/release/compile_commands.json", json.dumps(
            [{"file": str(self.root / "a.cpp"), "command": command, "output": "a.o"}]))
        code, said = self.tidy("a.cpp")
        self.assertEqual(code, 0, said)
        commands = json.loads((self.root / "build/release/tidy/compile_commands.json").read_text())
        self.assertEqual([entry["command"] for entry in commands], ["cc -O3 -o a.o -c a.cpp"])

    def test_sources_compiled_together_are_checked_one_by_one(self):
        together = self.root / "build/release/x.dir/Unity/unity_x_0_cxx.cxx"
        sources = [self.root / "a.cpp", self.root / "b.cpp"]
        self.write(together, "".join(f'/* NOLINT */\n\n#include "{source}"\n' for source in sources))
        self.write("build/release/compile_commands.json", json.dumps(
            [{"file": str(together), "command": f"cc -o a.o -c {together}", "output": "a.o"}]))
        self.write("b.cpp", "bad")
        code, said = self.tidy()
        self.assertEqual(code, 1, said)
        commands = json.loads((self.root / "build/release/tidy/compile_commands.json").read_text())
        self.assertEqual([(entry["file"], entry["command"]) for entry in commands],
                         [(str(source), f"cc -o a.o -c {source}") for source in sources])
        self.assertIn("2 sources, 1 known to be clean", self.tidy()[1])

    def test_changed_header_is_checked_in_a_source_that_names_it(self):
        self.write("b.cpp", '#include "both.hpp"\n')
        self.commit()
        self.write("both.hpp", "int x;")
        self.commit()
        code, said = self.tidy("--since", "HEAD~1")
        self.assertEqual(code, 0, said)
        self.assertIn("] b.cpp", said)
        self.assertIn("1 sources", said)

    def test_clean_source_is_not_checked_again(self):
        code, said = self.tidy()
        self.assertEqual(code, 0, said)
        self.assertIn("not in build/release, so not checked: tests/consumer/project/main.cpp", said)
        self.assertIn("2 sources, 2 known to be clean", self.tidy()[1])
        self.write("b.cpp", "bad")
        code, said = self.tidy()
        self.assertEqual(code, 1, said)
        self.assertIn("2 sources, 1 known to be clean", said)

    def test_source_unknown_to_the_build_is_an_error(self):
        self.write("c.cpp", "")
        self.commit()
        for arguments in ((), ("--since", "HEAD~1"), ("c.cpp",), ("tests/consumer/project/main.cpp",)):
            code, said = self.tidy(*arguments)
            self.assertEqual(code, 2, f"{arguments}: {said}")

    def test_changed_header_is_checked_in_one_source(self):
        self.write("both.hpp", "int x;")
        self.commit()
        code, said = self.tidy("--since", "HEAD~1")
        self.assertEqual(code, 0, said)
        self.assertIn("1 sources, 0 known to be clean", said)
        self.assertIn("no source changed", self.tidy("--since", "HEAD")[1])

    def test_unknown_base_commit_is_refused_except_before_the_first(self):
        code, said = self.tidy("--since", "mian")
        self.assertEqual(code, 2)
        self.assertIn("--since mian: there is no such commit", said)
        for base in ("HEAD~1", "HEAD^", "HEAD~20"):
            code, said = self.tidy("--since", base)
            self.assertEqual(code, 0, said)
            self.assertIn("2 sources", said)

    def test_sources_left_at_timeout_fail_unless_partial(self):
        code, said = self.tidy("--minutes", "0")
        self.assertEqual(code, 1, said)
        self.assertIn("2 of 2 sources were not checked: the time was up", said)
        code, said = self.tidy("--minutes", "0", "--partial")
        self.assertEqual(code, 0, said)
        self.assertIn("2 of 2 sources were not checked: the time was up", said)


if __name__ == "__main__":
    TIDY = sys.argv.pop(1)
    unittest.main(verbosity=2)
