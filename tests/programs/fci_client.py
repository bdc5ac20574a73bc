# SPDX-License-Identifier: Apache-2.0
"""A client of the Franka Control Interface, version 5, for tests. It uses only Python's standard library.

It is written from the interface's description, independent of the driver and the server in C++, with its own offsets.
"""

import select
import socket
import struct
import time

VERSION = 5
PATIENCE_S = 5.0

CONNECT, MOVE, STOP_MOVE, GET_CARTESIAN_LIMIT, SET_COLLISION_BEHAVIOR = 0, 1, 2, 3, 4
SET_JOINT_IMPEDANCE, SET_CARTESIAN_IMPEDANCE, SET_GUIDING_MODE, SET_EE_TO_K = 5, 6, 7, 8
SET_NE_TO_EE, SET_LOAD, SET_FILTERS, AUTOMATIC_ERROR_RECOVERY, LOAD_MODEL_LIBRARY = 9, 10, 11, 12, 13

# Move's modes.
JOINT_IMPEDANCE, CARTESIAN_IMPEDANCE, EXTERNAL = 0, 1, 2
JOINT_POSITION, JOINT_VELOCITY, CARTESIAN_POSITION, CARTESIAN_VELOCITY = 0, 1, 2, 3

# robot_mode of a state.
IDLE, MOVING, GUIDING, REFLEX, USER_STOPPED = 1, 2, 3, 4, 5

SIZE_OF_STATE = 2373
SIZE_OF_COMMAND = 370

# field: (offset, number of doubles)
DOUBLES = {
    "O_T_EE": (8, 16), "O_T_EE_d": (136, 16), "F_T_EE": (264, 16), "EE_T_K": (392, 16), "F_T_NE": (520, 16),
    "NE_T_EE": (648, 16), "m_ee": (776, 1), "I_ee": (784, 9), "F_x_Cee": (856, 3), "m_load": (880, 1),
    "I_load": (888, 9), "F_x_Cload": (960, 3), "elbow": (984, 2), "elbow_d": (1000, 2), "tau_J": (1016, 7),
    "tau_J_d": (1072, 7), "dtau_J": (1128, 7), "q": (1184, 7), "q_d": (1240, 7), "dq": (1296, 7),
    "dq_d": (1352, 7), "ddq_d": (1408, 7), "joint_contact": (1464, 7), "cartesian_contact": (1520, 6),
    "joint_collision": (1568, 7), "cartesian_collision": (1624, 6), "tau_ext_hat_filtered": (1672, 7),
    "O_F_ext_hat_K": (1728, 6), "K_F_ext_hat_K": (1776, 6), "O_dP_EE_d": (1824, 6), "O_ddP_O": (1872, 3),
    "elbow_c": (1896, 2), "delbow_c": (1912, 2), "ddelbow_c": (1928, 2), "O_T_EE_c": (1944, 16),
    "O_dP_EE_c": (2072, 6), "O_ddP_EE_c": (2120, 6), "theta": (2168, 7), "dtheta": (2224, 7),
    "control_command_success_rate": (2365, 1),
}

ERRORS = [
    "joint_position_limits", "cartesian_position_limits", "self_collision_avoidance", "joint_velocity",
    "cartesian_velocity", "force_control_safety", "joint_reflex", "cartesian_reflex", "max_goal_pose_deviation",
    "max_path_pose_deviation", "cartesian_velocity_profile_safety",
    "joint_position_motion_generator_start_pose_invalid", "joint_motion_generator_position_limits",
    "joint_motion_generator_velocity_limits", "joint_motion_generator_velocity_discontinuity",
    "joint_motion_generator_acceleration_discontinuity", "cartesian_position_motion_generator_start_pose_invalid",
    "cartesian_motion_generator_elbow_limit", "cartesian_motion_generator_velocity_limits",
    "cartesian_motion_generator_velocity_discontinuity", "cartesian_motion_generator_acceleration_discontinuity",
    "cartesian_motion_generator_elbow_sign_inconsistent", "cartesian_motion_generator_start_elbow_invalid",
    "force_controller_desired_force_tolerance", "start_elbow_sign_inconsistent", "communication_constraints",
    "power_limit", "cartesian_motion_generator_joint_position_limits",
    "cartesian_motion_generator_joint_velocity_limits", "cartesian_motion_generator_joint_velocity_discontinuity",
    "cartesian_motion_generator_joint_acceleration_discontinuity",
    "cartesian_position_motion_generator_invalid_frame", "controller_torque_discontinuity",
    "joint_p2p_insufficient_torque_for_planning", "tau_j_range", "instability_detection",
    "joint_move_in_wrong_direction", "cartesian_spline", "joint_via_plan_limit",
    "base_acceleration_initialization_timeout", "base_acceleration_invalid_reading",
]

IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]


class State:
    """One RobotState; its fields are attributes."""

    def __init__(self, data):
        assert len(data) == SIZE_OF_STATE, len(data)
        self.message_id = struct.unpack_from("<Q", data, 0)[0]
        for name, (offset, count) in DOUBLES.items():
            values = list(struct.unpack_from(f"<{count}d", data, offset))
            setattr(self, name, values[0] if count == 1 else values)
        self.motion_generator_mode = data[2280]
        self.controller_mode = data[2281]
        self.errors = [ERRORS[k] for k in range(41) if data[2282 + k]]
        self.reflex_reason = [ERRORS[k] for k in range(41) if data[2323 + k]]
        self.robot_mode = data[2364]


def command(message_id, q_c=(0,) * 7, dq_c=(0,) * 7, O_T_EE_c=tuple(IDENTITY), O_dP_EE_c=(0,) * 6, elbow_c=None,
            finished=False, tau=(0,) * 7):
    """The bytes of a RobotCommand."""
    data = struct.pack("<Q7d7d16d6d2dBB7d", message_id, *q_c, *dq_c, *O_T_EE_c, *O_dP_EE_c, *(elbow_c or (0, 0)),
                       1 if elbow_c else 0, 1 if finished else 0, *tau)
    assert len(data) == SIZE_OF_COMMAND
    return data


class Client:
    """One connection; checks the answer to Connect."""

    def __init__(self, port, version=VERSION):
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(("127.0.0.1", 0))
        self.tcp = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
        self.tcp.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.buffer = b""
        self.next_id = 0
        self.robot = None
        self.last = None
        answer = self.request(CONNECT, struct.pack("<HH", version, self.udp.getsockname()[1]))
        assert len(answer) == 3, answer
        self.status, self.version = struct.unpack("<BH", answer)

    def close(self):
        self.tcp.close()
        self.udp.close()

    def post(self, number, payload=b""):
        """Sends a request. Returns its command_id."""
        command_id = self.next_id
        self.next_id += 1
        self.tcp.sendall(struct.pack("<III", number, command_id, 12 + len(payload)) + payload)
        return command_id

    def answer_to(self, number, command_id, wait_s=PATIENCE_S):
        """The payload of the next message, which must answer that request; None after `wait_s`."""
        end = time.monotonic() + wait_s
        while True:
            if len(self.buffer) >= 12:
                got, got_id, size = struct.unpack_from("<III", self.buffer)
                if len(self.buffer) >= size:
                    payload, self.buffer = self.buffer[12:size], self.buffer[size:]
                    assert (got, got_id) == (number, command_id), (got, got_id, number, command_id)
                    return payload
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.tcp], [], [], left)[0]:
                return None
            more = self.tcp.recv(65536)
            if not more:
                raise ConnectionError("the robot closed the connection")
            self.buffer += more

    def request(self, number, payload=b""):
        answer = self.answer_to(number, self.post(number, payload))
        assert answer is not None, f"no answer to {number}"
        return answer

    def set(self, number, *values, form=None):
        """Sends a setter. Returns the status of its answer."""
        answer = self.request(number, struct.pack(form or f"<{len(values)}d", *values))
        assert len(answer) == 1, answer
        return answer[0]

    def state(self):
        """The next state that arrives."""
        self.udp.settimeout(PATIENCE_S)
        data, self.robot = self.udp.recvfrom(4096)
        self.last = State(data)
        return self.last

    def newest(self):
        """The newest state; discards all that are queued before it."""
        while select.select([self.udp], [], [], 0)[0]:
            self.udp.recvfrom(4096)
        return self.state()

    def send(self, data):
        self.udp.sendto(data, self.robot)

    def start(self, controller, generator, path=(10.0, 3.0, 6.0), goal=(10.0, 3.0, 6.0)):
        """Requests a motion. Returns its first state."""
        self.move_id = self.post(MOVE, struct.pack("<II3d3d", controller, generator, *path, *goal))
        answer = self.answer_to(MOVE, self.move_id)
        assert answer == b"\x01", answer
        end = time.monotonic() + PATIENCE_S
        while self.state().robot_mode != MOVING:
            assert time.monotonic() < end
        assert self.last.motion_generator_mode == generator + 1
        assert self.last.controller_mode == controller
        return self.last

    def step(self, **what):
        """Answers the newest state and waits for the next one."""
        self.send(command(self.last.message_id, **what))
        return self.state()

    def finish(self, **what):
        """Finishes the motion. Returns the final status of Move."""
        for _ in range(100):
            if self.last.robot_mode != MOVING:
                break
            self.step(finished=True, **what)
        return self.move_end()

    def move_end(self):
        answer = self.answer_to(MOVE, self.move_id)
        assert answer is not None and len(answer) == 1, answer
        return answer[0]

    def recover(self):
        return self.request(AUTOMATIC_ERROR_RECOVERY)[0]
