# SPDX-License-Identifier: Apache-2.0
"""Base class of tests with a simulated robot on the network, and shared functions."""

import signal
import struct
import subprocess
import sys
import time
import unittest

import fci_client as fci

PROGRAM = None


def main():
    """Runs the tests of the calling file:  FILE FOVEA_SIM [TEST]..."""
    global PROGRAM
    PROGRAM = sys.argv.pop(1)
    unittest.main(verbosity=2)


class Served(unittest.TestCase):
    """Starts a server for each test and ends it by its process id."""

    options = ["--pace", "lockstep"]

    def setUp(self):
        self.server = subprocess.Popen(
            [PROGRAM, "serve", "ball", "--fci-port", "0", "--camera-serial", "", *self.options],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        line = self.server.stderr.readline()
        self.assertIn("serving scenario ball at 127.0.0.1:", line)
        self.port = int(line.split("127.0.0.1:")[1].split(",")[0])
        self.client = fci.Client(self.port)
        self.client.state()

    def tearDown(self):
        self.client.close()
        self.server.send_signal(signal.SIGTERM)
        self.assertEqual(self.server.wait(timeout=10), 0)
        self.server.stderr.close()
        self.server.stdin.close()

    def type(self, line):
        """Types a line at the server, as a person beside the robot does."""
        self.server.stdin.write(line + "\n")
        self.server.stdin.flush()

    def wait_for(self, wanted, wait_s=10.0):
        """The first state for which `wanted` is true."""
        end = time.monotonic() + wait_s
        while True:
            state = self.client.newest()
            if wanted(state):
                return state
            self.assertLess(time.monotonic(), end, (state.robot_mode, state.errors, state.q))

    def provoke(self, controller, generator, what, error, recovery=0):
        """Runs `what` until the robot stops, checks the error, and requests recovery, which must return `recovery`."""
        first = self.client.start(controller, generator)
        for k in range(1, 5000):
            state = self.client.step(**what(k, first))
            if state.robot_mode != fci.MOVING:
                break
        self.assertEqual(state.robot_mode, fci.REFLEX)
        self.assertEqual(state.reflex_reason, [error])
        self.assertEqual(state.errors, [error])
        self.assertEqual(self.client.move_end(), 6)
        self.assertEqual(self.client.request(fci.MOVE, struct.pack("<II6d", 0, 1, *([1.0] * 6))), b"\x03")
        time.sleep(0.3)
        self.assertEqual(self.client.recover(), recovery)
        if recovery == 0:
            state = self.client.newest()
            self.assertEqual((state.robot_mode, state.errors, state.reflex_reason), (fci.IDLE, [], [error]))



def fade(k, steps):
    """A smooth step from 0 to 1, at rest at both ends."""
    x = min(1.0, k / steps)
    return x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)
