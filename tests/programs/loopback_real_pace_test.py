# SPDX-License-Identifier: Apache-2.0
"""The hardware program with the simulated robot at real pace, where neither waits for the other:
loopback_real_pace_test.py FOVEA_SIM FOVEA_HW

For the accuracy tests the robot's clock is five times slower than the computer's. Then the computer's load does not
matter: only the network makes data late or lost. Each run's log is replayed, and has no pictures, because encoding them
would disturb the measured times."""

import tempfile

import two_programs
from two_programs import TwoPrograms


class RealPace(TwoPrograms):
    def recorded(self, port, *options, **more):
        with tempfile.TemporaryDirectory() as temp:
            return self.hardware(port, *options, "--out", temp, "--set", "log.film=false", "--set", "log.picture_rate_hz=0",
                                 **more)

    def tracked_at_real_pace(self, *options):
        """Runs 6 s of the robot's time. Returns the summaries of client and server."""
        port = self.serve("--pace", "real", "--most-speed", "0.2", "--late-ms", "3", *options, camera=True)
        s = self.recorded(port, "--track", "--seconds", "6", camera=True, codes=(0, 1))
        truth = self.end_server()
        print(f"\nreal pace: {truth['error_px']:.3f} px, {truth['error_mm']:.3f} mm off; {s['mode']}, {s['fault']}; "
              f"{s['missed_ticks']} ticks and {s['camera']['lost']} of {truth['frames_sent']} frames lost, {truth['missing']} "
              f"commands missing, {truth['overruns']} steps late; success rate {s['robot']['command_success_rate']}")
        self.assertEqual(s["heap_allocations_in_tick"], 0)
        self.assertEqual((s["mode"], s["fault"], s["converged"]), ("track", "none", True))
        self.assertLessEqual(truth["error_px"], 0.5)
        self.assertLessEqual(truth["error_mm"], 0.8)
        return s, truth

    def test_it_tracks_the_ball_at_real_pace(self):
        s, truth = self.tracked_at_real_pace()
        self.assertEqual(s["robot"]["lost_states"], 0)

    def test_it_tracks_the_ball_over_a_bad_network_at_real_pace(self):
        # 5 % of the states and commands are lost, some overtake each other, and some answers take 3 ms.
        s, truth = self.tracked_at_real_pace("--loss", "0.05", "--jitter-ms", "2")
        self.assertGreater(s["robot"]["lost_states"], 100)
        self.assertLess(s["robot"]["command_success_rate"], 1.0)

    def test_convergence_reported_at_real_pace_agrees_with_the_truth(self):
        """On the computer's clock, with the client's own stamps. A busy machine may spoil the run. The client may report
        convergence only if the truth agrees."""
        port = self.serve("--pace", "real", "--late-ms", "3", camera=True)
        s = self.recorded(port, "--track", "--seconds", "8", "--set", "robot.time=computer", "--set", "camera.time=computer",
                          "--set", "robot.state_timeout_ms=50", "--set", "safety.arm_lost_ticks=1000", "--set", "safety.missed_ticks=20", camera=True, codes=(0, 1))
        truth = self.end_server()
        print(f"\nreal pace: {truth['error_px']:.3f} px, {truth['error_mm']:.3f} mm off; {s['mode']}, {s['fault']}, converged "
              f"{s['converged']}; {s['missed_ticks']} ticks and {s['camera']['lost']} frames lost, {truth['overruns']} steps late")
        self.assertEqual(s["heap_allocations_in_tick"], 0)
        self.assertIn(s["fault"], ("none", "arm_lost", "deadline_missed"))
        at_goal = truth["error_px"] <= 3.0 and truth["error_mm"] <= 5.0
        self.assertTrue(at_goal or not s["converged"], s["verdict"])

    def test_real_pace_run_receives_states_without_heap_calls(self):
        port = self.serve("--pace", "real", "--late-ms", "3")
        # A busy machine may miss 20 ticks in a row; then the run ends with a reported fault.
        s = self.recorded(port, "--enable", "--seconds", "2", "--set", "robot.time=computer", "--set", "robot.state_timeout_ms=50", "--set", "safety.arm_lost_ticks=1000",
                          codes=(0, 1))
        print(f"\nreal pace: {s['robot']['states']} states, success rate {s['robot']['command_success_rate']}")
        self.assertEqual(s["heap_allocations_in_tick"], 0)
        self.assertGreater(s["robot"]["states"], 0)


if __name__ == "__main__":
    two_programs.main()
