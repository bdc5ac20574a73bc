# SPDX-License-Identifier: Apache-2.0
"""Base class of tests with the simulated robot and the hardware program, connected by the network."""

import json
import pathlib
import signal
import subprocess
import sys
import threading
import unittest

SIM = None
HW = None
# While nothing is commanded, the robot does not wait for its client, in lockstep neither. Then a busy computer is no
# fault of the programs.
PATIENT = ("--set", "safety.missed_ticks=1000", "--set", "safety.arm_lost_ticks=1000")


def main():
    """Runs the tests of the calling file:  FILE FOVEA_SIM FOVEA_HW [TEST]..."""
    global SIM, HW
    HW = sys.argv.pop(2)
    SIM = sys.argv.pop(1)
    unittest.main(verbosity=2)


class TwoPrograms(unittest.TestCase):
    def serve(self, *options, camera=False):
        eye = [] if camera else ["--camera-serial", ""]
        self.server = subprocess.Popen([SIM, "serve", "ball", "--fci-port", "0", "--json", *eye, *options],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True)
        self.addCleanup(self.end_server)
        line = self.server.stderr.readline()
        if camera:
            self.assertIn("GigE Vision", self.server.stderr.readline())
        return line.split("127.0.0.1:")[1].split(",")[0]

    def end_server(self):
        """Ends the server. Returns its summary; None if it has ended before."""
        if self.server.returncode is not None:
            return None
        self.server.send_signal(signal.SIGTERM)
        out, _ = self.server.communicate(timeout=20)
        self.assertEqual(self.server.returncode, 0)
        return json.loads(out)

    def hardware(self, port, *options, camera=False, codes=(0,)):
        eye = [] if camera else ["--set", "camera.driver=none"]
        done = subprocess.run([HW, "loopback", "--set", f"robot.port={port}", "--json", *eye, *options], timeout=100,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)
        self.assertIn(done.returncode, codes, done.stderr)
        summary = json.loads(done.stdout)
        if "--out" in options:
            self.replay(options[options.index("--out") + 1], summary)
        return summary

    def operator(self, port, *options, camera=False):
        """Starts the program with an operator, who types on its stdin."""
        eye = [] if camera else ["--set", "camera.driver=none"]
        hw = subprocess.Popen([HW, "loopback", "--set", f"robot.port={port}", "--json", *eye, *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True)
        watchdog = threading.Timer(60, hw.kill)
        watchdog.start()
        self.addCleanup(watchdog.cancel)
        return hw

    def replay(self, out, summary):
        """Replays the log in the folder `out`. The replay must be bit-exact and complete, except for entries that the
        summary reports as dropped."""
        done = subprocess.run([pathlib.Path(HW).parent / "fovea", "replay", str(out), "--json"], timeout=60,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        replay = json.loads(done.stdout)
        self.assertTrue(replay["identical"] and replay["same_build"] and replay["complete"])
        dropped = summary["records_dropped"] + summary["log_entries_dropped"]
        self.assertLessEqual(replay["ticks_lost"], dropped)
        if dropped == 0:
            self.assertEqual((replay["ticks"], len(replay["segments"])), (summary["ticks"], 1))

    def say(self, hw, word):
        hw.stdin.write(word + "\n")
        hw.stdin.flush()

    def summary_of(self, hw, code=0, run_s=0.0):
        """The program's summary, once it has ended: in 20 s, and `run_s`, which the rest of its run may take."""
        out, said = hw.communicate(timeout=20 + run_s)
        self.assertEqual(hw.returncode, code, f"{out}\n{said}")
        return json.loads(out)

    def wait_for(self, process, *lines):
        """Reads until the process has printed each of the lines, in any order."""
        missing = set(lines)
        while missing:
            got = process.stderr.readline()
            self.assertNotEqual(got, "", f"it ended before it printed {missing}")
            missing.discard(got.strip())
