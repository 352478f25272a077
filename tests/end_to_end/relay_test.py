#!/usr/bin/env python3
"""clearway-relay between two hosts: what crosses, what is lost, late or double, and what it counts.

Exit status 77 where such hosts cannot be made.
"""
import hashlib
import itertools
import json
import os
import pathlib
import statistics
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from host_programs import (  # noqa: E402
    DEADLINE_S, HOSTS, LcmProbe, Program, hosts, skip_where_there_are_no_namespaces)

INSIDE = "CLEARWAY_RELAY_TEST"
MAX_FRAME_BYTES = 1514
ETHERNET_IP_UDP_BYTES = 14 + 20 + 8
LCM_SMALL_BYTES = 8


class RelayTest(unittest.TestCase):
    numbers = itertools.count()

    @classmethod
    def setUpClass(cls):
        cls.robot = LcmProbe("robot")
        cls.addClassCleanup(cls.robot.end)
        cls.laptop = LcmProbe("laptop")
        cls.addClassCleanup(cls.laptop.end)

    def setUp(self):
        self.channel = f"PROBE_{next(self.numbers)}"
        for line in ("loss 0", "duplicate 0", "delay-ms 0", "jitter-ms 0", "mend robot",
                     "mend laptop"):
            self.tell(line)

    def tell(self, line):
        result = hosts("relay", line)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def statistics(self):
        return json.loads(self.tell("stats"))

    def direction(self, start, end):
        return next(direction for direction in self.statistics()["directions"]
                    if (direction["from"], direction["to"]) == (start, end))

    def fence(self, sender, receiver):
        """Returns when all that `sender` has sent before has come or will never: order stays."""
        channel = f"PROBE_FENCE_{next(self.numbers)}"
        for _ in range(DEADLINE_S):
            sender.send(channel)
            if receiver.receive(lambda line: line.startswith(f"got {channel} "), timeout_s=1):
                return
        self.fail("nothing comes through")

    def carry(self, sender, receiver, **message):
        """Sends and gives back what came."""
        self.assertTrue(sender.send(self.channel, **message))
        self.fence(sender, receiver)
        return receiver.of(self.channel)

    def test_multicast_crosses_both_ways(self):
        for sender, receiver in ((self.robot, self.laptop), (self.laptop, self.robot)):
            self.channel += "X"

            came = self.carry(sender, receiver, count=100, interval_us=200)

            self.assertEqual([message[1] for message in came], list(range(100)))
            self.assertTrue(all(message[4] for message in came))

    def test_ttl_0_stays_on_its_host(self):
        inner = LcmProbe("robot", ttl=0)
        self.addCleanup(inner.end)

        self.carry(inner, self.robot, count=10)
        self.fence(self.robot, self.laptop)

        self.assertEqual(len(self.robot.of(self.channel)), 10)
        self.assertEqual(self.laptop.of(self.channel), [])

    def test_large_messages_survive_both_ways_at_once(self):
        count = 50
        self.robot.tell(f"send {self.channel} {count} 57000 5000")
        self.laptop.tell(f"send {self.channel}L {count} 57000 5000")
        for probe in (self.robot, self.laptop):
            self.assertTrue(probe.receive(lambda line: line.startswith("sent ")))
        self.fence(self.robot, self.laptop)
        self.fence(self.laptop, self.robot)

        came = self.laptop.of(self.channel) + self.robot.of(self.channel + "L")

        self.assertEqual([message[1:3] for message in came],
                         [(i, 57000) for i in range(count)] * 2)
        self.assertTrue(all(message[4] for message in came))

    def test_messages_that_lcm_splits_survive(self):
        came = self.carry(self.robot, self.laptop, count=20, num_bytes=120_000, interval_us=10_000)

        self.assertEqual(len(came), 20)
        self.assertTrue(all(message[4] for message in came))

    def test_tcp_with_segmentation_offload_survives(self):
        content_bytes = 20_000_000
        server = Program(HOSTS, "exec", "laptop", sys.executable, "-c", f"""
import hashlib, socket
listener = socket.create_server(("10.77.0.2", 7000))
print("listening", flush=True)
connection = listener.accept()[0]
digest = hashlib.sha256()
while data := connection.recv(1 << 20):
    digest.update(data)
print(digest.hexdigest(), flush=True)
""")
        self.addCleanup(server.end)
        self.assertEqual(server.next_line(), "listening")

        sent = hosts("exec", "robot", sys.executable, "-c", f"""
import socket
socket.create_connection(("10.77.0.2", 7000)).sendall(bytes(range(250)) * {content_bytes // 250})
""")

        self.assertEqual(sent.returncode, 0, sent.stderr)
        content = bytes(range(250)) * (content_bytes // 250)
        self.assertEqual(server.next_line(), hashlib.sha256(content).hexdigest())
        port = self.statistics()["ports"][0]
        self.assertGreater(port["in_other_bytes"], content_bytes)
        # Else there was no offload, and this has tested nothing.
        self.assertGreater(port["in_other_bytes"] / port["in_other_frames"], MAX_FRAME_BYTES)

    def test_two_percent_loss_loses_about_two_percent(self):
        rounds, per_round = 25, 200
        before = self.direction("robot", "laptop")["lost_frames"]
        self.tell("loss 0.02 robot:laptop")

        for _ in range(rounds):  # In rounds, so that no socket has to hold more than one of them.
            self.carry(self.robot, self.laptop, count=per_round, interval_us=50)

        lost = rounds * per_round - len(self.laptop.of(self.channel))
        # Of 5000 frames 100 +- 9.9 are lost; five times that is once in a million.
        self.assertTrue(50 <= lost <= 150, lost)
        # The relay knows of all of them; of the fences, too.
        self.assertGreaterEqual(self.direction("robot", "laptop")["lost_frames"] - before, lost)
        self.channel += "B"
        self.assertEqual(len(self.carry(self.laptop, self.robot, count=200, interval_us=50)), 200)

    def test_one_lost_frame_loses_a_large_message(self):
        self.tell("loss 0.02")

        # No more of them: what came of a damaged message takes up the kernel's memory for 30 s.
        came = self.carry(self.robot, self.laptop, count=40, num_bytes=57_000, interval_us=2000)

        # 39 frames each: 0.98 ** 39 = 45 % come whole; 18 +- 3.1.
        self.assertTrue(3 <= len(came) <= 33, len(came))
        self.assertTrue(all(message[4] for message in came))

    def test_delay_is_kept_in_its_direction(self):
        self.tell("delay-ms 5 robot:laptop")

        late = self.carry(self.robot, self.laptop, count=100, interval_us=500)
        self.channel += "B"
        prompt = self.carry(self.laptop, self.robot, count=100, interval_us=500)

        self.assertEqual([message[1] for message in late], list(range(100)))
        self.assertGreaterEqual(min(message[3] for message in late), 5000)
        self.assertLess(min(message[3] for message in prompt), 5000)
        print("one way, us: median", statistics.median(message[3] for message in prompt),
              "and with 5 ms of delay", statistics.median(message[3] for message in late))

    def test_jitter_keeps_the_order(self):
        self.tell("delay-ms 2")
        self.tell("jitter-ms 4")

        came = self.carry(self.robot, self.laptop, count=100, interval_us=1000)

        self.assertEqual([message[1] for message in came], list(range(100)))
        latencies_us = [message[3] for message in came]
        self.assertGreaterEqual(min(latencies_us), 2000)
        self.assertGreater(max(latencies_us) - min(latencies_us), 1000)

    def test_duplicates_arrive(self):
        self.tell("duplicate 1")

        came = self.carry(self.robot, self.laptop, count=50, interval_us=200)

        self.assertEqual([message[1] for message in came], [i // 2 for i in range(100)])

    def test_nothing_passes_a_cut_port_until_it_is_mended(self):
        self.tell("cut laptop")
        for sender, receiver, direction in (
                (self.robot, self.laptop, ("robot", "laptop")),
                (self.laptop, self.robot, ("laptop", "robot"))):
            self.tell("cut laptop")
            before = self.direction(*direction)["cut_frames"]
            self.assertTrue(sender.send(self.channel, count=5))
            # All five have come to the relay when it has counted them.
            for _ in range(10 * DEADLINE_S):
                if self.direction(*direction)["cut_frames"] >= before + 5:
                    break
            else:
                self.fail("the relay does not count what it cuts")

            self.tell("mend laptop")
            self.fence(sender, receiver)

            self.assertEqual(receiver.of(self.channel), [])
            self.channel += "B"

    def test_statistics_name_the_channel_and_its_rate(self):
        self.statistics()
        self.carry(self.robot, self.laptop, count=100, num_bytes=1000, interval_us=1000)
        self.assertTrue(self.robot.send(self.channel + "_LARGE", count=10, num_bytes=57_000))
        self.fence(self.robot, self.laptop)

        report = self.statistics()

        def entry(channel):
            return next(entry for entry in report["channels"]
                        if (entry["from"], entry["channel"]) == ("robot", channel))
        small, large = entry(self.channel), entry(self.channel + "_LARGE")
        num_bytes = 100 * (
            ETHERNET_IP_UDP_BYTES + LCM_SMALL_BYTES + len(self.channel) + 1 + 1000)
        self.assertEqual((small["messages"], small["frames"], small["bytes"]),
                         (100, 100, num_bytes))
        self.assertEqual((small["udp_port"], small["largest_message_bytes"]), (7667, 1000))
        self.assertAlmostEqual(small["mbit_per_s"], num_bytes * 8e-6 / report["interval_s"], 6)
        self.assertAlmostEqual(small["messages_per_s"], 100 / report["interval_s"], 6)
        self.assertEqual((large["messages"], large["frames"]), (10, 10 * 39))
        self.assertEqual(large["largest_message_bytes"], 57_000)
        self.assertGreater(large["bytes"], 570_000)
        again = next(entry for entry in self.statistics()["channels"]
                     if entry["channel"] == self.channel)
        self.assertEqual((again["messages"], again["mbit_per_s"]), (100, 0.0))

    def test_a_line_that_it_does_not_know_is_refused_and_changes_nothing(self):
        for line in ("nonsense", "loss", "loss 2", "loss nan", "cut nobody", "loss 0.5 robot:robot"):
            result = hosts("relay", line)

            self.assertNotEqual(result.returncode, 0, line)
            self.assertNotEqual(result.stderr, "", line)
        self.assertEqual(len(self.carry(self.robot, self.laptop, count=20)), 20)


if __name__ == "__main__":
    if INSIDE not in os.environ:
        skip_where_there_are_no_namespaces()
        os.environ[INSIDE] = "yes"
        os.environ.pop("CLEARWAY_HOSTS_STATE", None)
        os.execv(HOSTS, [str(HOSTS), "run", "robot", "laptop", "--", sys.executable, *sys.argv])
    unittest.main()
