#!/usr/bin/env python3
"""The systemd unit and what is installed beside it. Run by CTest with the configured unit."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(os.environ.get("CLEARWAY_SOURCE", pathlib.Path(__file__).parents[3]))
UNIT = pathlib.Path(os.environ["CLEARWAY_UNIT"])
BINDIR = os.environ["CLEARWAY_BINDIR"]  # Where the programs are installed.


def run(*command):
    return subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, check=False, timeout=60)


def settings_of(text):
    """Name -> values, in their order."""
    settings = {}
    for line in text.splitlines():
        name, equals, value = line.partition("=")
        if equals and not line.startswith("#"):
            settings.setdefault(name, []).append(value)
    return settings


class UnitTest(unittest.TestCase):
    def setUp(self):
        self.text = UNIT.read_text(encoding="utf-8")
        self.settings = settings_of(self.text)

    def test_runs_the_program_of_the_install_prefix(self):
        self.assertTrue(pathlib.PurePath(BINDIR).is_absolute())
        self.assertEqual(self.settings["ExecStart"],
                         [f"{BINDIR}/clearway-deputy --config /etc/clearway/deputy.xml"])

    def test_nothing_is_left_unconfigured(self):
        self.assertNotRegex(self.text, r"@\w+@")

    def test_waits_for_no_network(self):
        for name in ("After", "Wants", "Requires", "BindsTo"):
            for value in self.settings.get(name, []):
                self.assertNotIn("network", value)

    def test_children_may_still_be_real_time_and_use_devices(self):
        self.assertEqual(self.settings["LimitRTPRIO"], ["50"])
        for name in ("RestrictRealtime", "PrivateDevices", "DeviceAllow", "ProtectClock"):
            self.assertNotIn(name, self.settings)

    def test_stop_time_is_enough_for_the_shipped_deployments(self):
        for file in (ROOT / "procman").glob("*.pmd"):
            text = file.read_text(encoding="utf-8")
            times = [int(time) for time in re.findall(r"stop_time_allowed\s*=\s*(\d+)", text)]
            with self.subTest(file=file.name):
                self.assertEqual(len(times), len(re.findall(r'^\s*cmd\s+"', text, re.M)))
                self.assertLess(sum(times) + 10, int(self.settings["TimeoutStopSec"][0]))

    def test_systemd_has_nothing_to_say_against_it(self):
        if shutil.which("systemd-analyze") is None:
            self.skipTest("systemd-analyze is not installed")
        with tempfile.TemporaryDirectory() as folder:
            # The program need not be installed: one that is there stands in for it.
            program = pathlib.Path(folder) / "clearway-deputy"
            shutil.copy("/bin/true", program)
            unit = pathlib.Path(folder) / UNIT.name
            unit.write_text(self.text.replace(f"{BINDIR}/clearway-deputy", str(program)),
                            encoding="utf-8")

            result = run("systemd-analyze", "verify", "--man=no", unit)

            about_us = [line for line in result.stderr.splitlines() if UNIT.name in line]
            self.assertEqual(about_us, [])
            self.assertEqual(result.returncode, 0, result.stderr)


class FilesBesideItTest(unittest.TestCase):
    def test_systemd_takes_the_user(self):
        if shutil.which("systemd-sysusers") is None:
            self.skipTest("systemd-sysusers is not installed")
        with tempfile.TemporaryDirectory() as root:
            result = run("systemd-sysusers", "--dry-run", f"--root={root}",
                         ROOT / "procman/sysusers.d/clearway.conf")

            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("Creating user 'clearway'", result.stdout + result.stderr)

    def test_the_buffer_is_what_the_buses_ask_for(self):
        default = (ROOT / "common/process/buses_config.hpp").read_text(encoding="utf-8")
        asked = re.search(r"receive_buffer_bytes = (\d+)", default).group(1)
        text = (ROOT / "procman/sysctl.d/60-clearway.conf").read_text(encoding="utf-8")

        self.assertEqual(re.findall(r"^[^#].*", text, re.M), [f"net.core.rmem_max = {asked}"])


if __name__ == "__main__":
    unittest.main()
