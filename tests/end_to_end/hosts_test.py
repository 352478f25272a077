#!/usr/bin/env python3
"""tools/hosts: hosts come up as they should, and go without a trace however they end.

Exit status 77 where such hosts cannot be made.
"""
import os
import pathlib
import select
import signal
import subprocess
import sys
import tempfile
import unittest
import uuid

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from host_programs import (  # noqa: E402
    DEADLINE_S, HOSTS, PROGRAMS, Program, hosts, skip_where_there_are_no_namespaces)

NAMESPACES = pathlib.Path("/run/netns")

# Tells what it was given and on which host, and then does nothing until it is ended.
FAKE_DEPUTY = f"""#!{sys.executable}
import os, signal, sys
signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))
print(os.uname().nodename + ":", *sys.argv[1:], flush=True)
with open(os.environ["READY"], "w") as ready:
    ready.write("ready\\n")
signal.pause()
"""


class HostsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.state = self.folder / "state"
        # Names that nobody else has: what is left behind is found by them.
        token = uuid.uuid4().hex[:8]
        self.prefix = f"test-{token}"
        self.robot, self.laptop = f"r{token}", f"l{token}"

    def processes(self):
        """Those of the hosts, each with a file that is readable when it has ended."""
        found = {}
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit() or int(entry.name) == os.getpid():
                continue
            try:
                pidfd = os.pidfd_open(int(entry.name))
                words = (entry / "cmdline").read_bytes().decode(errors="replace")
            except OSError:
                continue
            if self.robot in words or self.laptop in words:
                found[pidfd] = words.replace("\0", " ")
                self.addCleanup(os.close, pidfd)
            else:
                os.close(pidfd)
        return found

    def expect_gone(self, processes):
        poll = select.poll()
        for pidfd in processes:
            poll.register(pidfd, select.POLLIN)
        left = dict(processes)
        while left:
            ended = poll.poll(1000 * DEADLINE_S)
            self.assertTrue(ended, f"still running: {left.values()}")
            for pidfd, _ in ended:
                poll.unregister(pidfd)
                del left[pidfd]
        self.assertEqual(list(self.processes().values()), [])
        self.assertEqual(self.namespaces(), [])

    def namespaces(self):
        if not NAMESPACES.exists():
            return []
        return sorted(entry.name for entry in NAMESPACES.iterdir()
                      if entry.name.startswith(self.prefix))

    def hosts(self, *words, env=None):
        return hosts("--state", self.state, *words, env={**os.environ, **(env or {})})

    def up(self, *words):
        self.addCleanup(self.hosts, "down")
        return self.hosts("--prefix", self.prefix, "up", *words, self.robot, self.laptop)

    def expect_success(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def start_run(self, command):
        """tools/hosts run, once its command has said something."""
        program = Program(HOSTS, "--prefix", self.prefix, "run", self.robot, self.laptop, "--",
                          "sh", "-c", command)
        self.addCleanup(program.end)
        self.assertEqual(program.next_line(), "running")
        return program

    def test_a_host_has_its_name_its_card_and_loopback(self):
        self.expect_success(self.up())

        script = "hostname; ip -brief address; ip route; cat /proc/sys/net/ipv4/ip_forward"
        said = self.expect_success(self.hosts("exec", self.laptop, "sh", "-c", script))

        self.assertEqual(said.splitlines()[0], self.laptop)
        self.assertRegex(said, r"lo +UNKNOWN +127\.0\.0\.1/8")
        self.assertRegex(said, r"eth0@\S+ +UP +10\.77\.0\.2/24")
        self.assertRegex(said, r"224\.0\.0\.0/4 dev eth0")

    def test_it_goes_up_and_down_and_leaves_nothing(self):
        self.expect_success(self.up())
        self.assertEqual(self.namespaces(), sorted(
            f"{self.prefix}-{name}" for name in ("hub", self.robot, self.laptop)))
        self.assertIn(f"{self.laptop} 10.77.0.2", self.expect_success(self.hosts("status")))
        started = self.processes()
        self.assertEqual(len(started), 1)  # The relay.

        again = self.up()
        self.assertNotEqual(again.returncode, 0)
        self.assertIn("up already", again.stderr)

        self.expect_success(self.hosts("down"))
        self.expect_gone(started)
        self.expect_success(self.hosts("down"))
        self.assertEqual(self.hosts("status").returncode, 1)

    def test_what_cannot_come_up_leaves_nothing(self):
        result = self.up("--relay", "--loss 7")

        self.assertNotEqual(result.returncode, 0)
        self.assertIn("expected a number in [0, 1]", result.stderr)
        self.expect_gone({})
        self.assertEqual(self.hosts("status").returncode, 1)
        # Nor is it in the way of another attempt.
        self.expect_success(self.up("--relay", f"--loss 0.5 --fault 'delay-ms 3 {self.robot}:*'"))
        said = self.expect_success(self.hosts("relay", "stats"))
        self.assertIn('"loss":0.5', said)
        self.assertIn('"delay_ms":3.0', said)

    def test_down_ends_only_what_it_started(self):
        self.expect_success(self.up())
        started = self.processes()
        self.expect_success(self.hosts("relay", "quit"))
        poll = select.poll()
        poll.register(next(iter(started)), select.POLLIN)
        self.assertTrue(poll.poll(1000 * DEADLINE_S))
        # As if the relay's number had gone to another process since.
        with subprocess.Popen(["sleep", "1000"]) as bystander:
            (self.state / "relay.pid").write_text(f"{bystander.pid} 1\n", encoding="utf-8")

            self.expect_success(self.hosts("down"))

            self.assertIsNone(bystander.poll())
            bystander.kill()
        self.expect_gone(started)

    def test_deputies_run_on_their_hosts_and_end_with_them(self):
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "clearway-relay").symlink_to(PROGRAMS / "clearway-relay")
        (programs / "clearway-deputy").write_text(FAKE_DEPUTY, encoding="utf-8")
        (programs / "clearway-deputy").chmod(0o755)
        self.expect_success(self.up())

        environment = {"CLEARWAY_BIN": str(programs), "READY": str(self.folder / "ready")}
        os.mkfifo(environment["READY"])

        self.expect_success(self.hosts("deputies", "--", "--extra", "word", env=environment))

        # Opened both ways, so that it never ends.
        with os.fdopen(os.open(environment["READY"], os.O_RDWR), encoding="utf-8") as ready:
            self.assertEqual([ready.readline() for _ in range(2)], ["ready\n"] * 2)
        started = self.processes()
        self.assertEqual(self.hosts("status").stdout.count(", deputy "), 2)
        again = self.hosts("deputies", self.robot, env=environment)
        self.assertIn("has a deputy already", again.stderr)
        self.expect_success(self.hosts("down"))
        self.expect_gone(started)
        for name in (self.robot, self.laptop):
            said = (self.state / f"{name}.deputy.log").read_text(encoding="utf-8")
            self.assertEqual(
                said.splitlines()[0],
                f"{name}: --id {name} --lcm-url udpm://239.255.76.67:7668?ttl=1 --allow-any "
                "--allow-root --extra word")
            self.assertIn("ended", said)

    def test_a_deputy_that_ends_at_once_is_told(self):
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "clearway-relay").symlink_to(PROGRAMS / "clearway-relay")
        (programs / "clearway-deputy").write_text("#!/bin/sh\necho no such option >&2\nexit 64\n",
                                                  encoding="utf-8")
        (programs / "clearway-deputy").chmod(0o755)
        self.expect_success(self.up())

        result = self.hosts("deputies", "--", "--typo", env={"CLEARWAY_BIN": str(programs)})

        self.assertEqual(result.returncode, 1)
        self.assertIn(f"the deputy of {self.robot} ended: no such option", result.stderr)
        self.expect_success(self.hosts("down"))

    def test_run_gives_back_what_the_command_does(self):
        result = hosts("--prefix", self.prefix, "run", self.robot, self.laptop, "--", "sh", "-c",
                       f'"{HOSTS}" exec {self.laptop} hostname; cat /proc/sys/kernel/hostname; '
                       "exit 7")

        self.assertEqual(result.returncode, 7, result.stderr)
        self.assertEqual(result.stdout.splitlines(), [self.laptop, os.uname().nodename])
        self.expect_gone({})

    def test_run_leaves_nothing_however_it_ends(self):
        for how in (signal.SIGTERM, signal.SIGKILL):
            with self.subTest(signal=how):
                program = self.start_run(f"echo running; cat; : {self.robot}")
                started = self.processes()
                # The script, unshare, the script inside, the relay and the command.
                self.assertGreaterEqual(len(started), 5, started.values())

                program.process.send_signal(how)

                self.expect_gone(started)

    def test_two_runs_with_the_same_names_do_not_meet(self):
        first = self.start_run("echo running; cat")
        second = self.start_run(f'echo running; "{HOSTS}" status; cat')

        self.assertIn(f"{self.robot} 10.77.0.1", second.next_line())
        for program in (first, second):
            program.tell("still there")
        self.assertIsNotNone(first.await_line(lambda line: line == "still there"))
        self.assertIsNotNone(second.await_line(lambda line: line == "still there"))

    def test_wrong_words_are_usage_errors(self):
        for words in ([], ["nonsense"], ["up"], ["up", "one"], ["up", "a", "a"], ["up", "A", "b"],
                      ["up", "hub", "b"], ["run", "a", "b"], ["run", "a", "b", "--"], ["--state"],
                      ["--nonsense", "up", "a", "b"], ["up", "sixteen-letters-x", "b"]):
            result = hosts(*words)

            self.assertEqual(result.returncode, 64, words)
            self.assertIn("--help", result.stderr)

    def test_without_root_it_says_so(self):
        result = subprocess.run(
            ["unshare", "--user", str(HOSTS), "--state", str(self.state), "up", "a", "b"],
            capture_output=True, text=True, check=False, timeout=DEADLINE_S)

        if "unshare failed" in result.stderr:
            self.skipTest("user namespaces are not allowed here")
        self.assertEqual(result.returncode, 1)
        self.assertIn("needs root", result.stderr)


if __name__ == "__main__":
    skip_where_there_are_no_namespaces()
    unittest.main()
