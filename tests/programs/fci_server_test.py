# SPDX-License-Identifier: Apache-2.0
"""`fovea-sim serve`, tested by an independent client:  fci_server_test.py FOVEA_SIM"""

import ctypes
import math
import platform
import signal
import struct
import subprocess
import tempfile
import time
import unittest

import fci_client as fci
import listening
import served
from served import Served, fade


class UntrustedClients(Served):
    """Misuse of the server over the network."""

    def test_listens_on_loopback_only(self):
        found = listening.sockets_of(self.server.pid)
        self.assertEqual({address for _, address, _ in found}, {"127.0.0.1"}, found)
        self.assertEqual({protocol for protocol, _, _ in found}, {"tcp", "udp"})

    def test_client_that_reads_no_answers_is_dropped(self):
        machine = {"x86_64": 0, "aarch64": 3}[platform.machine()]
        self.client.tcp.settimeout(5)
        with self.assertRaises(OSError):  # the server disconnects, long before this is a gigabyte
            for _ in range(20000):
                self.client.post(fci.LOAD_MODEL_LIBRARY, bytes([machine, 0]))
        said = [self.server.stderr.readline() for _ in range(2)]
        self.assertIn("the client is gone: it does not read its answers\n", said)
        self.client.close()
        self.client = fci.Client(self.port)  # the next client is served
        self.client.state()

    def test_garbage_ends_only_its_connection(self):
        for garbage in (b"\xff" * 12, struct.pack("<III", 1, 0, 0xFFFFFFFF), struct.pack("<III", 99, 0, 12),
                        struct.pack("<III", fci.MOVE, 0, 13) + b"x"):
            self.client.tcp.sendall(garbage)
            self.client.tcp.settimeout(5)
            self.assertEqual(self.client.tcp.recv(1), b"")
            self.client.close()
            self.client = fci.Client(self.port)
            self.client.state()


class Connecting(Served):
    def test_connect_says_version_5(self):
        self.assertEqual((self.client.status, self.client.version), (0, 5))

    def test_another_version_is_refused(self):
        self.client.close()
        time.sleep(0.1)
        old = fci.Client(self.port, version=4)
        self.assertEqual((old.status, old.version), (1, 5))
        old.close()
        time.sleep(0.1)
        self.client = fci.Client(self.port)
        self.assertEqual(self.client.status, 0)

    def test_states_are_numbered_by_the_millisecond(self):
        first = self.client.state()
        second = self.client.state()
        self.assertEqual(second.message_id, first.message_id + 1)
        self.assertEqual(first.robot_mode, fci.IDLE)
        self.assertEqual((first.motion_generator_mode, first.controller_mode), (0, 3))
        self.assertEqual(first.O_T_EE[15], 1.0)
        self.assertEqual(first.O_ddP_O, [0.0, 0.0, -9.81])
        self.assertAlmostEqual(first.elbow[0], first.q[2], places=9)
        self.assertEqual(first.elbow[1], -1.0)


class BenchFaults(unittest.TestCase):
    """[faults] that act on the arm's body, from 1 s of the robot's time on."""

    def states(self, *assignments):
        """The last state before the fault, and one half a second after its start."""
        options = [word for assignment in assignments for word in ("--set", assignment)]
        server = subprocess.Popen([served.PROGRAM, "serve", "ball", "--fci-port", "0", "--camera-serial", "", "--pace",
                                   "lockstep", *options], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE, text=True)
        try:
            client = fci.Client(int(server.stderr.readline().split("127.0.0.1:")[1].split(",")[0]))
            before = after = client.state()
            self.assertLess(before.message_id, 1000, "the client connects before the fault")
            while after.message_id < 1500:
                after = client.state()
                before = after if after.message_id < 990 else before
            client.close()
            return before, after
        finally:
            server.send_signal(signal.SIGTERM)
            self.assertEqual(server.wait(timeout=10), 0)
            server.stderr.close()

    def test_push_appears_as_external_torque(self):
        before, after = self.states("faults.push=[0,0,0,5,0,0,0]", "faults.push_s=[1,1e6]")
        print(f"\npushed by 5 Nm: {before.tau_ext_hat_filtered[3]:.3f}, then {after.tau_ext_hat_filtered[3]:.3f} Nm")
        self.assertLess(abs(before.tau_ext_hat_filtered[3]), 0.3)
        self.assertAlmostEqual(abs(after.tau_ext_hat_filtered[3]), 5.0, delta=0.5)

    def test_unknown_load_raises_the_measured_torques(self):
        before, after = self.states("faults.load_mass=1", "faults.load_s=[1,1e6]")
        more = max(abs(a - b) for a, b in zip(after.tau_J, before.tau_J))
        print(f"\n1 kg at the hand: measured torques rise by up to {more:.2f} Nm")
        self.assertGreater(more, 2.0)
        self.assertLess(more, 10.0)

    def test_weak_motor_lets_its_joint_sink(self):
        before, after = self.states("faults.torque_loss=0.5", "faults.torque_loss_joint=4",
                                    "faults.torque_loss_s=[1,1e6]")
        felt = after.tau_ext_hat_filtered[3] - before.tau_ext_hat_filtered[3]
        print(f"\nhalf of joint 4's {before.tau_J[3]:.2f} Nm: it sinks by {after.q[3] - before.q[3]:.5f} rad, as if "
              f"{felt:.2f} Nm pulled")
        # The joint moves against the direction of the lost torque.
        self.assertLess((after.q[3] - before.q[3]) * before.tau_J[3], 0.0)
        self.assertLess(felt * before.tau_J[3], -0.3 * before.tau_J[3] ** 2)

    def test_fault_that_serve_cannot_inject_is_refused(self):
        for key in ("wrong_detection", "nan_detection", "encoder_stuck", "encoder_noise", "encoder_nan",
                    "packet_loss", "clock_jump", "deadline_miss", "planner_loss"):
            done = subprocess.run([served.PROGRAM, "serve", "ball", "--fci-port", "0", "--camera-serial", "", "--set",
                                   f"faults.{key}_s=[1,2]"], timeout=20, capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, key)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(f"faults.{key}_s = [1, 2] is not allowed with serve: ", done.stderr)


class RealPace(Served):
    """At real pace, also when the computer pauses the simulated robot for a while."""

    options = ["--pace", "real"]

    def test_states_come_no_faster_than_the_clock(self):
        first = self.client.newest()
        begin = time.monotonic()
        count = 0
        while time.monotonic() - begin < 2.0:
            last = self.client.state()
            count += 1
        rate = count / (time.monotonic() - begin)
        print(f"\n{rate:.1f} states/s, {last.message_id - first.message_id - count} lost")
        self.assertLess(rate, 1510)  # real pace, plus the second that it may catch up

    def interrupt(self, how_long_s):
        """Pauses the server. Returns the delay of the robot's time afterwards [ms]."""
        def behind():
            return min(1e3 * time.monotonic() - self.client.newest().message_id for _ in range(20))

        before = behind()
        self.server.send_signal(signal.SIGSTOP)
        time.sleep(how_long_s)
        self.server.send_signal(signal.SIGCONT)
        time.sleep(1.0)  # time to catch up
        return behind() - before

    def test_robot_time_catches_up_after_a_short_pause(self):
        behind_ms = self.interrupt(0.4)
        print(f"paused for 400 ms: {behind_ms:.1f} ms behind")
        self.assertLess(behind_ms, 200.0)

    def test_time_given_up_after_a_long_pause_is_reported(self):
        behind_ms = self.interrupt(1.6)
        said = [self.server.stderr.readline() for _ in range(2)][1]  # the first line reports the client
        print(f"paused for 1600 ms: {behind_ms:.1f} ms behind; {said}", end="")
        self.assertRegex(said, r"this computer is too slow for real pace: [0-9]+ ms are skipped")
        self.assertGreater(behind_ms, 1000.0)


class Setters(Served):
    def test_frames_change_the_end_effector(self):
        before = self.client.newest()
        tool = list(fci.IDENTITY)
        tool[14] = 0.1034
        self.assertEqual(self.client.set(fci.SET_NE_TO_EE, *tool), 0)
        after = self.client.newest()
        self.assertEqual(after.NE_T_EE, tool)
        self.assertEqual(after.F_T_EE, tool)
        moved = math.dist(after.O_T_EE[12:15], before.O_T_EE[12:15])
        self.assertAlmostEqual(moved, 0.1034, places=4)
        self.assertEqual(self.client.set(fci.SET_EE_TO_K, *tool), 0)
        self.assertEqual(self.client.newest().EE_T_K, tool)

    def test_invalid_frame_is_an_invalid_argument(self):
        self.assertEqual(self.client.set(fci.SET_NE_TO_EE, *([2.0] * 16)), 2)

    def test_declared_but_absent_load_is_felt_as_a_push_upwards(self):
        self.assertEqual(self.client.set(fci.SET_LOAD, 0.5, 0, 0, 0.05, 0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001), 0)
        for _ in range(400):
            state = self.client.state()
        self.assertEqual(state.m_load, 0.5)
        self.assertEqual(state.F_x_Cload, [0, 0, 0.05])
        self.assertAlmostEqual(state.O_F_ext_hat_K[2], 0.5 * 9.81, delta=0.5)

    def test_other_setters_accept_valid_and_refuse_invalid_values(self):
        c = self.client
        self.assertEqual(c.set(fci.SET_COLLISION_BEHAVIOR, *([20.0] * 28), *([25.0] * 24)), 0)
        self.assertEqual(c.set(fci.SET_JOINT_IMPEDANCE, *([2000.0] * 7)), 0)
        self.assertEqual(c.set(fci.SET_JOINT_IMPEDANCE, *([-1.0] * 7)), 2)
        self.assertEqual(c.set(fci.SET_CARTESIAN_IMPEDANCE, 2000, 2000, 2000, 200, 200, 200), 0)
        self.assertEqual(c.set(fci.SET_CARTESIAN_IMPEDANCE, 1e6, 2000, 2000, 200, 200, 200), 2)
        self.assertEqual(c.set(fci.SET_GUIDING_MODE, 1, 1, 1, 0, 0, 0, 1, form="<7B"), 0)
        self.assertEqual(c.set(fci.SET_FILTERS, 100, 100, 100, 100, 100), 0)
        self.assertEqual(c.set(fci.SET_FILTERS, 0, 100, 100, 100, 100), 2)

    def test_cartesian_limit_request_is_answered(self):
        answer = self.client.request(fci.GET_CARTESIAN_LIMIT, struct.pack("<i", 0))
        self.assertEqual(len(answer), 154)
        self.assertEqual(answer[0], 0)
        self.assertEqual(self.client.request(fci.GET_CARTESIAN_LIMIT, struct.pack("<i", -1))[0], 2)

    def test_setter_is_refused_during_a_motion(self):
        self.client.start(fci.EXTERNAL, fci.JOINT_VELOCITY)
        self.assertEqual(self.client.set(fci.SET_JOINT_IMPEDANCE, *([2000.0] * 7)), 1)


class ModelLibrary(Served):
    def test_loaded_library_agrees_with_the_robot(self):
        machine = {"x86_64": 0, "aarch64": 3}[platform.machine()]
        answer = self.client.request(fci.LOAD_MODEL_LIBRARY, bytes([machine, 0]))
        self.assertEqual(answer[0], 0)
        with tempfile.NamedTemporaryFile(suffix=".so") as file:
            file.write(answer[1:])
            file.flush()
            library = ctypes.CDLL(file.name)
        s = self.client.newest()

        def doubles(values):
            return (ctypes.c_double * len(values))(*values)

        pose = doubles([0.0] * 16)
        library.O_T_J9(doubles(s.q), doubles(s.F_T_EE), pose)
        off = max(abs(a - b) for a, b in zip(pose, s.O_T_EE))
        # The masses of end effector and load are passed as one, at the end effector's position: there is no load.
        torque = doubles([0.0] * 7)
        library.g_NE(doubles(s.q), doubles(s.O_ddP_O), ctypes.c_double(s.m_ee + s.m_load), doubles(s.F_x_Cee), torque)
        felt = [a - b for a, b in zip(s.tau_J, s.tau_J_d)]
        off_torque = max(abs(a - b) for a, b in zip(torque, felt))
        print(f"\nO_T_J9 off by {off:.1e}, g_NE off from the measured torques by {off_torque:.1e} Nm")
        self.assertLess(off, 1e-12)
        self.assertLess(off_torque, 5e-3)
        mass = doubles([0.0] * 49)
        library.M_NE(doubles(s.q), doubles([0.0] * 9), ctypes.c_double(0), doubles([0.0] * 3), mass)
        self.assertGreater(min(mass[8 * i] for i in range(7)), 0)

    def test_library_for_another_machine_is_refused(self):
        self.assertEqual(self.client.request(fci.LOAD_MODEL_LIBRARY, bytes([1, 0])), b"\x01")
        self.assertEqual(self.client.request(fci.LOAD_MODEL_LIBRARY, bytes([0, 1])), b"\x01")


class Motions(Served):
    def start(self, controller, generator):
        return self.client.start(controller, generator)

    def test_joint_positions_are_followed(self):
        for controller in (fci.JOINT_IMPEDANCE, fci.CARTESIAN_IMPEDANCE):
            q = self.start(controller, fci.JOINT_POSITION).q_d
            for k in range(1, 1301):
                goal = [v + 0.15 * fade(k, 1000) for v in q]
                state = self.client.step(q_c=goal)
                self.assertEqual(state.robot_mode, fci.MOVING, state.reflex_reason)
            off = max(abs(a - b) for a, b in zip(state.q, goal))
            print(f"\njoint positions, controller {controller}: off by {off:.2e} rad")
            self.assertLess(off, 1e-3 if controller == fci.JOINT_IMPEDANCE else 3e-2)
            self.assertEqual(state.control_command_success_rate, 1.0)
            self.assertEqual(self.client.finish(q_c=goal), 0)
            self.assertEqual(self.client.last.control_command_success_rate, 0.0)

    def test_joint_velocities_are_followed(self):
        q = self.start(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY).q_d
        way = 0.0
        for k in range(1, 1001):
            v = 0.2 * (fade(k, 300) - fade(max(k - 600, 0), 300))
            way += v * 1e-3
            state = self.client.step(dq_c=[v] + [0.0] * 6)
            self.assertEqual(state.robot_mode, fci.MOVING, state.reflex_reason)
        self.assertAlmostEqual(state.q[0] - q[0], way, delta=1e-3)
        self.assertEqual(self.client.finish(), 0)

    def test_poses_and_elbow_are_followed(self):
        first = self.start(fci.JOINT_IMPEDANCE, fci.CARTESIAN_POSITION)
        for k in range(1, 1301):
            pose = list(first.O_T_EE_d)
            pose[13] += 0.05 * fade(k, 1000)
            elbow = [first.elbow_d[0] + 0.1 * fade(k, 1000), first.elbow_d[1]]
            state = self.client.step(O_T_EE_c=pose, elbow_c=elbow)
            self.assertEqual(state.robot_mode, fci.MOVING, state.reflex_reason)
        self.assertLess(math.dist(state.O_T_EE[12:15], pose[12:15]), 1e-3)
        self.assertAlmostEqual(state.elbow[0], elbow[0], delta=1e-3)
        self.assertEqual(self.client.finish(O_T_EE_c=pose, elbow_c=elbow), 0)

    def test_twists_are_followed(self):
        first = self.start(fci.CARTESIAN_IMPEDANCE, fci.CARTESIAN_VELOCITY)
        for k in range(1, 1001):
            v = 0.1 * (fade(k, 300) - fade(max(k - 600, 0), 300))
            state = self.client.step(O_dP_EE_c=[0, v, 0, 0, 0, 0])
            self.assertEqual(state.robot_mode, fci.MOVING, state.reflex_reason)
        self.assertAlmostEqual(state.O_T_EE[13] - first.O_T_EE[13], 0.06, delta=2e-3)
        self.assertEqual(self.client.finish(), 0)

    def test_torques_move_the_joint(self):
        first = self.start(fci.EXTERNAL, fci.JOINT_VELOCITY)
        q = first.q
        for k in range(1, 1001):
            s = self.client.last
            goal = [v + 0.1 * fade(k, 700) for v in q]
            wish = [(60 if i < 4 else 8) * (goal[i] - s.q[i]) - (12 if i < 4 else 1) * s.dq[i] for i in range(7)]
            tau = [min(max(w, d - 1.0), d + 1.0) for w, d in zip(wish, s.tau_J_d)]
            s = self.client.step(tau=tau)
            self.assertEqual(s.robot_mode, fci.MOVING, s.reflex_reason)
            self.assertEqual(s.tau_J_d, tau)
        self.assertGreater(s.q[0] - q[0], 0.05)
        self.assertEqual(self.client.finish(tau=s.tau_J_d), 0)

    def test_stop_move_ends_a_motion(self):
        self.start(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY)
        self.client.step()
        self.assertEqual(self.client.request(fci.STOP_MOVE)[0], 0)
        self.assertEqual(self.client.move_end(), 2)
        self.assertEqual(self.client.request(fci.STOP_MOVE)[0], 1)

    def test_second_motion_at_once_is_refused(self):
        self.start(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY)
        answer = self.client.request(fci.MOVE, struct.pack("<II6d", 0, 1, *([1.0] * 6)))
        self.assertEqual(answer, b"\x03")


class Walls(Served):
    options = ["--pace", "lockstep", "--wall", "0.1,0.05,0.3,0.6,0.5,0.6"]

    def test_wall_is_reported_and_stops_the_hand(self):
        answer = self.client.request(fci.GET_CARTESIAN_LIMIT, struct.pack("<i", 0))
        size, frame = struct.unpack_from("<3d", answer, 1), struct.unpack_from("<16d", answer, 25)
        self.assertEqual((answer[0], size, frame[12:15], answer[153]), (0, (0.6, 0.5, 0.6), (0.1, 0.05, 0.3), 1))
        self.assertEqual(self.client.request(fci.GET_CARTESIAN_LIMIT, struct.pack("<i", 1))[153], 0)
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY,
                     lambda k, s: {"O_dP_EE_c": [0, 0.1 * fade(k, 300), 0, 0, 0, 0]}, "cartesian_position_limits",
                     recovery=2)
        self.type("g")
        self.wait_for(lambda s: s.robot_mode == fci.GUIDING)
        self.type("f 0 -10 0")
        self.wait_for(lambda s: s.O_T_EE[13] < 0.0)
        self.type("f 0 0 0")
        self.type("g")
        self.wait_for(lambda s: s.robot_mode == fci.REFLEX)
        self.assertEqual(self.client.recover(), 0)

    def test_occupied_port_is_refused_in_one_line(self):
        done = subprocess.run([served.PROGRAM, "serve", "ball", "--fci-port", str(self.port), "--camera-serial", ""],
                              timeout=20, capture_output=True, text=True)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertIn(f"cannot listen on 127.0.0.1:{self.port}: Address already in use", done.stderr)

    def test_malformed_wall_is_refused(self):
        for wall in ("1,2,3", "0,0,0,1,1,0", "0,0,0,1,1,x", "0;0;0;1;1;1"):
            done = subprocess.run([served.PROGRAM, "serve", "ball", "--fci-port", "0", "--wall", wall], timeout=20,
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn(f"--wall {wall} is not allowed: expected X,Y,Z,DX,DY,DZ", done.stderr)


class Guiding(Served):
    def test_guided_hand_moves_along_the_free_axis(self):
        self.assertEqual(self.client.set(fci.SET_GUIDING_MODE, 0, 1, 0, 0, 0, 0, 0, form="<7B"), 0)
        first = self.client.newest()
        self.type("f 10 10 10")
        time.sleep(0.3)
        self.assertEqual(self.client.newest().robot_mode, fci.IDLE)
        self.assertLess(math.dist(self.client.last.O_T_EE[12:15], first.O_T_EE[12:15]), 0.03, "it only yields")
        self.type("g")
        state = self.wait_for(lambda s: s.O_T_EE[13] > first.O_T_EE[13] + 0.05)
        self.assertEqual(state.robot_mode, fci.GUIDING)
        self.assertLess(abs(state.O_T_EE[12] - first.O_T_EE[12]), 0.02)
        self.assertLess(abs(state.O_T_EE[14] - first.O_T_EE[14]), 0.02)
        self.assertEqual(self.client.request(fci.MOVE, struct.pack("<II6d", 0, 1, *([1.0] * 6))), b"\x03")
        self.type("f 0 0 0")
        self.type("g")
        self.wait_for(lambda s: s.robot_mode == fci.IDLE)
        self.client.start(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY)
        for _ in range(50):
            self.assertEqual(self.client.step().robot_mode, fci.MOVING, self.client.last.errors)
        self.assertEqual(self.client.finish(), 0)


if __name__ == "__main__":
    served.main()
