# SPDX-License-Identifier: Apache-2.0
"""The hardware program with the simulated robot, two processes and a network:  loopback_test.py FOVEA_SIM FOVEA_HW"""

import hashlib
import json
import pathlib
import signal
import subprocess
import tempfile
import time

import listening
import two_programs
from two_programs import TwoPrograms

READERS = pathlib.Path(__file__).parent.parent / "js"


class Loopback(TwoPrograms):
    def test_both_programs_listen_on_loopback_only(self):
        port = self.serve("--pace", "lockstep", camera=True)
        # Aravis' fake camera answers broadcast searches for cameras; all other sockets stay on loopback.
        calls = {("udp", "255.255.255.255", 3956)}
        found = listening.sockets_of(self.server.pid)
        self.assertEqual({address for _, address, _ in found - calls}, {"127.0.0.1"}, found)
        hw = self.operator(port)
        end = time.monotonic() + 20
        while not any(protocol == "udp" for protocol, _, _ in listening.sockets_of(hw.pid)):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)
        found = listening.sockets_of(hw.pid)
        self.assertEqual({address for _, address, _ in found}, {"127.0.0.1"}, found)
        self.say(hw, "end")
        hw.communicate(timeout=60)

    def tracked(self, *options):
        """Runs 8 s in lockstep, at a quarter of real pace. Returns the summaries of client and server. The robot waits
        for the servo; the detector has 130 ms for each picture, ten times what it needs."""
        port = self.serve("--pace", "lockstep", "--most-speed", "0.25", *options, camera=True)
        s = self.hardware(port, "--track", "--seconds", "8", camera=True, codes=(0, 1))
        truth = self.end_server()
        camera = s["camera"]
        print(f"\n{truth['error_px']:.3f} px, {truth['error_mm']:.3f} mm off; {camera['lost']} of {truth['frames_sent']} frames "
              f"lost, ages up to {camera['feature_age_ms']['max']:.0f} ms; success rate {s['robot']['command_success_rate']}")
        self.assertEqual(s["heap_allocations_in_tick"], 0)
        self.assertGreater(truth["frames_sent"], 200)
        return s, truth

    def test_it_tracks_the_ball_in_lockstep(self):
        s, truth = self.tracked()
        self.assertEqual((s["mode"], s["fault"], s["converged"]), ("track", "none", True))
        self.assertLessEqual(truth["error_px"], 0.5)
        self.assertLessEqual(truth["error_mm"], 0.6)
        self.assertGreaterEqual(s["camera"]["frames_detected"], 0.95 * s["camera"]["frames"])

    def test_log_and_report_match_the_run(self):
        with tempfile.TemporaryDirectory() as temp:
            out = pathlib.Path(temp) / "a" / "b"
            port = self.serve("--pace", "lockstep", "--most-speed", "0.5", camera=True)
            s = self.hardware(port, "--track", "--seconds", "4", "--out", str(out), "--set", "log.picture_rate_hz=10",
                              camera=True, codes=(0, 1))
            print(f"\n{s['log_pictures']} pictures of {s['camera']['frames']} in the log")
            self.assertEqual({file.name for file in out.iterdir()}, {"camera.mp4", "log.mcap", "report.html", "summary.json"})
            self.assertEqual(json.loads((out / "summary.json").read_text()), s)
            self.assertEqual(s["heap_allocations_in_tick"], 0)
            # Four seconds of ticks fit into the rings, also on a busy machine.
            self.assertEqual((s["records_dropped"], s["log_entries_dropped"]), (0, 0))
            self.assertLessEqual(s["log_pictures"] + s["log_pictures_dropped"], 4 * 10 + 1)
            # A busy machine may keep the detector from the last pictures; then the run reports no convergence.
            self.assertEqual(s["converged"], s["mode"] == "track" and s["camera"]["seen_error_px"] <= 3.0, s["verdict"])
            self.assertEqual(s["fault"], "none")
            for reader in (["read_log.mjs", str(out), "hardware"],
                           ["open_report.mjs", str(out / "report.html"), str(out), "hardware"]):
                # As long as the other tests of a report: a software renderer draws the arm, beside other tests.
                done = subprocess.run(["node", READERS / reader[0], *reader[1:]], timeout=300, capture_output=True,
                                      text=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_log_is_compared_with_the_simulated_arm(self):
        """The robot carries 0.2 kg of which nobody knows. The client's log tells it, as a real robot's would."""
        with tempfile.TemporaryDirectory() as out:
            port = self.serve("--pace", "lockstep", "--set", "truth.arm.load_mass=0.45")
            self.hardware(port, "--seconds", "2", "--enable", "--out", out, *two_programs.PATIENT)
            done = subprocess.run([pathlib.Path(two_programs.HW).parent / "fovea", "compare", out, "--json"], timeout=60,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            found = json.loads(done.stdout)
            print(f"\nload {found['load_mass']:+.3f} kg")
            self.assertAlmostEqual(found["load_mass"], 0.2, delta=0.01)
            self.assertGreaterEqual(found["joints"][1]["shares"]["load"], 0.9)

    def test_serve_leaves_summary_json_in_its_out_folder(self):
        with tempfile.TemporaryDirectory() as temp:
            out = pathlib.Path(temp) / "served"
            port = self.serve("--pace", "lockstep", "--out", str(out))
            s = self.hardware(port, "--seconds", "0.5", "--enable")
            truth = self.end_server()
            self.assertEqual({file.name for file in out.iterdir()}, {"summary.json"})
            self.assertEqual(json.loads((out / "summary.json").read_text()), truth)
            self.assertEqual((truth["scenario"], truth["pace"], truth["contact_ticks"]), ("ball", "lockstep", 0))
            self.assertGreater(truth["commands"], 400)
            for key in ("format", "servo", "version"):
                self.assertEqual(truth[key], s[key], key)

    def test_film_switched_off_leaves_no_film(self):
        with tempfile.TemporaryDirectory() as temp:
            (pathlib.Path(temp) / "camera.mp4").write_text("of another run")
            port = self.serve("--pace", "lockstep", camera=True)
            self.hardware(port, "--track", "--seconds", "1", "--out", temp, "--set", "log.film=false", camera=True,
                          codes=(0, 1))
            self.assertEqual({file.name for file in pathlib.Path(temp).iterdir()},
                             {"log.mcap", "report.html", "summary.json"})

    def test_unwritable_folder_is_refused_before_anything_moves(self):
        with tempfile.NamedTemporaryFile() as file:
            done = subprocess.run([two_programs.HW, "loopback", "--set", "robot.port=1", "--set", "camera.driver=none", "--out",
                                   file.name], timeout=20, capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"--out {file.name}: the folder cannot be made", done.stderr)

    def test_it_tracks_the_ball_over_a_bad_network(self):
        s, truth = self.tracked("--late-ms", "3", "--loss", "0.05", "--jitter-ms", "2")
        self.assertEqual((s["mode"], s["fault"], s["converged"]), ("track", "none", True))
        self.assertGreater(s["robot"]["lost_states"], 300)
        self.assertLess(s["robot"]["command_success_rate"], 0.9)
        self.assertLessEqual(truth["error_px"], 0.5)
        self.assertLessEqual(truth["error_mm"], 0.6)

    def test_nothing_moves_until_the_operator_enables(self):
        port = self.serve("--pace", "lockstep")
        hw = self.operator(port)
        self.wait_for(hw, 'the robot holds by itself; "enable" lets the servo move it')
        self.say(hw, "enabel")
        self.wait_for(hw, '"enabel" is not known; allowed: enable, track, hold, recover, end')
        time.sleep(0.5)
        self.say(hw, "end")
        s = self.summary_of(hw, code=1)  # the servo never started
        self.assertEqual((s["ticks"], s["robot"]["motions"], s["robot"]["commands"]), (0, 0, 0))
        self.assertGreater(s["robot"]["states"], 0)

    def test_run_with_an_operator_replays_bit_exact(self):
        """Typed commands, the stop button and a recovery: the replay reproduces them all."""
        with tempfile.TemporaryDirectory() as temp:
            port = self.serve("--pace", "lockstep", "--loss", "0.02")
            hw = self.operator(port, "--enable", "--out", temp)
            try:
                self.wait_for(hw, "hold")
                self.say(hw, "track")
                time.sleep(0.2)
                self.say(hw, "hold")
                self.server.send_signal(signal.SIGUSR1)
                self.wait_for(hw, "fault: the arm returned errors, or nothing (arm_lost)")
                self.server.send_signal(signal.SIGUSR1)
                time.sleep(0.3)
                self.say(hw, "recover")
                self.wait_for(hw, "hold")
            finally:
                hw.send_signal(signal.SIGINT)
                s = self.summary_of(hw)
            self.assertEqual((s["records_dropped"], s["log_entries_dropped"]), (0, 0))
            self.replay(temp, s)

    def test_real_pace_run_drops_no_records(self):
        with tempfile.TemporaryDirectory() as temp:
            port = self.serve("--pace", "real", "--late-ms", "3", "--loss", "0.02", camera=True)
            s = self.hardware(port, "--track", "--seconds", "3", "--out", temp, "--set", "robot.time=computer", "--set",
                              "camera.time=computer", "--set", "robot.state_timeout_ms=50", "--set",
                              "safety.arm_lost_ticks=1000", camera=True, codes=(0, 1))
            self.assertEqual((s["records_dropped"], s["log_entries_dropped"]), (0, 0))

    def test_silent_operator_makes_the_arm_hold(self):
        port = self.serve("--pace", "lockstep")
        hw = self.operator(port, "--set", "input.dead_man_s=0.3")
        self.say(hw, "enable")
        self.wait_for(hw, "enabled")
        # The lease of 0.3 s may end before the servo has left Boot.
        self.wait_for(hw, "the operator is silent: hold", "hold")
        self.say(hw, "end")
        s = self.summary_of(hw)
        self.assertEqual(s["mode"], "hold")
        self.assertEqual(s["dead_man_holds"], 1)
        self.assertEqual(s["robot"]["motions"], 1)

    def press_and_release_stop(self, hw):
        self.server.send_signal(signal.SIGUSR1)
        self.wait_for(hw, "fault: the arm returned errors, or nothing (arm_lost)")
        self.server.send_signal(signal.SIGUSR1)
        time.sleep(0.3)

    def test_recovery_needs_no_permission_to_move(self):
        """A signal recovers while the operator is silent; the arm holds until somebody types "track"."""
        port = self.serve("--pace", "lockstep")
        hw = self.operator(port, "--enable", "--set", "input.dead_man_s=0.3")
        try:
            self.wait_for(hw, "the operator is silent: hold")
            self.press_and_release_stop(hw)
            hw.send_signal(signal.SIGUSR1)
            self.wait_for(hw, 'recovered: the servo holds; type "track" to move again', "hold")
        finally:
            hw.send_signal(signal.SIGINT)
            s = self.summary_of(hw)
        self.assertEqual((s["mode"], s["fault"], s["faults_recovered"]), ("hold", "none", 1))

    def test_hold_that_is_typed_before_the_connection_counts(self):
        port = self.serve("--pace", "lockstep", "--most-speed", "1", camera=True)
        hw = self.operator(port, "--track", "--seconds", "2", "--set", "input.dead_man_s=0", camera=True)
        self.say(hw, "hold")
        s = self.summary_of(hw, run_s=20)
        self.assertEqual((s["mode"], s["fault"]), ("hold", "none"))

    def test_it_holds_the_arm_in_lockstep(self):
        port = self.serve("--pace", "lockstep")
        s = self.hardware(port, "--enable", "--seconds", "3")
        print(f"\n{s['ticks']} ticks, {s['robot']['commands']} commands, p50 {s['tick_ns']['p50']} ns")
        self.assertEqual((s["mode"], s["fault"]), ("hold", "none"))
        self.assertEqual(s["heap_allocations_in_tick"], 0)
        self.assertLessEqual(s["missed_ticks"], s["robot"]["skipped_states"])  # before the motion, on a busy machine
        self.assertEqual(s["robot"]["lost_states"], 0)
        self.assertEqual(s["robot"]["command_success_rate"], 1.0)
        self.assertGreater(s["robot"]["commands"], 2900)

    def test_no_motion_option_commands_nothing(self):
        port = self.serve("--pace", "lockstep")
        s = self.hardware(port, "--seconds", "1", "--no-motion", *two_programs.PATIENT)
        self.assertEqual((s["robot"]["commands"], s["robot"]["motions"]), (0, 0))
        self.assertGreater(s["robot"]["states"], 0)

    def test_both_programs_link_the_same_servo(self):
        """Both programs report the servo library that they were linked with, and this file exists only once."""
        port = self.serve("--pace", "lockstep")
        hardware = self.hardware(port, "--seconds", "0.2", "--no-motion", *two_programs.PATIENT)["servo"]
        with tempfile.TemporaryDirectory() as temp:
            done = subprocess.run([two_programs.SIM, "run", "home", "--no-report", "--json", "--out", temp, "--set",
                                   "run.duration_s=0.1"], timeout=60, capture_output=True, text=True)
            self.assertIn(done.returncode, (0, 1), done.stderr)
        libraries = list(pathlib.Path(two_programs.HW).parent.parent.glob("lib/libfovea_servo.a"))
        self.assertEqual(len(libraries), 1)
        self.assertEqual(hardware, hashlib.sha256(libraries[0].read_bytes()).hexdigest())
        self.assertEqual(hardware, json.loads(done.stdout)["servo"])

    def test_user_stop_is_reported_and_recovered_from_on_request(self):
        port = self.serve("--pace", "lockstep")
        hw = self.operator(port, "--enable")
        try:
            self.wait_for(hw, "hold")
            self.press_and_release_stop(hw)
            self.say(hw, "recover")
            self.wait_for(hw, "hold")
        finally:
            hw.send_signal(signal.SIGINT)
            s = self.summary_of(hw)
        self.assertEqual(s["robot"]["motions"], 2)

    def test_hung_robot_raises_arm_lost_and_recovers_on_request(self):
        """A hung robot repeats its last state: number, time, joints."""
        port = self.serve("--pace", "lockstep")
        hw = self.operator(port, "--enable", "--set", "robot.state_timeout_ms=20")
        try:
            self.wait_for(hw, "hold")
            self.say(self.server, "h")
            self.wait_for(hw, "fault: the arm returned errors, or nothing (arm_lost)")
            self.say(self.server, "h")
            time.sleep(0.5)
            self.say(hw, "recover")
            self.wait_for(hw, "hold")
        finally:
            hw.send_signal(signal.SIGINT)
            s = self.summary_of(hw)
        print(f"\n{s['robot']['duplicate_states']} states were repeated")
        self.assertGreater(s["robot"]["duplicate_states"], 100)
        self.assertEqual(s["robot"]["motions"], 2)

    def test_pre_flight_passes_the_robot_and_fails_a_wrong_load(self):
        port = self.serve("--pace", "real")
        done = subprocess.run([two_programs.HW, "loopback", "--check", "--json", "--set", f"robot.port={port}", "--set",
                               "check.seconds=0.5"], timeout=60, capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        rows = {row["what"]: row for row in json.loads(done.stdout)}
        self.assertEqual(set(rows), {"kernel", "processor speed", "privileges", "wake-up", "limits", "robot",
                                     "robot's mode", "states", "joint ranges", "kinematics", "gravity", "calibration",
                                     "mounting", "camera", "beliefs"})
        self.assertEqual(rows["camera"]["verdict"], "fail")  # there is no camera
        for what in ("robot", "robot's mode", "limits", "joint ranges", "kinematics", "gravity"):
            self.assertEqual(rows[what]["verdict"], "pass", rows[what])
        self.assertEqual(done.returncode, 1 if any(r["verdict"] == "fail" for r in rows.values()) else 0)
        heavy = subprocess.run([two_programs.HW, "loopback", "--check", "--json", "--set", f"robot.port={port}", "--set",
                                "check.seconds=0.1", "--set", "arm.load_mass=3"], timeout=60, capture_output=True,
                               text=True)
        self.assertEqual(heavy.returncode, 1)
        rows = {row["what"]: row for row in json.loads(heavy.stdout)}
        self.assertEqual(rows["gravity"]["verdict"], "fail")

    def rows(self, port, *options):
        """The rows of the pre-flight check by name, and its exit code."""
        done = subprocess.run([two_programs.HW, "loopback", "--check", "--json", "--set", f"robot.port={port}", "--set",
                               "check.seconds=1", "--set", "camera.time=computer", *options], timeout=60,
                              capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return {row["what"]: row for row in json.loads(done.stdout)}, done.returncode

    def test_pre_flight_judges_the_camera(self):
        port = self.serve("--pace", "real", camera=True)
        rows, _ = self.rows(port, "--set", "camera.rms_px=0.05", "--set", "camera.mount_rms_mm=0.3")
        print("\n" + "; ".join(f"{what}: {rows[what]['found']}" for what in ("camera's rate", "frames", "latency")))
        for what in ("calibration", "mounting", "camera"):
            self.assertEqual(rows[what]["verdict"], "pass", rows[what])
        self.assertEqual(rows["calibration"]["found"], "f 554.3 px, its views fit to 0.05 px rms")
        self.assertRegex(rows["camera's rate"]["found"], r"^\d+\.\d Hz$")
        self.assertRegex(rows["frames"]["found"], r"^\d+ came, \d+ lost, \d+ damaged, \d+ late$")
        # The simulated camera sends its pictures 40 ms after their stamps. A busy machine can only add to that.
        self.assertGreaterEqual(float(rows["latency"]["found"].split()[0]), 39.0)
        # Unknown, bad or missing calibration data.
        rows, _ = self.rows(port)
        self.assertEqual((rows["calibration"]["verdict"], rows["mounting"]["verdict"]), ("warn", "warn"))
        self.assertIn("fovea calibrate intrinsics", rows["calibration"]["advice"])
        rows, code = self.rows(port, "--set", "camera.rms_px=3", "--set", "camera.mount_rms_mm=30", "--set",
                               "servo.stale_s=0.03")
        self.assertEqual(code, 1)
        for what in ("calibration", "mounting", "latency"):
            self.assertEqual(rows[what]["verdict"], "fail", rows[what])
        rows, _ = self.rows(port, "--set", "camera.mount_xyz=[0,0,0]", "--set", "camera.mount_rpy_deg=[0,0,0]",
                            "--set", "camera.time=device")
        self.assertEqual((rows["mounting"]["verdict"], rows["latency"]["verdict"]), ("fail", "warn"))

    def test_pre_flight_fails_on_lost_frames(self):
        """With [faults] of the served scenario."""
        def frames(*assignments):
            options = [word for assignment in assignments for word in ("--set", assignment)]
            rows, code = self.rows(self.serve("--pace", "real", *options, camera=True))
            self.end_server()
            self.assertEqual(code, 1 if any(row["verdict"] == "fail" for row in rows.values()) else 0)
            print("\n" + rows["frames"]["found"])
            return rows

        rows = frames("faults.camera_outage_s=[0,1e6]")
        self.assertEqual(rows["frames"]["verdict"], "fail")
        self.assertEqual(rows["frames"]["found"], "0 came in 1.0 s")
        rows = frames("faults.frame_loss=0.5", "faults.frame_loss_s=[0,1e6]")
        came, lost = (int(word.split()[0]) for word in rows["frames"]["found"].split(", ")[:2])
        self.assertEqual(rows["frames"]["verdict"], "fail")
        self.assertGreater(lost, 0.2 * (came + lost))

    def test_late_pictures_raise_the_feature_age(self):
        ages = []
        for options in ([], ["--set", "faults.latency_ms=60", "--set", "faults.latency_s=[0,1e6]"]):
            port = self.serve("--pace", "lockstep", "--most-speed", "0.5", *options, camera=True)
            s = self.hardware(port, "--track", "--seconds", "2", camera=True, codes=(0, 1))
            ages.append(s["camera"]["feature_age_ms"]["p50"])
            self.end_server()
        print(f"\nage of a measurement: {ages[0]:.1f} ms, with 60 ms more {ages[1]:.1f} ms")
        self.assertGreaterEqual(ages[0], 39.0)
        self.assertGreaterEqual(ages[1], 99.0)

    def test_pre_flight_fails_on_an_arm_model_that_differs_from_the_robot(self):
        port = self.serve("--pace", "real")
        with tempfile.TemporaryDirectory() as temp:
            share = pathlib.Path(two_programs.HW).parent.parent / "share" / "fovea" / "robots"
            for name, before, after, what, word in [
                    ("toml", "torque_rate_max = [1000.0", "torque_rate_max = [1200.0", "limits", "torque rate"),
                    ("urdf", 'upper="1.7628"', 'upper="1.8"', "limits", "joint 2's largest angle"),
                    ("urdf", 'xyz="0 -0.316 0"', 'xyz="0 -0.33 0"', "kinematics", "mm")]:
                for kind in ("toml", "urdf"):
                    text = (share / f"panda.{kind}").read_text()
                    if kind == name:
                        self.assertIn(before, text)
                        text = text.replace(before, after)
                    (pathlib.Path(temp) / f"panda.{kind}").write_text(text)
                rows, code = self.rows(port, "--set", f"arm.model={temp}/panda.toml", "--set", "camera.driver=none")
                self.assertEqual((code, rows[what]["verdict"]), (1, "fail"), rows[what])
                self.assertIn(word, rows[what]["found"])
        rows, _ = self.rows(port, "--set", "safety.cartesian_speed=1.9", "--set", "camera.driver=none")
        self.assertEqual(rows["limits"]["verdict"], "fail")
        self.assertEqual(rows["camera"]["verdict"], "warn")

    def test_pre_flight_fails_without_a_robot(self):
        done = subprocess.run([two_programs.HW, "loopback", "--check", "--set", "robot.port=1", "--set", "check.seconds=0.1"],
                              timeout=60, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no connection", done.stdout)

    def test_missing_camera_is_refused(self):
        done = subprocess.run([two_programs.HW, "loopback", "--set", "robot.port=1"], timeout=60, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("fovea-hw: camera 127.0.0.1: not found", done.stderr)

    def test_missing_robot_is_refused(self):
        done = subprocess.run([two_programs.HW, "loopback", "--set", "robot.port=1", "--set", "camera.driver=none"], timeout=20,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("fovea-hw: robot 127.0.0.1:1: no connection", done.stderr)

    def test_tracking_without_a_camera_is_refused(self):
        done = subprocess.run([two_programs.HW, "loopback", "--track", "--set", "camera.driver=none"], timeout=20,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn('--track is not allowed: camera.driver = "none"', done.stderr)

    def test_moving_arm_is_slowed_down_before_its_motion_is_finished(self):
        """The robot reports a fault of its client if a motion ends at speed."""
        port = self.serve("--pace", "lockstep", "--most-speed", "0.25", camera=True)
        hw = self.operator(port, "--track", "--set", "camera.driver=genicam")
        self.wait_for(hw, "track")
        time.sleep(3)  # at most 0.75 s of the robot's time: the arm is still moving
        hw.send_signal(signal.SIGINT)
        out, _ = hw.communicate(timeout=30)
        events = json.loads(out)["events"]
        truth = self.end_server()
        print(f"\nended {truth['error_px']:.1f} px off its goal: {events}")
        self.assertGreater(truth["error_px"], 5.0)
        self.assertEqual([event for event in events if "the robot" in event], [])

    def test_wrong_usage_is_refused_in_one_line(self):
        with tempfile.TemporaryDirectory(suffix=".toml") as folder:
            for words, says in [(["loopback", "--seconds", "nan"], "--seconds: nan is not allowed"),
                                (["loopback", "--seconds=inf"], "--seconds"), (["loopback", "--second", "1"], "--seconds"),
                                ([], "config is required"), ([folder], f"{folder}: is a folder")]:
                done = subprocess.run([two_programs.HW, *words], timeout=20, capture_output=True, text=True)
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr, r"\Afovea-hw: [^\n]*\n\Z")
                self.assertIn(says, done.stderr)

    def test_unknown_configuration_lists_the_shipped_ones(self):
        done = subprocess.run([two_programs.HW, "loopbak"], timeout=20, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("shipped are loopback, panda", done.stderr)


if __name__ == "__main__":
    two_programs.main()
