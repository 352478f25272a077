#!/usr/bin/env python3
"""What must hold of the repository as a whole. Run by CTest, one class at a time."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(os.environ.get("CLEARWAY_SOURCE", pathlib.Path(__file__).parents[3]))

# These build first and then hand --help to a program, which is tested by itself.
BUILD_FIRST = {"run", "bench"}


def run(*command, **options):
    return subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, check=False, **options)


def check_layers(root):
    return run(sys.executable, ROOT / "tools" / "check_layers.py", "--root", root)


class LayersTest(unittest.TestCase):
    def test_the_repository_keeps_its_layers(self):
        result = check_layers(ROOT)

        self.assertEqual(result.returncode, 0, result.stdout)

    def expect_breach(self, path, include, message):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for top in ("common", "processes", "tools", "tests"):
                (root / top).mkdir()
            file = root / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("#pragma once\n", encoding="utf-8")
            self.assertEqual(check_layers(root).returncode, 0)
            file.write_text(f"#include {include}\n", encoding="utf-8")

            result = check_layers(root)

            self.assertEqual(result.returncode, 1, result.stdout)
            self.assertIn(f"{path}: {message}", result.stdout)

    def test_finds_core_that_includes_messages(self):
        self.expect_breach("common/core/a.hpp", '"common/messages/channels.hpp"',
                           "common/core may not include common/messages/channels.hpp")

    def test_finds_core_that_reads_a_clock(self):
        self.expect_breach("common/core/scan/a.cpp", "<chrono>", "core may not include <chrono>")

    def test_finds_a_process_that_includes_another(self):
        self.expect_breach("processes/clusterer/a.cpp", '"processes/stop_guard/main.hpp"',
                           "a process never includes another (stop_guard)")

    def test_finds_a_process_that_includes_a_tool(self):
        self.expect_breach("processes/clusterer/a.cpp", '"tools/play/player.hpp"',
                           "processes may not include tools/play/player.hpp")

    def test_finds_libraries_outside_their_folder(self):
        for path, include in (("common/process/a.cpp", "<tinyxml2.h>"),
                              ("common/io/a.cpp", "<lcm/lcm-cpp.hpp>"),
                              ("common/core/a.cpp", "<clearway/status_t.hpp>"),
                              ("common/io/a.cpp", "<pcl/point_types.h>"),
                              ("common/graph/a.cpp", "<spdlog/spdlog.h>"),
                              ("tools/play/a.cpp", "<cairo.h>")):
            with self.subTest(path=path, include=include):
                self.expect_breach(path, include, f"{include} may be included only below")


class FormatTest(unittest.TestCase):
    def test_every_cpp_file_is_formatted(self):
        if shutil.which("clang-format") is None:
            self.skipTest("clang-format is not installed")
        files = [file for top in ("common", "processes", "tools", "tests")
                 for pattern in ("*.cpp", "*.hpp") for file in sorted((ROOT / top).rglob(pattern))]
        self.assertGreater(len(files), 100)

        result = run("clang-format", "--dry-run", "--Werror", *files, cwd=ROOT)

        unformatted = sorted(set(re.findall(r"^([^\s:]+):\d+:\d+: error", result.stderr, re.M)))
        self.assertEqual(result.returncode, 0,
                         "run tools/dev format; these differ:\n" + "\n".join(unformatted))


class ScriptsTest(unittest.TestCase):
    def test_every_script_answers_help(self):
        scripts = [file for file in sorted((ROOT / "tools").iterdir())
                   if file.is_file() and os.access(file, os.X_OK)]
        self.assertLessEqual(BUILD_FIRST, {script.name for script in scripts})
        for script in scripts:
            if script.name in BUILD_FIRST:
                continue
            with self.subTest(script=script.name):
                result = run(script, "--help", cwd=ROOT, timeout=60)

                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertNotEqual(result.stdout.strip(), "")
                self.assertEqual(result.stderr, "")

    def test_every_shell_script_parses(self):
        for script in sorted((ROOT / "tools").iterdir()):
            if not script.is_file():
                continue
            text = script.read_text(encoding="utf-8")
            if "bash" in text.split("\n", 1)[0] or script.suffix == ".sh":
                with self.subTest(script=script.name):
                    result = run("bash", "-n", script)

                    self.assertEqual(result.returncode, 0, result.stderr)


class MessageTableTest(unittest.TestCase):
    """lcmtypes/README.md against common/messages/channels.hpp."""

    CHANNEL = re.compile(r'Channel<(?:procman_lcm::)?(\w+)>\s+\w+\{"(\w+)",\s*BusId::k(\w+)\}')

    def setUp(self):
        header = (ROOT / "common/messages/channels.hpp").read_text(encoding="utf-8")
        self.channels = {name: (bus.lower(), type_name)
                         for type_name, name, bus in self.CHANNEL.findall(header)}
        self.readme = (ROOT / "lcmtypes/README.md").read_text(encoding="utf-8")
        # | `NAME` ... | bus | `type` ... |; a row may be about several channels.
        self.rows = {}
        for line in self.readme.splitlines():
            cells = [cell.strip() for cell in line.split("|")]
            if len(cells) < 5 or not cells[1].startswith("`"):
                continue
            for name in re.findall(r"`([A-Z_]+)`", cells[1]):
                self.rows[name] = (cells[2], cells[3])

    def test_the_header_declares_nothing_that_this_check_overlooks(self):
        header = (ROOT / "common/messages/channels.hpp").read_text(encoding="utf-8")

        self.assertEqual(len(self.channels), header.count("inline constexpr Channel<"))
        self.assertGreater(len(self.channels), 20)

    def test_the_list_of_statuses_has_them_all(self):
        header = (ROOT / "common/messages/channels.hpp").read_text(encoding="utf-8")
        declared = re.findall(r"Channel<status_t> (\w+)\{", header)
        listed = re.search(r"kAllStatuses\{([^}]*)\}", header).group(1)

        self.assertEqual(re.findall(r"\w+", listed), declared)

    def test_every_channel_is_in_the_table_with_its_bus_and_type(self):
        for name, (bus, type_name) in self.channels.items():
            with self.subTest(channel=name):
                self.assertIn(name, self.rows)
                self.assertEqual(self.rows[name][0], bus)
                self.assertIn(f"`{type_name}`", self.rows[name][1].replace("procman_lcm.", ""))

    def test_the_table_names_no_channel_that_is_not_in_the_header(self):
        self.assertLessEqual(set(self.rows), set(self.channels))


if __name__ == "__main__":
    unittest.main()
