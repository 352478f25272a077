#!/usr/bin/env python3
"""Checks the layers of clearway: which folder may include which, and which library where.

Exit status 1 when a rule is broken.
"""
import argparse
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent.parent

# Folder -> folders of ours that it may include, besides itself.
ALLOWED = {
    "common/core": [],
    "common/config": [],
    "common/messages": ["common/core"],
    "common/io": ["common/core"],
    "common/host": ["common/core"],
    "common/process": ["common/core", "common/messages"],
    "common/net": ["common/core", "common/host", "common/process"],
    "common/graph": ["common"],
    "processes": ["common"],
    "tools": ["common", "processes", "tools"],
    "tests": ["common", "processes", "tools", "tests"],
}

# Headers outside -> the only folders that may include them.
LIBRARIES = {
    r"<tinyxml2": ["common/config"],
    r"<lcm/lcm": ["common/process", "tests"],
    r"<lcm/eventlog": ["common/io/lcm_log"],
    r"<(clearway|procman_lcm)/": ["common/messages", "common/process", "common/graph", "processes",
                                  "tools", "tests"],
    r"<(pcl|flann)/": ["common/core/perception", "tests"],
    r"<spdlog": ["common/process/log"],
    r"<cairo": ["tools/plot", "tests/unit/plot"],
    r"<yaml-cpp": ["common/io/map"],
    r"<png": ["common/io/map", "tests/unit/io"],
    r"<zlib": ["common/core/mapping", "common/core/livox"],
    r"<n?curses": ["processes/procman_sheriff/screen"],
}

# What pure algorithms never touch.
FORBIDDEN_IN_CORE = [r"<iostream>", r"<chrono>", r"<thread>", r"<random>", r"<fstream>"]

INCLUDE = re.compile(r'^\s*#include\s+([<"][^>"]+[>"])', re.MULTILINE)


def layer_of(path: str) -> str:
    return max((layer for layer in ALLOWED if path.startswith(layer + "/")), key=len, default="")


def problems_of(path: str, text: str):
    layer = layer_of(path)
    for include in INCLUDE.findall(text):
        name = include.strip('<>"')
        if include.startswith('"'):
            allowed = [layer, *ALLOWED[layer]]
            if not any(name.startswith(a + "/") for a in allowed):
                yield f"{path}: {layer} may not include {name}"
        for pattern, places in LIBRARIES.items():
            if re.match(pattern, include) and not any(path.startswith(p) for p in places):
                yield f"{path}: {include} may be included only below {', '.join(places)}"
        if layer == "common/core" and any(re.match(p, include) for p in FORBIDDEN_IN_CORE):
            yield f"{path}: core may not include {include}"
    if path.startswith("processes/"):
        own = path.split("/")[1]
        for other in re.findall(r'"processes/([a-z_0-9]+)/', text):
            if other != own:
                yield f"{path}: a process never includes another ({other})"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=pathlib.Path, default=HERE, help="the checkout to look at")
    root = parser.parse_args().root
    problems = []
    for top in ("common", "processes", "tools", "tests"):
        for file in sorted((root / top).rglob("*.[ch]pp")):
            path = file.relative_to(root).as_posix()
            problems += problems_of(path, file.read_text(encoding="utf-8"))
    print("\n".join(problems) if problems else "layers hold")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
