#!/usr/bin/env python3
"""Puts the figures of tools/map_study's cases together: tables on stdout, one JSON file.

map_study_report.py CASES OUTPUT.json, where CASES holds, for each case, NNN.case (set, error, dx_m,
dy_m, turn_deg and the options it was run with, line by line) and NNN.json of clearway-evaluate.
"map_filter" in OUTPUT.json holds the whole recording's cases with a map, each as clearway-evaluate
gives it, with the error it was given; the other sets are lists of the same kind.
"""
import json
import pathlib
import sys

TITLES = {
    "all": "map of the whole recording, judged on the same scans",
    "second_half_map_of_all": "map of the whole recording, judged on its second half",
    "second_half_map_of_first": "map of the first half, judged on the second half",
}
# Name, key, as text, whether the largest value is the worst one.
COLUMNS = [
    ("removal", "removal", lambda v: f"{100 * v:.1f}", False),
    ("in band", "removal_in_band", lambda v: f"{100 * v:.1f}", False),
    ("swallow", "swallow", lambda v: f"{100 * v:.1f}", True),
    ("found", "found", lambda v: f"{v:.4g}", False),
    ("detections", "detections_per_scan", lambda v: f"{v:.1f}", True),
]
KEYS = ("objects", "found", "centre_error_m", "detections_per_scan", "scans")


def unfiltered_row(figures):
    """The same keys as with a map, of a case without one."""
    row = {key: figures[key] for key in KEYS if key in figures}
    if "within_radius" in figures:
        row["objects"] = figures["within_radius"]["objects"]
        row["found"] = figures["within_radius"]["found"]
    return row


def read_rows(folder):
    for path in sorted(folder.glob("*.case")):
        name, error, dx_m, dy_m, turn_deg, *_ = path.read_text().splitlines()
        figures = json.loads(path.with_suffix(".json").read_text())
        if error == "no_map":
            row = unfiltered_row(figures)
        elif "map_filter" in figures:
            (row,) = figures["map_filter"]
        else:
            sys.exit(f"{path}: nothing was filtered; does POSE reach the preprocessor?")
        given = {"error": error, "dx_m": float(dx_m), "dy_m": float(dy_m)}
        given["turn_deg"] = float(turn_deg)
        yield name, {**given, **row}


def cell(rows, key, text, largest_is_worst):
    values = [row[key] for row in rows if key in row]
    if not values:
        return "-"
    mean = text(sum(values) / len(values))
    worst = text(max(values) if largest_is_worst else min(values))
    return mean if len(values) == 1 else f"{mean} / {worst}"


def print_table(title, rows):
    objects = next((row["objects"] for row in rows if "objects" in row), 0)
    print(f"\n{title}")
    print("percent of points; mean / worst of the directions; found within 0.3 m, of "
          f"{objects} objects; detections per scan")
    print(f"{'pose error':<12}" + "".join(f"{name:>16}" for name, *_ in COLUMNS))
    by_error = {}
    for row in rows:
        by_error.setdefault(row["error"], []).append(row)
    for error, group in by_error.items():
        label = "no map" if error == "no_map" else error
        print(f"{label:<12}" + "".join(f"{cell(group, *column[1:]):>16}" for column in COLUMNS))


def main():
    folder, output = map(pathlib.Path, sys.argv[1:])
    sets = {}
    for name, row in read_rows(folder):
        sets.setdefault(name, []).append(row)
    result = {}
    for name, rows in sets.items():
        print_table(TITLES.get(name, name.replace("_", " ") + " m"), rows)
        result["map_filter" if name == "all" else name] = [
            row for row in rows if row["error"] != "no_map"]
        result.setdefault("no_map", {}).update(
            {name: row for row in rows if row["error"] == "no_map"})
    output.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()
