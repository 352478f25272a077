#!/usr/bin/env python3
"""tools/spy on a virtual display: it lists every channel of a running graph and decodes it.

Exit status 77 where what it needs is not installed.
"""
import os
import pathlib
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

SKIPPED = 77
ROOT = pathlib.Path(os.environ.get("CLEARWAY_SOURCE", pathlib.Path(__file__).parents[2]))
TYPES_JAR = pathlib.Path(os.environ.get("CLEARWAY_TYPES_JAR", "absent"))
PROGRAMS = pathlib.Path(os.environ.get("CLEARWAY_BIN", "absent"))
PICTURE = pathlib.Path(os.environ.get("CLEARWAY_SPY_PICTURE", "spy.png"))
LCM_JAR = pathlib.Path("/usr/share/java/lcm.jar")
DEADLINE_S = 120  # Sanitizers on a busy machine; awaited is the event, not the time.

# What a run of the graph puts on the bus.
TYPE_OF = {
    "LIDAR_POINTS": "lidar_points_t", "OBSTACLE_POINTS": "obstacle_points_t", "FLOOR": "floor_t",
    "DETECTIONS": "detections_t", "DRIVE_PERMIT": "drive_permit_t",
    "PREPROCESSOR_STATUS": "status_t", "CLUSTERER_STATUS": "status_t",
    "STOP_GUARD_STATUS": "status_t", "PLAY_STATUS": "status_t", "RUN_STATUS": "status_t",
    "PM_INFO": "deputy_info_t", "PM_ORDERS": "orders_t", "PM_OUTPUT": "output_t",
    "PM_DISCOVER": "discovery_t", "PM_HEALTH": "deputy_health_t"}


def what_is_missing():
    for program, package in (("Xvfb", "xvfb"), ("java", "default-jre"),
                             ("javac", "default-jdk-headless")):
        if shutil.which(program) is None:
            return f"{program} is not installed (package {package})"
    if not LCM_JAR.exists():
        return f"{LCM_JAR} is not there (package liblcm-java)"
    if not TYPES_JAR.exists():
        return f"{TYPES_JAR} is not built"
    return None


class Program:
    """A program that is ended with the test, and what it prints."""

    def __init__(self, *command, stdin=subprocess.DEVNULL, **options):
        self._queue = queue.Queue()
        self.process = subprocess.Popen(
            [str(word) for word in command], stdin=stdin, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, **options)
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self):
        for line in self.process.stdout:
            self._queue.put(line.rstrip("\n"))
        self._queue.put(None)

    def lines(self):
        """The lines as they come, until it ends or is too late."""
        end = time.monotonic() + DEADLINE_S
        while True:
            try:
                line = self._queue.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                return
            if line is None:
                return
            yield line

    def end(self):
        self.process.terminate()
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._reader.join()
        self.process.stdout.close()
        if self.process.stdin:
            self.process.stdin.close()


class Spy(Program):
    """tools/spy with TableWatcher, which tells what its windows show."""

    def __init__(self, folder, display):
        subprocess.run(["javac", "--release", "8", "-Xlint:-options", "-cp", str(LCM_JAR),
                        "-d", str(folder), str(ROOT / "tests/spy/TableWatcher.java")], check=True)
        super().__init__(ROOT / "tools/spy", "--types", TYPES_JAR, stdin=subprocess.PIPE,
                         env={**os.environ, "DISPLAY": display, "CLASSPATH": str(folder)})
        self.rows = {}      # Channel -> (type, messages, undecodable).
        self.windows = []   # Titles.
        self.said = []

    def wait_until(self, condition):
        """Whether condition() came true before the end."""
        for line in self.lines():
            word, *rest = line.split("\t")
            if word == "row":
                channel, type_name, messages, undecodable = rest
                self.rows[channel] = (type_name, int(messages), int(undecodable))
            elif word == "window":
                self.windows.append(rest[0])
            else:
                self.said.append(line)
            if condition():
                return True
        return False

    def open_window(self, channel):
        """Whether the window with the fields of a channel came up and showed some messages."""
        self.process.stdin.write(channel + "\n")
        self.process.stdin.flush()
        enough = self.messages(channel) + 100
        return self.wait_until(
            lambda: channel in self.windows and self.messages(channel) > enough)

    def messages(self, channel):
        return self.rows.get(channel, ("", 0, 0))[1]

    def __str__(self):
        return f"{self.rows}\n{self.windows}\n" + "\n".join(self.said)


class SpyTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def started(self, program):
        self.addCleanup(program.end)
        return program

    def start_display(self):
        # Without a socket in /tmp, which a display outside the namespace may be using.
        server = self.started(Program(
            "Xvfb", "-displayfd", "1", "-nolisten", "unix", "-nolisten", "tcp", "-listen", "local",
            "-screen", "0", "1000x800x24"))
        number = next((line for line in server.lines() if line.isdigit()), None)
        self.assertIsNotNone(number, "Xvfb did not start")
        return f":{number}"

    def start_spy(self, display):
        spy = self.started(Spy(self.folder, display))
        self.assertTrue(spy.wait_until(lambda: "Found 1 plugins" in spy.said), spy)
        return spy

    def start_graph(self):
        self.started(Program(PROGRAMS / "clearway-run", "--headless", "--config",
                             ROOT / "config/lab_standing.xml", "--output", self.folder / "run"))

    def take_picture(self, display):
        if shutil.which("import") is None:
            return
        PICTURE.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(["import", "-display", display, "-window", "root", str(PICTURE)],
                       check=True, timeout=60)

    def test_lists_and_decodes_every_channel_of_a_running_graph(self):
        types = list((ROOT / "lcmtypes").rglob("*.lcm"))
        display = self.start_display()
        spy = self.start_spy(display)

        self.start_graph()

        self.assertTrue(spy.wait_until(
            lambda: all(spy.messages(channel) > 0 for channel in TYPE_OF)), spy)
        self.assertGreater(len(types), 20)
        self.assertIn(f"Found {len(types)} LCM types", spy.said)
        # Every participant of the bus begins with a message that has no type.
        own = {channel: row for channel, row in spy.rows.items() if channel != "LCM_SELF_TEST"}
        self.assertEqual({channel: row[0] for channel, row in own.items()}, TYPE_OF, spy)
        self.assertEqual({row[2] for row in own.values()}, {0}, spy)
        # Not before this: lcm-spy counts a message that meets a half-opened window as undecodable.
        self.assertTrue(spy.open_window("LIDAR_POINTS"), spy)
        self.take_picture(display)


if __name__ == "__main__":
    missing = what_is_missing()
    if missing:
        print("skipped:", missing)
        sys.exit(SKIPPED)
    unittest.main()
