# SPDX-License-Identifier: Apache-2.0
"""Half an hour at real pace over the network: the hardware program with the served robot, and an operator at both
keyboards.

  soak_wire.py FOVEA_SIM FOVEA_HW [--minutes 30] [--seed 1] [--json]

The ball wanders. Repeatedly, at random times from the seed, the operator requests Hold and then Track, or presses the
stop button, releases it and recovers. The test checks that every fault is recovered from, that neither program's memory
grows, that no tick uses the heap, that the counters of both sides add up, and the final image error of the ball.
Exit: 0 passed, 1 failed, 2 not started."""

import argparse
import json
import os
import queue
import random
import signal
import subprocess
import sys
import threading
import time

PAGE = os.sysconf("SC_PAGESIZE")
MOST_GROWTH = 4 << 20  # of either program, by the fitted line [bytes]
WARM_UP_S = 180.0
MOST_ERROR_PX = 5.0  # for a wandering ball
PATIENCE_S = 20.0


class Program:
    """One of the two programs, with the lines of its standard error."""

    def __init__(self, *command):
        self.process = subprocess.Popen([str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        self.lines = queue.Queue()
        self.fault = ""  # the program's line about its present fault
        self.said = ""
        self.memory = []
        threading.Thread(target=self.listen, daemon=True).start()
        threading.Thread(target=self.take_answer, daemon=True).start()

    def listen(self):
        for line in self.process.stderr:
            line = line.strip()
            if line.startswith(("fault:", "hold", "track")):
                self.fault = line if line.startswith("fault:") else ""
            self.lines.put(line)

    def take_answer(self):
        self.said = self.process.stdout.read()

    def say(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def wait_for(self, *words):
        """The first line that begins with one of `words`; empty on timeout."""
        end = time.monotonic() + PATIENCE_S
        while (left := end - time.monotonic()) > 0:
            try:
                line = self.lines.get(timeout=left)
            except queue.Empty:
                break
            if line.startswith(words):
                return line
        return ""

    def forget(self):
        while not self.lines.empty():
            self.lines.get()

    def sample(self, at_s):
        try:
            with open(f"/proc/{self.process.pid}/statm", encoding="ascii") as statm:
                self.memory.append((at_s, int(statm.read().split()[1]) * PAGE))
        except (OSError, IndexError):
            pass

    def end(self):
        """Ends the program. Returns its summary."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait(timeout=30)
        time.sleep(0.2)
        return json.loads(self.said)


def growth(samples):
    """Growth of the fitted line [bytes], after a warm-up of a tenth of the time, at least three minutes. In these the
    caches of the renderer and the allocator fill (4 MiB)."""
    if not samples:
        return 0.0
    warm_s = samples[0][0] + max(0.1 * (samples[-1][0] - samples[0][0]), WARM_UP_S)
    points = [point for point in samples if point[0] >= warm_s]
    if len(points) < 10:
        return 0.0
    x_mean = sum(x for x, _ in points) / len(points)
    y_mean = sum(y for _, y in points) / len(points)
    xx = sum((x - x_mean) ** 2 for x, _ in points)
    return sum((x - x_mean) * (y - y_mean) for x, y in points) / xx * (points[-1][0] - points[0][0])


def operate(server, hw, draw, end, complaints):
    """Plays the operator until `end`. Returns the number of each action and fault."""
    done = {"held": 0, "stopped": 0, "recovered": 0}
    begin = time.monotonic()
    hw.wait_for("track")
    while time.monotonic() < end:
        share = (time.monotonic() - begin) / (end - begin)
        print(f"{100.0 * share:.0f} %, {done['held']} held, {done['stopped']} stopped, {done['recovered']} recovered",
              file=sys.stderr, flush=True)
        pause_end = min(end, time.monotonic() + draw.uniform(5.0, 15.0))
        while time.monotonic() < pause_end:
            time.sleep(min(1.0, max(0.0, pause_end - time.monotonic())))
            for program in (server, hw):
                program.sample(time.monotonic() - begin)
            if hw.process.poll() is not None or server.process.poll() is not None:
                complaints.append("a program ended by itself")
                return done
        # A busy machine may miss deadlines at any moment: a fault like any other, to be recovered from.
        hw.forget()
        fault = hw.fault
        if fault:
            done[fault] = done.get(fault, 0) + 1
        elif time.monotonic() + PATIENCE_S > end:
            continue  # too late for another action
        elif draw.random() < 0.5:
            hw.say("hold")
            done["held"] += 1
            answer = hw.wait_for("hold", "fault:")
            if not answer:
                complaints.append("the servo did not hold on request")
            fault = answer if answer.startswith("fault:") else ""
            if not fault:
                hw.say("track")
        else:
            server.say("s")
            done["stopped"] += 1
            fault = hw.wait_for("fault:")
            if not fault:
                complaints.append("the stop button had no effect")
            time.sleep(draw.uniform(0.2, 1.5))
            server.say("s")
            time.sleep(0.5)
        if fault:
            recover(hw, done, complaints)
    # At the end the servo tracks, whatever came last.
    if hw.fault:
        recover(hw, done, complaints)
    time.sleep(PATIENCE_S)
    return done


def recover(hw, done, complaints):
    hw.forget()
    hw.say("recover")
    if hw.wait_for("hold", "track"):
        done["recovered"] += 1
    else:
        complaints.append("recovery from a fault failed")
    hw.say("track")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sim")
    parser.add_argument("hw")
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    complaints = []
    server = Program(options.sim, "serve", "ball", "--fci-port", "0", "--json", "--pace", "real", "--late-ms", "3", "--seed",
                     options.seed, "--set", "target.motion=wander", "--set", "target.speed=0.03", "--set",
                     "target.path_radius=0.05")
    hello = server.wait_for("")
    if "127.0.0.1:" not in hello:
        print(f"soak_wire: the robot is not served: {hello}", file=sys.stderr)
        return 2
    port = hello.split("127.0.0.1:")[1].split(",")[0]
    begin = time.monotonic()
    hw = Program(options.hw, "loopback", "--json", "--enable", "--track", "--set", f"robot.port={port}", "--set",
                 "robot.time=computer", "--set", "camera.time=computer", "--set", "robot.state_timeout_ms=50", "--set",
                 "safety.arm_lost_ticks=1000", "--set", "safety.missed_ticks=20")
    end = begin + 60.0 * options.minutes
    done = operate(server, hw, random.Random(options.seed), end, complaints)
    try:
        robot_side, servo_side = None, None
        servo_side = hw.end()
        robot_side = server.end()
    except (subprocess.TimeoutExpired, ValueError, OSError) as error:
        complaints.append(f"a program gave no summary: {error}")
        for program in (hw, server):
            program.process.kill()
    figures = {"minutes": (time.monotonic() - begin) / 60.0, **done,
               "growth_kib": {"fovea-sim": growth(server.memory) / 1024.0, "fovea-hw": growth(hw.memory) / 1024.0}}
    for name, kib in figures["growth_kib"].items():
        if kib * 1024.0 > MOST_GROWTH:
            complaints.append(f"{name} grew by {kib:.0f} KiB")
    if servo_side and robot_side:
        robot = servo_side["robot"]
        figures |= {"ticks": servo_side["ticks"], "missed_ticks": servo_side["missed_ticks"], "states": robot["states"],
                    "commands": robot["commands"], "lost_states": robot["lost_states"],
                    "missing_commands": robot_side["missing"], "frames_lost": servo_side["camera"]["lost"],
                    "given_up_ms": robot_side["given_up_ms"], "error_px": robot_side.get("error_px"), "mode": servo_side["mode"],
                    "heap_allocations_in_tick": servo_side["heap_allocations_in_tick"]}
        if servo_side["heap_allocations_in_tick"] != 0:
            complaints.append(f"{servo_side['heap_allocations_in_tick']} heap calls in ticks")
        if robot["commands"] > robot["states"] or robot["states"] > robot_side["states"]:
            complaints.append(f"{robot_side['states']} states sent, {robot['states']} received, {robot['commands']} answered")
        if not (robot_side.get("error_px") or 1e9) <= MOST_ERROR_PX:
            complaints.append(f"the final error is {robot_side.get('error_px')} px")
        if servo_side["mode"] not in ("track", "coast"):
            complaints.append(f"the run ended in {servo_side['mode']}, {servo_side['fault']}")
    figures |= {"good": not complaints, "failures": complaints}
    if options.json:
        print(json.dumps(figures, indent=2))
    else:
        for name, value in figures.items():
            print(f"  {name:<26}{value}")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
