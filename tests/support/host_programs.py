"""For tests on hosts that are network namespaces (tools/hosts)."""
import os
import pathlib
import queue
import shutil
import subprocess
import sys
import threading
import time

SKIPPED = 77
ROOT = pathlib.Path(os.environ.get("CLEARWAY_SOURCE", pathlib.Path(__file__).parents[2]))
PROGRAMS = pathlib.Path(os.environ.get("CLEARWAY_BIN", ROOT / "build/release/bin"))
LCM_PROBE = os.environ.get("CLEARWAY_LCM_PROBE", str(ROOT / "build/release/tests/lcm_probe"))
HOSTS = ROOT / "tools/hosts"
DEADLINE_S = 60  # Sanitizers on a busy machine; awaited is the event, not the time.


def skip_where_there_are_no_namespaces():
    """Ends the test as skipped, and says why."""
    reason = None
    if os.geteuid() != 0:
        reason = "network namespaces for hosts need root"
    elif shutil.which("ip") is None:
        reason = "ip is not installed (package iproute2)"
    else:
        tried = subprocess.run(
            ["unshare", "--net", "--mount", "--uts", "--pid", "--fork", "--mount-proc", "sh", "-c",
             "ip link add name probe type veth peer name eborp && mount -t tmpfs tmpfs /tmp"],
            capture_output=True, text=True, check=False)
        if tried.returncode != 0:
            reason = f"namespaces cannot be made here: {tried.stderr.strip()}"
    if reason:
        print("skipped:", reason)
        sys.exit(SKIPPED)


def hosts(*words, **options):
    """Runs tools/hosts to its end."""
    return subprocess.run([str(HOSTS), *map(str, words)], capture_output=True, text=True,
                          check=False, timeout=DEADLINE_S, stdin=subprocess.DEVNULL, **options)


class Program:
    """A program that is ended with the test, its lines, and what it is told."""

    def __init__(self, *command, **options):
        self._queue = queue.Queue()
        self.process = subprocess.Popen(
            [str(word) for word in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            text=True, **options)
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self):
        for line in self.process.stdout:
            self._queue.put(line.rstrip("\n"))
        self._queue.put(None)

    def next_line(self, timeout_s=DEADLINE_S):
        """None at its end, or when it is too late."""
        try:
            return self._queue.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def await_line(self, condition, timeout_s=DEADLINE_S):
        """The first line that satisfies it; None when there was none in time."""
        end = time.monotonic() + timeout_s
        while (line := self.next_line(max(0.0, end - time.monotonic()))) is not None:
            if condition(line):
                return line
        return None

    def tell(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def end(self):
        self.process.terminate()
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._reader.join()
        self.process.stdout.close()
        self.process.stdin.close()


class LcmProbe(Program):
    """tests/support/lcm_probe.cpp on a host."""

    def __init__(self, host, ttl=1):
        super().__init__(
            HOSTS, "exec", host, LCM_PROBE,
            f"udpm://239.255.76.67:7667?ttl={ttl}&recv_buf_size=4194304")
        self.got = []  # (channel, sequence, bytes, latency_us, is_good)
        if self.await_line(lambda line: line == "ready") is None:
            raise RuntimeError(f"the probe on {host} did not start")

    def send(self, channel, count=1, num_bytes=100, interval_us=0):
        """Returns when all have been sent."""
        self.tell(f"send {channel} {count} {num_bytes} {interval_us}")
        return self.receive(lambda line: line == f"sent {channel} {count}")

    def receive(self, condition=lambda line: False, timeout_s=DEADLINE_S):
        """Takes in what comes until a line satisfies the condition; tells whether one did."""
        def take(line):
            word, *rest = line.split()
            if word == "got":
                self.got.append((rest[0], int(rest[1]), int(rest[2]), float(rest[3]),
                                 rest[4] == "good"))
            return condition(line)
        return self.await_line(take, timeout_s) is not None

    def of(self, channel):
        return [message for message in self.got if message[0] == channel]
