# SPDX-License-Identifier: Apache-2.0
"""The robot's errors and the recovery from them, tested by an independent client:  fci_errors_test.py FOVEA_SIM"""

import math
import signal
import time

import fci_client as fci
import served
from served import Served, fade


class Errors(Served):
    def pulled_to(self, goal):
        """Torques that pull the joints to `goal`."""
        s = self.client.last
        stiffness, damping = [400, 400, 300, 300, 100, 60, 30], [40, 40, 30, 30, 8, 4, 2]
        wish = [k * (g - q) - d * v for k, d, g, q, v in zip(stiffness, damping, goal, s.q, s.dq)]
        return [min(max(w, last - 1.0), last + 1.0) for w, last in zip(wish, s.tau_J_d)]

    def test_torque_step_raises_torque_discontinuity(self):
        self.provoke(fci.EXTERNAL, fci.JOINT_VELOCITY,
                     lambda k, s: {"tau": [0, 0, 0, 0, 0, 0, 1.5 + s.tau_J_d[6]] if k >= 3 else s.tau_J_d},
                     "controller_torque_discontinuity")

    def test_invalid_joint_motions_raise_their_errors(self):
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_POSITION,
                     lambda k, s: {"q_c": [v + 0.1 for v in s.q_d]},
                     "joint_position_motion_generator_start_pose_invalid")
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY,
                     lambda k, s: {"dq_c": [0.1 if k > 2 else 0.0] * 7},
                     "joint_motion_generator_velocity_discontinuity")
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY,
                     lambda k, s: {"dq_c": [6e-3 * (k % 2)] * 7},
                     "joint_motion_generator_acceleration_discontinuity")
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY,
                     lambda k, s: {"dq_c": [2.3 * fade(k, 800)] + [0.0] * 6},
                     "joint_motion_generator_velocity_limits")

    def test_joint_motion_past_a_limit_raises_position_limits(self):
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY,
                     lambda k, s: {"dq_c": [0.0] * 5 + [0.8 * fade(k, 400), 0.0]},
                     "joint_motion_generator_position_limits")

    def test_invalid_cartesian_motions_raise_their_errors(self):
        def shifted(s, by):
            pose = list(s.O_T_EE_d)
            pose[12] += by
            return pose
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_POSITION,
                     lambda k, s: {"O_T_EE_c": shifted(s, 0.1)},
                     "cartesian_position_motion_generator_start_pose_invalid")
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_POSITION,
                     lambda k, s: {"O_T_EE_c": [3.0] * 16},
                     "cartesian_position_motion_generator_invalid_frame")
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_POSITION,
                     lambda k, s: {"O_T_EE_c": shifted(s, 0.001 if k > 2 else 0.0)},
                     "cartesian_motion_generator_velocity_discontinuity")
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_POSITION,
                     lambda k, s: {"O_T_EE_c": s.O_T_EE_d, "elbow_c": [s.elbow_d[0], -s.elbow_d[1]]},
                     "start_elbow_sign_inconsistent")
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY,
                     lambda k, s: {"O_dP_EE_c": [9e-3 * (k % 2), 0, 0, 0, 0, 0]},
                     "cartesian_motion_generator_acceleration_discontinuity")

    def test_invalid_elbows_raise_their_errors(self):
        def pose_and_elbow(elbow):
            return lambda k, s: {"O_T_EE_c": s.O_T_EE_d, "elbow_c": elbow(k, s)}
        for elbow, error in [
                (lambda k, s: [s.elbow_d[0] + 0.1, s.elbow_d[1]], "start_elbow_invalid"),
                (lambda k, s: [s.elbow_d[0] + (0.005 if k > 2 else 0.0), s.elbow_d[1]], "elbow_limit"),
                (lambda k, s: [s.elbow_d[0], s.elbow_d[1] * (-1 if k > 2 else 1)], "elbow_sign_inconsistent")]:
            self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_POSITION, pose_and_elbow(elbow),
                         f"cartesian_motion_generator_{error}")

    def test_cartesian_motion_past_a_limit_raises_its_error(self):
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY,
                     lambda k, s: {"O_dP_EE_c": [0, 0, 0, 0, 0, 2.7 * fade(k, 600)]},
                     "cartesian_motion_generator_velocity_limits")
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY,
                     lambda k, s: {"O_dP_EE_c": [0, 0, 0, 0, 0, 1.0 * fade(k, 400)]},
                     "cartesian_motion_generator_joint_position_limits")

    def test_cartesian_motion_too_fast_for_the_joints_raises_joint_errors(self):
        # The elbow is held, so that joint 1 must make the motion.
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY,
                     lambda k, s: {"O_dP_EE_c": [0, 3e-3 if k > 5 else 0.0, 0, 0, 0, 0], "elbow_c": s.elbow_d},
                     "cartesian_motion_generator_joint_acceleration_discontinuity")
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY,
                     lambda k, s: {"O_dP_EE_c": [0, 6e-4 * k * k if k <= 10 else 0.06 + 0.012 * (k - 10), 0, 0, 0, 0],
                                   "elbow_c": s.elbow_d},
                     "cartesian_motion_generator_joint_velocity_discontinuity")
        turned = [0.0]

        def round_the_base(k, s):
            w = 2.3 * fade(k, 800)
            turned[0] += 1e-3 * w
            begin = math.atan2(s.O_T_EE_d[13], s.O_T_EE_d[12])
            radius = math.hypot(s.O_T_EE_d[12], s.O_T_EE_d[13])
            angle = begin + turned[0]
            return {"O_dP_EE_c": [-w * radius * math.sin(angle), w * radius * math.cos(angle), 0, 0, 0, w],
                    "elbow_c": s.elbow_d}
        self.provoke(fci.JOINT_IMPEDANCE, fci.CARTESIAN_VELOCITY, round_the_base,
                     "cartesian_motion_generator_joint_velocity_limits")

    def test_pose_deviation_past_its_bound_is_a_reflex(self):
        for path, goal, error in [((1e-9, 3.0, 6.0), (10.0, 3.0, 6.0), "max_path_pose_deviation"),
                                  ((10.0, 3.0, 6.0), (1e-9, 3.0, 6.0), "max_goal_pose_deviation")]:
            self.client.start(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY, path=path, goal=goal)
            for k in range(50):
                if self.client.step(finished=k > 10).robot_mode != fci.MOVING:
                    break
            self.assertEqual((self.client.last.robot_mode, self.client.last.errors), (fci.REFLEX, [error]))
            self.assertEqual(self.client.move_end(), 6)
            time.sleep(0.1)
            self.assertEqual(self.client.recover(), 0)

    def test_too_fast_joint_raises_joint_velocity(self):
        def torque(k, s):
            tau = list(s.tau_J_d)
            tau[0] += min(0.9 * k, 60.0)
            return {"tau": tau}
        self.provoke(fci.EXTERNAL, fci.JOINT_VELOCITY, torque, "joint_velocity")

    def test_too_fast_hand_raises_cartesian_velocity(self):
        def torque(k, s):
            turn = 3e-6 * k * k
            return {"tau": self.pulled_to([s.q[0] + turn, *s.q[1:6], s.q[6] - turn])}
        self.provoke(fci.EXTERNAL, fci.JOINT_VELOCITY, torque, "cartesian_velocity")

    def test_unstable_loop_raises_instability_detection(self):
        def torque(k, s):
            tau = self.pulled_to(s.q)
            now = self.client.last
            wish = min(max(600 * (s.q[6] + (0.002 if k > 10 else 0.0) - now.q[6]), -1.5), 1.5)
            tau[6] = now.tau_J_d[6] + min(max(wish - now.tau_J_d[6], -1.0), 1.0)
            return {"tau": tau}
        self.provoke(fci.EXTERNAL, fci.JOINT_VELOCITY, torque, "instability_detection")

    def test_motion_towards_itself_raises_self_collision_avoidance(self):
        goal = [0.0, 0.634, 0.530, -2.946, 0.113, 0.627, 0.7]
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_POSITION,
                     lambda k, s: {"q_c": [a + fade(k, 3000) * (b - a) for a, b in zip(s.q_d, goal)]},
                     "self_collision_avoidance")

    def test_pull_at_the_hand_raises_the_reflex_of_its_threshold(self):
        """A force pulls at the hand."""
        def pulled(torques, forces, error):
            self.assertEqual(self.client.set(fci.SET_COLLISION_BEHAVIOR, *([torques] * 28), *([forces] * 24)), 0)

            def pull(k, s):
                if k == 20:
                    self.type("f 0 60 0")
                return {}
            self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY, pull, error)
            self.type("f 0 0 0")
            self.wait_for(lambda s: abs(s.O_F_ext_hat_K[1]) < 2.0)
        pulled(10.0, 1000.0, "joint_reflex")
        pulled(100.0, 20.0, "cartesian_reflex")

    def test_pull_past_the_torque_range_raises_tau_j_range(self):
        self.assertEqual(self.client.set(fci.SET_COLLISION_BEHAVIOR, *([1000.0] * 52)), 0)

        def pull(k, s):
            if k == 20:
                self.type("f 0 0 -150")
            return {}
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY, pull, "tau_j_range")

    def test_joint_past_its_end_recovers_only_by_guiding_inwards(self):
        self.provoke(fci.EXTERNAL, fci.JOINT_VELOCITY,
                     lambda k, s: {"tau": self.pulled_to([*s.q[:3], s.q[3] - 5e-4 * k, *s.q[4:]])},
                     "joint_position_limits", recovery=2)
        self.type("g")
        self.wait_for(lambda s: s.robot_mode == fci.GUIDING)
        self.type("f -30 0 0")  # in the wrong direction
        state = self.wait_for(lambda s: s.robot_mode == fci.REFLEX)
        self.assertEqual(state.errors, ["joint_position_limits", "joint_move_in_wrong_direction"])
        self.type("f 0 0 0")
        self.type("g")
        time.sleep(0.3)
        self.assertEqual(self.client.recover(), 2)
        self.type("g")
        self.wait_for(lambda s: s.robot_mode == fci.GUIDING)
        self.type("f 20 0 0")
        self.wait_for(lambda s: s.q[3] > -3.0)
        self.type("f 0 0 0")
        self.type("g")
        self.wait_for(lambda s: s.robot_mode == fci.REFLEX)
        self.assertEqual(self.client.recover(), 0)
        self.assertEqual(self.client.newest().errors, [])

    def test_contact_with_the_table_is_a_cartesian_reflex(self):
        """The arm leans forward until the hand presses on the table with more than the threshold."""
        self.assertEqual(self.client.set(fci.SET_COLLISION_BEHAVIOR, *([100.0] * 28), *([10.0] * 6), *([20.0] * 6),
                                         *([10.0] * 6), *([20.0] * 6)), 0)
        self.provoke(fci.JOINT_IMPEDANCE, fci.JOINT_VELOCITY,
                     lambda k, s: {"dq_c": [0, 0.6 * fade(k, 500), 0, 0, 0, 0, 0]}, "cartesian_reflex")

    def test_silence_stops_the_robot_after_20_states(self):
        self.client.start(fci.EXTERNAL, fci.JOINT_VELOCITY)
        tau = self.client.last.tau_J_d
        for _ in range(10):
            self.client.step(tau=tau)
        last = self.client.last.message_id
        state = self.client.last
        while state.robot_mode == fci.MOVING:
            state = self.client.state()
        self.assertEqual(state.reflex_reason, ["communication_constraints"])
        self.assertEqual(state.message_id - last, 20)
        self.assertEqual(self.client.move_end(), 6)
        self.assertEqual(self.client.recover(), 0)

    def test_user_stop_aborts_the_motion(self):
        self.client.start(fci.EXTERNAL, fci.JOINT_VELOCITY)
        tau = self.client.last.tau_J_d
        self.client.step(tau=tau)
        self.server.send_signal(signal.SIGUSR1)
        for _ in range(5000):
            if self.client.step(tau=self.client.last.tau_J_d).robot_mode != fci.MOVING:
                break
        self.assertEqual(self.client.last.robot_mode, fci.USER_STOPPED)
        self.assertEqual(self.client.move_end(), 7)
        self.assertEqual(self.client.recover(), 4)
        self.server.send_signal(signal.SIGUSR1)
        time.sleep(0.3)
        self.assertEqual(self.client.newest().robot_mode, fci.IDLE)


if __name__ == "__main__":
    served.main()
