# SPDX-License-Identifier: Apache-2.0
"""How the hardware program stops, and what it refuses:  hardware_safety_test.py FOVEA_SIM FOVEA_HW

The robot runs in lockstep, so that times in the servo's log are the robot's, also on a busy machine."""

import json
import os
import pathlib
import select
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time

import fci_client as fci
import two_programs
from two_programs import TwoPrograms

PAGE = 4096
PATIENCE_S = 60.0  # for an expected line
MAGIC = b"\x89MCAP0\r\n"


class Terminal:
    """Reads standard error until `stop`, which blocks it as Ctrl-S does: then the pipe is completely full."""

    def __init__(self):
        self.reader, self.writer = os.pipe()
        self.rest = b""
        self.heard = []

    def wait_for(self, *lines):
        """Reads up to the first line that begins with one of `lines`."""
        while True:
            while b"\n" not in self.rest:
                if not select.select([self.reader], [], [], PATIENCE_S)[0]:
                    raise AssertionError(f"no line {lines}; last: {self.heard[-8:]}")
                self.rest += os.read(self.reader, PAGE)
            line, self.rest = self.rest.split(b"\n", 1)
            self.heard.append(line.decode())
            if self.heard[-1].startswith(lines):
                return self.heard[-1]

    def stop(self):
        """Fills the pipe through a second descriptor, so that the program's own descriptor stays blocking."""
        filler = os.open(f"/proc/self/fd/{self.writer}", os.O_WRONLY | os.O_NONBLOCK)
        for size in (PAGE, 1):
            try:
                while True:
                    os.write(filler, b"x" * size)
            except BlockingIOError:
                pass
        os.close(filler)

    def let_go(self):
        """Closes this process's copy of the program's end."""
        os.close(self.writer)
        self.writer = None

    def close(self):
        for fd in (self.reader, self.writer):
            if fd is not None:
                os.close(fd)


class HardwareSafety(TwoPrograms):
    def start(self, port, *options, camera=False, config="loopback"):
        """Starts the program with its own terminal."""
        terminal = Terminal()
        self.addCleanup(terminal.close)
        eye = [] if camera else ["--set", "camera.driver=none"]
        hw = subprocess.Popen([two_programs.HW, config, "--set", f"robot.port={port}", "--json", *eye, *options],
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=terminal.writer, text=True)
        watchdog = threading.Timer(45, hw.kill)
        watchdog.start()
        self.addCleanup(watchdog.cancel)
        self.addCleanup(self.discard, hw)
        return hw, terminal

    def discard(self, hw):
        hw.kill()
        hw.wait()
        for stream in (hw.stdin, hw.stdout):
            stream.close()

    def recover(self, hw, terminal):
        """Requests recovery until it succeeds: the button's release may take time. Returns the refusals for a load."""
        refused = []
        said = ""
        while not said.startswith("gravity: "):
            self.say(hw, "recover")
            said = terminal.wait_for("motion is refused", "no recovery: ", "gravity: ")
            refused += [said] if said.startswith("motion is refused") else []
        return refused

    def folder(self):
        temp = tempfile.TemporaryDirectory()
        self.addCleanup(temp.cleanup)
        return pathlib.Path(temp.name) / "run"

    def modes_of(self, summary):
        return [(m["mode"], m["reason"]) for m in summary["modes"]]

    def since(self, summary, mode, after_s=0.0):
        """When that mode was first entered after `after_s` [s]."""
        return next(m["t_s"] for m in summary["modes"] if m["mode"] == mode and m["t_s"] >= after_s)

    def check_files(self, out, summary):
        """Checks that the files are complete and match the printed summary."""
        log = (out / "log.mcap").read_bytes()
        self.assertEqual((log[:8], log[-8:]), (MAGIC, MAGIC))
        self.assertEqual(json.loads((out / "summary.json").read_text()), summary)
        self.assertEqual([file.name for file in out.iterdir() if file.name.startswith(".")], [])
        if summary["ticks"] > 0:
            self.replay(out, summary)

    # The output is not read.

    def test_dead_man_holds_the_arm_while_output_is_unread(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "0.5", camera=True)
        hw, terminal = self.start(port, "--track", "--seconds", "6", "--set", "input.dead_man_s=4", camera=True)
        terminal.stop()
        s = self.summary_of(hw, code=1, run_s=24)  # 6 s at half speed, and twice that
        print(f"\nno line from the operator for 4 s: {self.modes_of(s)}, {s['lines_unsaid']} lines dropped")
        self.assertIn(("track", ""), self.modes_of(s))
        self.assertEqual(self.modes_of(s)[-1], ("hold", "not_asked"))
        held_s = s["modes"][-1]["t_s"]
        print(f"held after {held_s:.3f} s")
        # The lease starts at the connection; half a second of it passes in the gravity check.
        self.assertGreater(held_s, 2.5)
        self.assertLess(held_s, 4.0)
        self.assertEqual(s["dead_man_holds"], 1)
        self.assertGreater(s["lines_unsaid"], 3)
        self.assertIn("the operator was silent", s["verdict"])
        self.assertFalse(s["converged"])

    def test_words_and_signals_act_while_output_is_unread(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "0.5", camera=True)
        out = self.folder()
        hw, terminal = self.start(port, "--track", "--out", str(out), "--set", "log.film=false", "--set",
                                  "log.picture_rate_hz=0", camera=True)
        terminal.wait_for("track")
        terminal.stop()
        self.say(hw, "hold")
        time.sleep(1.0)
        self.say(hw, "track")
        time.sleep(2.0)
        began = time.monotonic()
        hw.send_signal(signal.SIGINT)
        out_text, _ = hw.communicate(timeout=60)
        took_s = time.monotonic() - began
        s = json.loads(out_text)
        heard = {w["word"]: w["t_s"] for w in s["words"]}
        hold_s = self.since(s, "hold", self.since(s, "track"))
        print(f"\nheard hold at {heard['hold']:.3f} s, held at {hold_s:.3f} s; from Ctrl-C to the program's end, report "
              f"and all, {took_s:.2f} s; {s['lines_unsaid']} lines dropped")
        self.assertLess(abs(hold_s - heard["hold"]), 0.02)
        self.assertEqual([w["word"] for w in s["words"]], ["hold", "track", "end"])
        self.assertLess(took_s, 20.0)
        self.check_files(out, s)

    def test_after_a_dead_man_hold_tracking_needs_a_new_request(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1", camera=True)
        hw, terminal = self.start(port, "--track", "--set", "input.dead_man_s=2", camera=True)
        terminal.wait_for("track")
        terminal.wait_for("the operator is silent: hold")
        terminal.wait_for("hold")
        self.say(hw, "")  # the operator is back, but nothing moves
        time.sleep(0.5)
        self.say(hw, "track")
        terminal.wait_for("track")
        self.say(hw, "end")
        out, _ = hw.communicate(timeout=60)
        s = json.loads(out)
        asked_s = next(w["t_s"] for w in s["words"] if w["word"] == "track")
        first_s = self.since(s, "hold", self.since(s, "track"))
        self.assertEqual([m["mode"] for m in s["modes"] if first_s < m["t_s"] < asked_s - 0.02], [])

    def test_hanging_log_does_not_keep_the_robot(self):
        """The log's file is a pipe that nobody reads."""
        port = self.serve("--pace", "lockstep", "--most-speed", "1")
        out = self.folder()
        out.mkdir()
        os.mkfifo(out / ".log.mcap.partial")
        reader = os.open(out / ".log.mcap.partial", os.O_RDWR | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        hw, terminal = self.start(port, "--enable", "--out", str(out))
        terminal.wait_for("hold")
        time.sleep(3.0)
        began = time.monotonic()
        hw.send_signal(signal.SIGINT)
        terminal.wait_for("told to end")
        while True:  # the robot accepts another client, and holds by itself
            try:
                client = fci.Client(int(port))
                break
            except (OSError, AssertionError, struct.error):
                self.assertLess(time.monotonic() - began, 20.0)
                time.sleep(0.05)
        idle_s = time.monotonic() - began
        self.assertEqual(client.state().robot_mode, fci.IDLE)
        client.close()
        time.sleep(max(0.0, 6.0 - idle_s))
        self.assertIsNone(hw.poll(), "the log's thread still waits for the disk")
        hw.send_signal(signal.SIGINT)
        began = time.monotonic()
        self.assertEqual(hw.wait(timeout=10), 1)
        print(f"\nthe robot was free {idle_s:.2f} s after Ctrl-C, the program ended {time.monotonic() - began:.2f} s after the second")

    def test_log_at_its_largest_size_does_not_end_the_run(self):
        """The log may have 1 MB, as with ulimit -f: it ends there, the run does not."""
        port = self.serve("--pace", "lockstep", "--most-speed", "1")
        out = self.folder()
        done = subprocess.run(["prlimit", "--fsize=1000000", two_programs.HW, "loopback", "--set", f"robot.port={port}",
                               "--set", "camera.driver=none", "--enable", "--seconds", "4", "--out", str(out)],
                              timeout=60, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("the incomplete log is kept in", done.stderr.strip().splitlines()[-1])
        self.assertIn("overruns", done.stdout, "the result is printed")
        self.assertEqual((out / "log.mcap").stat().st_size, 1000000)
        commands = self.end_server()["commands"]
        print(f"\n{commands} commands to the robot in 4 s")
        self.assertGreater(commands, 3900)

    def test_robot_that_repeats_one_state_does_not_keep_the_run(self):
        """Its own time stands still, and a read waits for robot.state_timeout_ms = 3000."""
        for by_signal in (False, True):
            port = self.serve("--pace", "lockstep", "--most-speed", "1")
            out = self.folder()
            hw, terminal = self.start(port, "--enable", "--seconds", "1000" if by_signal else "4", "--out", str(out))
            terminal.wait_for("hold")
            self.say(self.server, "h")
            self.wait_for(self.server, "the robot hangs")
            time.sleep(0.5)  # the servo waits for a state
            began = time.monotonic()
            if by_signal:
                hw.send_signal(signal.SIGINT)
            text, _ = hw.communicate(timeout=40)
            took_s = time.monotonic() - began
            s = json.loads(text)
            print(f"\n{'Ctrl-C' if by_signal else '--seconds 4'}: ended after {took_s:.1f} s, {s['verdict']}")
            self.assertEqual(hw.returncode, 1)
            self.assertIn("the robot sent no new state at the end", s["verdict"])
            self.assertLess(took_s, 9.0)
            self.check_files(out, s)
            self.end_server()

    # Ctrl-C at any moment.

    def test_ctrl_c_before_the_robot_answers_leaves_log_and_summary(self):
        with socket.create_server(("127.0.0.1", 0)) as robot:
            out = self.folder()
            hw, _ = self.start(robot.getsockname()[1], "--enable", "--out", str(out))
            client, _ = robot.accept()  # and sends no answer
            time.sleep(0.2)
            hw.send_signal(signal.SIGINT)
            text, _ = hw.communicate(timeout=20)
            client.close()
        self.assertEqual(hw.returncode, 1)
        s = json.loads(text)
        self.assertEqual((s["ticks"], s["mode"], s["converged"]), (0, "boot", False))
        self.check_files(out, s)

    def test_ctrl_c_while_it_waits_looks_or_holds_leaves_log_and_summary(self):
        for options, line, code in ((["--set", "input.dead_man_s=60"], "the robot holds by itself", 1),
                                    (["--enable"], "connected to", None), (["--enable"], "enabled", None),
                                    (["--enable"], "hold", 0)):
            port = self.serve("--pace", "lockstep", "--most-speed", "1")
            out = self.folder()
            hw, terminal = self.start(port, *options, "--out", str(out))
            terminal.wait_for(line)
            hw.send_signal(signal.SIGINT)
            text, _ = hw.communicate(timeout=30)
            s = json.loads(text)
            print(f"\nCtrl-C at \"{line}\": {s['ticks']} ticks, {s['verdict']}")
            if code is not None:
                self.assertEqual(hw.returncode, code)
            self.assertEqual(hw.returncode, 1 if s["converged"] is False else 0)
            self.check_files(out, s)
            self.end_server()

    def test_ctrl_c_just_after_the_start_leaves_whole_files_or_none(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1")
        for wait_s in (0.02, 0.05, 0.1, 0.2, 0.4, 0.8):
            out = self.folder()
            hw, _ = self.start(port, "--enable", "--out", str(out))
            time.sleep(wait_s)
            hw.send_signal(signal.SIGINT)
            text, _ = hw.communicate(timeout=30)
            print(f"\nCtrl-C after {wait_s} s: exit {hw.returncode}")
            if hw.returncode == -signal.SIGINT:  # ended before it read its command line
                self.assertFalse(out.exists())
            else:
                self.check_files(out, json.loads(text))

    def test_closed_terminal_ends_or_continues_the_run_without_a_fault(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1")
        hw, terminal = self.start(port, "--enable")
        terminal.wait_for("hold")
        hw.send_signal(signal.SIGHUP)
        s = self.summary_of(hw)
        self.assertEqual((s["mode"], s["fault"]), ("hold", "none"))
        hw, terminal = self.start(port, "--enable")
        terminal.wait_for("hold")
        terminal.let_go()  # nobody reads the output
        os.close(terminal.reader)
        terminal.reader = None
        self.say(hw, "hello")
        time.sleep(0.5)
        self.assertIsNone(hw.poll(), "a closed reader does not end the program")
        self.say(hw, "end")
        s = self.summary_of(hw)
        self.assertEqual((s["mode"], s["fault"]), ("hold", "none"))
        self.assertGreater(s["lines_unsaid"], 0)

    def test_arm_is_at_rest_before_its_motion_is_finished(self):
        """Ended while the arm moves, the program first brings it to rest."""
        port = self.serve("--pace", "lockstep", "--most-speed", "0.5", camera=True)
        out = self.folder()
        s = self.hardware(port, "--track", "--seconds", "0.8", "--out", str(out), "--set", "log.film=false", "--set",
                          "log.picture_rate_hz=0", camera=True, codes=(0, 1))
        self.assertEqual(s["fault"], "none")
        print(f"\n{s['ticks'] - 800} ticks to come to rest on the way to the target; ended in {s['mode']}")
        self.assertGreater(s["ticks"], 800 - s["missed_ticks"])
        self.assertLess(s["ticks"], 800 + 2000)

    # A load that is not configured.

    def test_unknown_load_is_refused_before_anything_moves(self):
        for mass in (0.7, 0.0):
            load = ["--set", "faults.load_s=[0,100]", "--set", f"faults.load_mass={mass}"] if mass else []
            port = self.serve("--pace", "lockstep", "--most-speed", "1", *load)
            s = self.hardware(port, "--enable", "--seconds", "0.5", codes=(0, 1))
            print(f"\n{mass} kg: {s['verdict']}; {s['gravity']}")
            self.assertAlmostEqual(s["gravity"]["unknown_mass_kg"], mass, delta=0.05)
            if mass:
                self.assertEqual((s["converged"], s["ticks"], s["robot"]["commands"], s["robot"]["motions"]), (False, 0, 0, 0))
                self.assertIn("motion is refused: measured torques differ", s["verdict"])
                self.assertRegex(s["verdict"], r"as with 0\.[67]\d kg too much at the end effector")
            else:
                self.assertEqual((s["converged"], s["mode"]), (None, "hold"))
                self.assertGreater(s["robot"]["commands"], 0)
            self.end_server()

    def test_enable_succeeds_once_the_unknown_load_is_removed(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1", "--set", "faults.load_s=[0,5]", "--set",
                          "faults.load_mass=0.7")
        hw, terminal = self.start(port)
        refused = 0
        while True:
            self.say(hw, "enable")
            if terminal.wait_for("motion is refused", "enabled") == "enabled":
                break
            refused += 1
        terminal.wait_for("hold")
        self.say(hw, "end")
        s = self.summary_of(hw)
        print(f"\nrefused {refused} times, then enabled")
        self.assertGreater(refused, 0)
        self.assertEqual((s["mode"], s["fault"], s["converged"]), ("hold", "none", None))

    def test_unknown_load_added_during_a_stop_refuses_recovery(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1", "--set", "faults.load_s=[3,9]", "--set",
                          "faults.load_mass=0.7")
        hw, terminal = self.start(port, "--enable")
        terminal.wait_for("hold")
        refused = []
        while True:
            self.say(self.server, "s")
            terminal.wait_for("fault: the arm returned errors, or nothing (arm_lost)")
            self.say(self.server, "s")
            refused += self.recover(hw, terminal)
            terminal.wait_for("hold")
            if refused:
                break
        self.say(hw, "end")
        s = self.summary_of(hw)
        print(f"\n{refused[0]}; refused {len(refused)} times, then: {s['verdict']}")
        self.assertTrue(any("as with 0.70 kg too much" in line for line in refused), refused)
        self.assertEqual((s["fault"], s["faults_recovered"]), ("none", len(s["faults"])))

    # The verdict of a run.

    def test_run_without_motion_is_not_judged(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1")
        s = self.hardware(port, "--no-motion", "--seconds", "0.5", *two_programs.PATIENT, codes=(0,))
        self.assertIsNone(s["converged"])
        self.assertIn("nothing was commanded", s["verdict"])

    def test_target_never_seen_is_not_converged(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1", "--set", "faults.camera_outage_s=[0,1e6]", camera=True)
        s = self.hardware(port, "--enable", "--seconds", "1", camera=True, codes=(1,))
        self.assertIs(s["converged"], False)
        self.assertIn("the camera never saw the target, in ", s["verdict"])

    def test_recovered_fault_is_reported(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1")
        hw, terminal = self.start(port, "--enable")
        terminal.wait_for("hold")
        self.say(self.server, "s")
        terminal.wait_for("fault: the arm returned errors, or nothing (arm_lost)")
        self.say(self.server, "s")
        self.recover(hw, terminal)
        terminal.wait_for("hold")
        self.say(hw, "end")
        s = self.summary_of(hw)
        self.assertIn("recovered from: the arm returned errors, or nothing (arm_lost)", s["verdict"])
        self.assertEqual(s["faults_recovered"], 1)


if __name__ == "__main__":
    two_programs.main()
