#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the camera driver of camera_driver.patch: writes gray pictures into a pipe and runs `fovea-hw --check`.

  look_through_pipe.py FOVEA_HW FOLDER

Exit 0: the camera opens and gives pictures of the right size. The row of the robot fails, because there is none."""

import json
import os
import pathlib
import subprocess
import sys
import threading
import time

WIDTH, HEIGHT, RATE_HZ = 320, 240, 30.0
CONFIG = f"""
[robot]
host = "127.0.0.1"
[camera]
driver = "pipe"
device = "{{pipe}}"
rate_hz = {RATE_HZ}
width_px = {WIDTH}
height_px = {HEIGHT}
f_u_px = 300.0
f_v_px = 300.0
c_u_px = {0.5 * (WIDTH - 1)}
c_v_px = {0.5 * (HEIGHT - 1)}
[check]
seconds = 1.0
"""


def write_pictures(pipe, done):
    with open(pipe, "wb", buffering=0) as stream:
        shade = 0
        while not done.is_set():
            picture = memoryview(bytes([shade]) * (WIDTH * HEIGHT))
            try:
                while picture:
                    picture = picture[stream.write(picture):]
            except BrokenPipeError:
                return
            shade = (shade + 1) % 256
            time.sleep(1.0 / RATE_HZ)


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    pipe = folder / "eye"
    os.mkfifo(pipe)
    config = folder / "pipe.toml"
    config.write_text(CONFIG.format(pipe=pipe))
    held_open = os.open(pipe, os.O_RDWR | os.O_NONBLOCK)  # so that opening the pipe blocks neither end
    done = threading.Event()
    threading.Thread(target=write_pictures, args=(pipe, done), daemon=True).start()
    checked = subprocess.run([program, config, "--check", "--json"], capture_output=True, text=True, timeout=120,
                             check=False)
    done.set()
    os.close(held_open)
    rows = {row["what"]: row for row in json.loads(checked.stdout)}
    for what in ("camera", "camera's rate", "frames", "picture size"):
        print(what, rows.get(what))
    sees = rows["camera"]["verdict"] == "pass" and "camera's rate" in rows and "picture size" not in rows
    return 0 if sees else 1


if __name__ == "__main__":
    sys.exit(main())
