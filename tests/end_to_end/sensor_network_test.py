#!/usr/bin/env python3
"""The driver and two emulated sensors on two hosts: true broadcasts, fixed ports, a sensor that dies.

The driver's host is this test's own network namespace (tools/in_namespace), the sensors' host is
another one, at the other end of a cable. Exit status 77 where such hosts cannot be made.
"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from lcm_log import events, generate_types, type_named  # noqa: E402

SKIPPED = 77
PROGRAMS = pathlib.Path(os.environ.get("CLEARWAY_BIN", "absent"))
SOURCE = pathlib.Path(os.environ.get("CLEARWAY_SOURCE", "absent"))
DRIVER = PROGRAMS / "clearway-livox-driver"
SIMULATOR = PROGRAMS / "clearway-simulator"
URL = "udpm://239.255.76.71:7671"
DEADLINE_S = 60  # Sanitizers on a busy machine; awaited is what is seen, not the time.
HOST = "192.168.1.50"
SENSORS = {"left": ("192.168.1.101", "3GGDJ6K00100101"),
           "right": ("192.168.1.102", "3GGDJ6K00100201")}

CONFIG = """<clearway version="1">
  <vehicle>
    <sensor name="left" x_m="0.2" y_m="0.2" z_m="0.35"/>
    <sensor name="right" x_m="0.2" y_m="-0.2" z_m="0.35"/>
  </vehicle>
  <livox_driver>
""" + "".join(f'    <lidar sensor="{name}" broadcast_code="{code}"/>\n'
              for name, (_, code) in SENSORS.items()) + """  </livox_driver>
  <simulator scene="scene.xml">
""" + "".join(f'    <mid70 sensor="{name}" ip="{ip}" broadcast_code="{code}" '
              'broadcast_to="255.255.255.255"/>\n'
              for name, (ip, code) in SENSORS.items()) + """  </simulator>
</clearway>
"""
SCENE = """<clearway version="1"><scene/></clearway>"""


def skip_without(reason):
    print("skipped:", reason)
    sys.exit(SKIPPED)


def run(*command):
    subprocess.run([str(word) for word in command], check=True, stdin=subprocess.DEVNULL)


class SensorNetworkTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "types").mkdir()
        generate_types(SOURCE, self.folder / "types")
        self.config = self.folder / "graph.xml"
        self.config.write_text(CONFIG, encoding="utf-8")
        (self.folder / "scene.xml").write_text(SCENE, encoding="utf-8")
        self.programs = []  # Those that must live.
        self.connect_hosts()

    def connect_hosts(self):
        """This host is 192.168.1.50; the sensors' one has both of theirs, and no other way out."""
        self.sensor_host = self.start(
            "unshare", "--net", "sh", "-c", "echo ready; exec cat",
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.sensor_host.stdout.readline()
        run("ip", "link", "add", "cable", "type", "veth", "peer", "name", "cable",
            "netns", self.sensor_host.pid)
        run("ip", "address", "add", f"{HOST}/24", "dev", "cable")
        run("ip", "link", "set", "cable", "up")
        there = ("nsenter", "--net", f"--target={self.sensor_host.pid}")
        for name in ("lo", "cable"):
            run(*there, "ip", "link", "set", name, "up")
        run(*there, "ip", "link", "set", "lo", "multicast", "on")
        run(*there, "ip", "route", "add", "224.0.0.0/4", "dev", "lo")
        for ip, _ in SENSORS.values():
            run(*there, "ip", "address", "add", f"{ip}/24", "dev", "cable")
        run(*there, "ip", "route", "add", "255.255.255.255", "dev", "cable")
        self.there = there

    def start(self, *command, **options):
        process = subprocess.Popen([str(word) for word in command], **options)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream:
                stream.close()

    def start_simulator(self):
        simulator = self.start(*self.there, SIMULATOR, "--config", self.config, "--lcm-url", URL)
        self.programs.append(simulator)
        return simulator

    def await_message(self, channel, type_name, condition, what):
        """The first message from now on that satisfies it."""
        from_us = time.time_ns() // 1000
        decode = type_named(type_name).decode
        end = time.monotonic() + DEADLINE_S
        while time.monotonic() < end:
            arrived = events(self.log) if self.log.exists() else ()
            for arrival_us, name, data in arrived:
                if name == channel and arrival_us >= from_us and condition(decode(data)):
                    return decode(data)
            for program in self.programs:
                self.assertIsNone(program.poll(), f"{program.args} has ended")
            time.sleep(0.1)  # A log is polled: it cannot be awaited.
        self.fail(f"no {channel} with {what}")

    def await_points(self):
        for name in SENSORS:
            self.await_message("LIDAR_POINTS", "clearway.lidar_points_t",
                               lambda slice_, name=name: slice_.sensor == name and slice_.shots,
                               f"points of {name}")

    def host_ports(self):
        """UDP ports that the driver holds."""
        table = pathlib.Path("/proc/net/udp").read_text(encoding="ascii").splitlines()[1:]
        ports = {int(line.split()[1].split(":")[1], 16) for line in table}
        return ports & {55000, *range(55500, 55600), *range(56000, 56100)}

    def test_sensors_are_heard_connected_and_heard_again(self):
        self.log = self.folder / "driver.lcmlog"
        self.start("lcm-logger", "-q", f"--lcm-url={URL}?ttl=0", "--flush-interval=20", self.log)
        driver_log = self.folder / "driver.txt"
        with open(driver_log, "wb") as output:
            driver = self.start(DRIVER, "--config", self.config, "--lcm-url", URL, stderr=output)
        self.programs.append(driver)
        simulator = self.start_simulator()

        self.await_points()
        told = driver_log.read_text(encoding="utf-8")
        for ip, code in SENSORS.values():
            self.assertIn(f"{code} at {ip}", told)
        ports = self.host_ports()
        self.assertEqual(ports, {55000, 55501, 56001})

        # As when their power fails: no goodbye.
        simulator.send_signal(signal.SIGKILL)
        simulator.wait()
        self.programs.remove(simulator)
        self.await_message("LIVOX_DRIVER_STATUS", "clearway.status_t",
                           lambda status: status.state != type(status).STATE_OK, "a complaint")
        self.start_simulator()
        self.await_points()

        self.assertEqual(self.host_ports(), ports)
        driver.send_signal(signal.SIGINT)
        self.assertEqual(driver.wait(DEADLINE_S), 0)


if __name__ == "__main__":
    for program in (DRIVER, SIMULATOR):
        if not program.exists():
            skip_without(f"{program} is not built")
    if os.geteuid() != 0:
        skip_without("hosts with a network of their own need root")
    probe = subprocess.run(["unshare", "--net", "true"], capture_output=True, check=False)
    if probe.returncode != 0:
        skip_without(f"network namespaces cannot be made here: {probe.stderr.decode().strip()}")
    unittest.main()
