#!/usr/bin/env python3
"""clearway-sheriff's full-screen view on a terminal, with a deputy: what keys do and what is seen.

Exit status 77 where what it needs is not installed or built.
"""
import fcntl
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest

SKIPPED = 77
PROGRAMS = pathlib.Path(os.environ.get("CLEARWAY_BIN", "absent"))
SHERIFF = PROGRAMS / "clearway-sheriff"
DEPUTY = PROGRAMS / "clearway-deputy"
URL = "udpm://239.255.76.68:7668?ttl=0"
DEADLINE_S = 60  # Sanitizers on a busy machine; awaited is what is seen, not the time.

ROBOT = r"""
group "sense" {
    cmd "lidar-driver" { exec = "sh -c 'echo driver says hello; exec sleep 1000'"; deputy = "rig"; }
    cmd "counter" { exec = "sh FOLDER/counter.sh"; deputy = "rig"; }
}
cmd "stop-guard" { exec = "sleep 2000"; deputy = "rig"; }
cmd "broken" { exec = "ls /does/not/exist"; deputy = "rig"; }
cmd "clock" { exec = "sh -c 'date +%s.%N >> FOLDER/started; exec sleep 1000'"; deputy = "rig"; }
cmd "flood" { exec = "yes what a terminal must not be stopped by"; deputy = "rig"; }
script "up" { start cmd "stop-guard" wait "running"; start cmd "lidar-driver" wait "running"; }
script "never" { stop cmd "stop-guard" wait "stopped"; wait ms 80000000; }
"""

COUNTER = r"""
i=0
while true; do
    i=$((i+1))
    printf '\033[32mtick %d\033[0m \377\033]0;evil\007\n' $i
    sleep 0.05
done
"""


def what_is_missing():
    if shutil.which("tmux") is None:
        return "tmux is not installed (package tmux)"
    for program in (SHERIFF, DEPUTY):
        if not program.exists():
            return f"{program} is not built"
    return None


def command_line(pid):
    """Of a process; empty where there is none."""
    try:
        text = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""
    return text


class Terminal:
    """A tmux server with one window, in which a program runs."""

    _count = 0

    def __init__(self, folder, *command):
        # A server that was told to end still holds its socket for a moment.
        Terminal._count += 1
        self._socket = folder / f"tmux{Terminal._count}"
        self.run("-f", "/dev/null", "new-session", "-d", "-x", 80, "-y", 24, *command)

    def run(self, *words, check=True):
        environment = {**os.environ, "LANG": "C.UTF-8", "LC_ALL": "C.UTF-8"}
        done = subprocess.run(["tmux", "-S", self._socket, *(str(word) for word in words)],
                              check=check, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, env=environment)
        return done.stdout

    def press(self, *keys):
        self.run("send-keys", *keys)

    def text(self):
        return self.run("capture-pane", "-p", check=False)

    def wait_for(self, pattern, absent=None):
        """What is on the screen as soon as it shows `pattern` and does not show `absent`."""
        end = time.monotonic() + DEADLINE_S
        while True:
            text = self.text()
            if re.search(pattern, text, re.M) and not (absent and re.search(absent, text, re.M)):
                return text
            if time.monotonic() > end:
                raise AssertionError(f"waited for {pattern!r} without {absent!r}, there is:\n{text}")
            time.sleep(0.02)

    def pid(self):
        return int(self.run("display-message", "-p", "#{pane_pid}"))

    def close(self):
        self.run("kill-server", check=False)


class SheriffTest(unittest.TestCase):
    """A deployment file and its deputy."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.robot = self.folder / "robot.pmd"
        self.robot.write_text(ROBOT.replace("FOLDER", str(self.folder)))
        (self.folder / "counter.sh").write_text(COUNTER)
        deputy = subprocess.Popen(
            [DEPUTY, "-i", "rig", "-u", URL, "--allow-any", "--allow-root"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def end():
            deputy.terminate()
            deputy.wait(timeout=30)
        self.addCleanup(end)


class ScreenTest(SheriffTest):
    def open(self, *words, **options):
        """A terminal that shows the view, in command unless it observes."""
        settings = [f"{name}={value}" for name, value in options.items()]
        terminal = Terminal(
            self.folder, "env", *settings, SHERIFF, self.robot, *words, "-u", URL)
        self.addCleanup(terminal.close)
        terminal.wait_for("observer|OBSERVER" if "observe" in words else "in command")
        terminal.wait_for("rig +heard")
        return terminal

    def select(self, terminal, name):
        terminal.press("/", *name, "Enter")
        terminal.wait_for(rf"^>.*\b{name}\b")

    def pid_of(self, text, name):
        return int(re.search(rf"{name} +Running +\d+ +(\d+)", text).group(1))

    def test_keys_start_restart_and_stop_a_command(self):
        terminal = self.open()
        self.select(terminal, "lidar-driver")

        terminal.press("s")
        text = terminal.wait_for(r"lidar-driver +Running +1 +\d+")
        first = self.pid_of(text, "lidar-driver")
        self.assertIn("sleep 1000", command_line(first))
        terminal.wait_for("driver says hello")
        terminal.press("r")
        text = terminal.wait_for(r"lidar-driver +Running +2 +\d+")
        second = self.pid_of(text, "lidar-driver")
        self.assertNotEqual(first, second)
        terminal.press("t")
        terminal.wait_for(r"lidar-driver +Stopped")

        self.assertEqual(command_line(first) + command_line(second), "")

    def test_asks_before_it_stops_a_group(self):
        terminal = self.open()
        self.select(terminal, "sense")
        terminal.press("s")
        terminal.wait_for("sense/ +2/2 ready")

        terminal.press("t")
        terminal.wait_for(r"Stop group sense \(2 commands, 2 running\)\? y/n")
        terminal.press("n")
        terminal.wait_for("sense/ +2/2 ready", absent="y/n")
        terminal.press("t", "y")

        terminal.wait_for("sense/ +0/2 ready")
        terminal.wait_for("lidar-driver +Stopped")

    def test_trouble_is_seen_at_once(self):
        terminal = self.open()
        self.select(terminal, "broken")

        terminal.press("s")

        text = terminal.wait_for(r"! broken +Failed")
        self.assertIn("1 IN TROUBLE", text.splitlines()[0])
        terminal.wait_for("cannot access '/does/not/exist'")

    def test_output_follows_pauses_and_is_clean(self):
        terminal = self.open()
        self.select(terminal, "counter")
        terminal.press("s")

        terminal.press("Enter")
        terminal.wait_for(r"follows$")
        text = terminal.wait_for(r"^tick 30 \ufffd$")
        self.assertNotIn("evil", text)
        terminal.press("PPage")
        paused = terminal.wait_for("WAITS")
        newest = re.findall(r"^tick (\d+)", paused, re.M)[-1]
        text = terminal.wait_for(r"WAITS: (3\d|[4-9]\d|\d{3,}) newer")
        self.assertEqual(re.findall(r"^tick (\d+)", text, re.M)[-1], newest)
        terminal.press("End")
        terminal.wait_for(r"follows$")
        terminal.press("q")

        terminal.wait_for("^   COMMAND")

    def test_runs_scripts_and_aborts_them(self):
        terminal = self.open()

        terminal.press("x")
        terminal.wait_for(" > up")
        terminal.press("Enter")
        terminal.wait_for("SCRIPT up is done")
        terminal.press("Down", "Enter")
        terminal.wait_for("SCRIPT never is running")
        terminal.press("q")
        text = terminal.wait_for("stop-guard +Stopped")
        self.assertIn("script never is running", text)
        self.assertRegex(text, r"lidar-driver +Running")
        terminal.press("q")
        terminal.wait_for("Script never is running and stops half-way. Quit. y/n")
        terminal.press("n", "x", "Escape")

        terminal.wait_for("SCRIPT never was ABORTED")

    def test_takes_the_room_there_is(self):
        terminal = self.open()

        for columns, rows in ((120, 40), (80, 24), (40, 10), (200, 60)):
            terminal.run("resize-window", "-x", columns, "-y", rows)
            pattern = "UP FOR" if columns >= 100 else "^   COMMAND"
            terminal.wait_for(pattern, absent="UP FOR" if columns < 100 else None)
            end = time.monotonic() + DEADLINE_S
            lines = []
            while time.monotonic() < end:
                lines = terminal.text().split("\n")[:rows]
                if len(lines) == rows and lines[rows - 1].startswith(" s start"):
                    break
            self.assertTrue(lines[rows - 1].startswith(" s start"), "\n".join(lines))
            self.assertTrue(lines[0].startswith(" "), "\n".join(lines))

    def test_states_are_told_without_colours(self):
        for setting in ({"TERM": "vt100"}, {"NO_COLOR": "1"}):
            with self.subTest(setting):
                terminal = self.open(**setting)
                self.select(terminal, "broken")
                terminal.press("s")
                terminal.wait_for("! broken +Failed")

                escapes = terminal.run("capture-pane", "-p", "-e")

                self.assertNotRegex(escapes, r"\x1b\[([0-9]+;)*3[0-7][;m]")
                terminal.close()

    def test_processes_outlive_the_terminal(self):
        terminal = self.open()
        self.select(terminal, "stop-guard")
        terminal.press("s")
        text = terminal.wait_for(r"stop-guard +Running +1 +\d+")
        pid = self.pid_of(text, "stop-guard")
        sheriff = terminal.pid()
        self.assertIn("clearway-sheriff", command_line(sheriff))

        terminal.close()

        end = time.monotonic() + DEADLINE_S
        while command_line(sheriff) and time.monotonic() < end:
            time.sleep(0.02)
        self.assertEqual(command_line(sheriff), "")
        self.assertIn("sleep 2000", command_line(pid))
        # And whoever comes next finds them.
        text = self.open().wait_for(r"stop-guard +Running +1 +\d+")
        self.assertEqual(self.pid_of(text, "stop-guard"), pid)

    def test_quits_to_the_shell_as_it_was(self):
        terminal = Terminal(self.folder, "sh")
        self.addCleanup(terminal.close)
        terminal.press(f"stty -a > {self.folder}/before; {SHERIFF} {self.robot} -u '{URL}';"
                       f" echo status $?; stty -a > {self.folder}/after; echo after", "Enter")
        terminal.wait_for("in command")
        self.select(terminal, "stop-guard")
        terminal.press("s")
        terminal.wait_for(r"stop-guard +Running")

        terminal.press("q")

        terminal.wait_for("1 of 6 commands go on running\nstatus 0\nafter")
        self.assertEqual((self.folder / "before").read_text(), (self.folder / "after").read_text())

    def test_observes_until_it_takes_command(self):
        first = self.open()
        other_folder = self.folder / "other"
        other_folder.mkdir()
        second = Terminal(other_folder, SHERIFF, self.robot, "observe", "-u", URL)
        self.addCleanup(second.close)
        second.wait_for("is in command")

        second.press("s")
        second.wait_for("Press c to take command")
        second.press("c")
        second.wait_for("gives orders. Take command from it. y/n")
        second.press("y")

        first.wait_for("ANOTHER SHERIFF IS ACTIVE")
        second.wait_for("ANOTHER SHERIFF IS ACTIVE")
        first.press("o", "y")
        first.wait_for("OBSERVER")
        second.wait_for("in command", absent="ANOTHER")
        second.press("G")  # No key of ours.
        second.press("s")
        second.wait_for("everything")
        second.wait_for("stop-guard +Running")

    def test_a_second_sheriff_gives_no_orders_unasked(self):
        self.open()
        other_folder = self.folder / "other"
        other_folder.mkdir()
        second = Terminal(other_folder, SHERIFF, self.robot, "-u", URL)
        self.addCleanup(second.close)

        second.wait_for("OBSERVER: no orders from here; sheriff .* is in command")


class RawTerminal:
    """A pseudo-terminal that nobody reads unless told."""

    def __init__(self, *command, columns=200, rows=60):
        self.pid, self.master = pty.fork()
        if self.pid == 0:
            os.environ["TERM"] = "xterm"
            os.execv(command[0], [str(word) for word in command])
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.seen = b""

    def read_until(self, pattern):
        end = time.monotonic() + DEADLINE_S
        while not re.search(pattern, self.seen):
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.master], [], [], left)[0]:
                raise AssertionError(f"waited for {pattern!r}, there was:\n{self.seen[-3000:]!r}")
            self.seen += os.read(self.master, 65536)

    def write(self, text):
        os.write(self.master, text.encode())

    def resize(self, columns, rows):
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def close(self):
        os.kill(self.pid, signal.SIGTERM)
        os.close(self.master)
        os.waitpid(self.pid, 0)


class RawTerminalTest(SheriffTest):
    """What no terminal program may come between."""

    def open_raw(self):
        terminal = RawTerminal(SHERIFF, self.robot, "-u", URL)
        self.addCleanup(terminal.close)
        terminal.read_until(rb"in command")
        terminal.read_until(rb"rig")
        return terminal

    def started(self):
        file = self.folder / "started"
        return [float(line) for line in file.read_text().split()] if file.exists() else []

    def wait_started(self, count):
        end = time.monotonic() + DEADLINE_S
        while len(self.started()) < count:
            self.assertLess(time.monotonic(), end, "was not started")
            time.sleep(0.001)
        return self.started()

    def test_a_terminal_that_is_stuck_stops_nothing(self):
        terminal = self.open_raw()
        terminal.write("/flood\r")
        terminal.write("s")
        terminal.write("\r")
        terminal.read_until(rb"must not be stopped")

        # Nothing is read from here on: each new size draws the whole screen.
        for i in range(400):
            terminal.resize(200 - i % 2, 60)
            time.sleep(0.005)
        terminal.write("q/clock\rs")

        self.wait_started(1)
        terminal.seen = b""
        terminal.write("q")
        terminal.read_until(rb"COMMAND|go on running|y/n")

    def test_from_key_to_process(self):
        terminal = self.open_raw()
        terminal.write("/clock\r")
        delays_ms = []
        for i in range(20):
            terminal.seen = b""
            begin = time.time()
            terminal.write("r")
            delays_ms.append((self.wait_started(i + 1)[i] - begin) * 1e3)
            while select.select([terminal.master], [], [], 0.3)[0]:
                os.read(terminal.master, 65536)
        # The first finds nothing to stop; a restart takes as long as the old run takes to end.
        print(f"from key to process: median {statistics.median(delays_ms):.1f} ms, "
              f"longest {max(delays_ms):.1f} ms", file=sys.stderr)
        self.assertLess(statistics.median(delays_ms), 1000)


if __name__ == "__main__":
    missing = what_is_missing()
    if missing:
        print("skipped:", missing)
        sys.exit(SKIPPED)
    unittest.main()
