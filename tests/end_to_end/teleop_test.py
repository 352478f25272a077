#!/usr/bin/env python3
"""clearway-teleop on a pseudo-terminal: what keys ask for, what is shown, and how it ends.

Exit status 77 where what it needs is not built.
"""
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import termios
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from lcm_log import events, generate_types, type_named  # noqa: E402

SKIPPED = 77
PROGRAMS = pathlib.Path(os.environ.get("CLEARWAY_BIN", "absent"))
SOURCE = pathlib.Path(os.environ.get("CLEARWAY_SOURCE", "absent"))
TELEOP = PROGRAMS / "clearway-teleop"
SIMULATOR = PROGRAMS / "clearway-simulator"
URL = "udpm://239.255.76.69:7669"
DEADLINE_S = 60  # Sanitizers on a busy machine; awaited is what is seen, not the time.

SCENE = """<clearway version="1"><scene/></clearway>"""


class Driver:
    """clearway-teleop on a terminal of its own."""

    def __init__(self, *words):
        self.terminal, slave = pty.openpty()
        self.before = termios.tcgetattr(slave)
        self.slave = slave
        self.process = subprocess.Popen(
            [TELEOP, "--config", SOURCE / "config" / "default.xml", "--lcm-url", URL, *words],
            stdin=slave, stdout=slave, stderr=slave, start_new_session=True)
        self.text = ""

    def press(self, keys):
        os.write(self.terminal, keys.encode())

    def read(self, timeout_s):
        ready, _, _ = select.select([self.terminal], [], [], timeout_s)
        if ready:
            self.text += os.read(self.terminal, 65536).decode(errors="replace")

    def wait_for(self, pattern, press=None):
        """Until what is shown from now on has `pattern`; meanwhile `press` is held down."""
        begin = len(self.text)
        end = time.monotonic() + DEADLINE_S
        while not re.search(pattern, self.text[begin:]):
            if time.monotonic() > end:
                raise AssertionError(f"waited for {pattern!r}, there is:\n{self.text[begin:]!r}")
            if press:
                self.press(press)
            self.read(0.05)

    def wait(self):
        """Its exit status; what it writes is read meanwhile."""
        end = time.monotonic() + DEADLINE_S
        while self.process.poll() is None:
            self.read(0.05)
            if time.monotonic() > end:
                raise AssertionError(f"does not end, there is:\n{self.text!r}")
        return self.process.returncode

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        os.close(self.terminal)
        os.close(self.slave)


class TeleopTest(unittest.TestCase):
    def open(self, *words):
        driver = Driver(*words)
        self.addCleanup(driver.close)
        driver.wait_for(r"STOP: the permit has not come yet")
        return driver

    def check_restored(self, driver):
        self.assertEqual(termios.tcgetattr(driver.slave), driver.before)

    def test_shows_what_keys_ask_for_until_none_comes(self):
        driver = self.open()

        driver.press("w")
        driver.wait_for(r"wish 0\.20 m/s 0\.00 rad/s")
        driver.wait_for(r"wish 0\.00 m/s")  # By itself, when no key comes.
        driver.press("\x1b[A")
        driver.wait_for(r"wish 0\.20 m/s")
        driver.press(" ")
        driver.wait_for(r"wish 0\.00 m/s")
        driver.press("d")
        driver.wait_for(r"wish 0\.00 m/s -0\.30 rad/s")

    def test_q_ends_and_restores_the_terminal(self):
        driver = self.open()
        self.assertNotEqual(termios.tcgetattr(driver.slave), driver.before)

        driver.press("q")

        self.assertEqual(driver.wait(), 0)
        self.check_restored(driver)

    def test_signals_end_it_and_restore_the_terminal(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            with self.subTest(signal=number):
                driver = self.open()
                driver.press("w")

                driver.process.send_signal(number)

                self.assertEqual(driver.wait(), 0)
                self.check_restored(driver)

    def test_ctrl_z_does_not_stop_the_program(self):
        driver = self.open()

        driver.press("\x1a")
        driver.press("w")

        driver.wait_for(r"wish 0\.20 m/s")

    def test_refuses_what_is_no_terminal(self):
        done = subprocess.run(
            [TELEOP, "--config", SOURCE / "config" / "default.xml", "--lcm-url", URL],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            timeout=DEADLINE_S, check=False)

        self.assertEqual(done.returncode, 70)
        self.assertIn("standard input is no terminal", done.stderr)

    def test_a_terminal_that_goes_away_ends_it(self):
        driver = self.open()

        os.close(driver.terminal)
        os.close(driver.slave)
        driver.terminal, driver.slave = pty.openpty()  # For close().

        self.assertEqual(driver.process.wait(timeout=DEADLINE_S), 0)

    def test_drives_the_simulated_robot(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        folder = pathlib.Path(folder.name)
        generate_types(SOURCE, folder)
        (folder / "scene.xml").write_text(SCENE)
        self.start(folder, "lcm-logger", f"--lcm-url={URL}?ttl=0", "-f", folder / "events")
        self.start(folder, SIMULATOR, "--config", SOURCE / "config" / "default.xml",
                   "--lcm-url", URL, "--scene", folder / "scene.xml",
                   "--set", "simulator.robot.drive=request",
                   "--set", "simulator.robot.obey_permit=false")
        driver = self.open()

        end = time.monotonic() + DEADLINE_S
        while not any(speed == 1.0 for speed in self.speeds(folder)):
            self.assertLess(time.monotonic(), end, (folder / "log").read_text())
            driver.press("w")
            driver.read(0.15)
        driver.press("q")
        self.assertEqual(driver.wait(), 0)

        while self.speeds(folder)[-1] != 0.0:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)

    def start(self, folder, *words):
        with open(folder / "log", "a") as log:
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=log, stderr=log)

        def end():
            process.terminate()
            process.wait(timeout=30)
        self.addCleanup(end)

    @staticmethod
    def speeds(folder):
        """Of all ODOMETRY so far."""
        odometry = type_named("clearway.odometry_t")
        return [odometry.decode(data).v_mps for _, channel, data in events(folder / "events")
                if channel == "ODOMETRY"]


def main():
    for program in (TELEOP, SIMULATOR):
        if not program.exists():
            print(f"skipped: {program} is not built")
            return SKIPPED
    for program in ("lcm-logger", "lcm-gen"):
        if shutil.which(program) is None:
            print(f"skipped: {program} is not installed")
            return SKIPPED
    result = unittest.main(exit=False, verbosity=2).result
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
