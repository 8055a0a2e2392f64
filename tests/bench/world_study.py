# SPDX-License-Identifier: MIT
"""What networks and gyros make of the honest and of the typical world. Called by world_study.sh, which says how."""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

import label_choice

PRESETS = ("paper", "best")
SMALL = "--nf 2 --nr 3 --seeds 1 --reference-seeds 1 --accept-bad".split()


def arguments_of(words):
    parser = argparse.ArgumentParser(prog="world_study.sh")
    parser.add_argument("programs", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true", help="one snake_case key a figure")
    parser.add_argument("--rigs", type=int, default=8, metavar="N", help="rigs of each world (default 8)")
    parser.add_argument("--plan", default="quick", help="of the recordings (default quick)")
    parser.add_argument("--epochs", type=int, default=60, metavar="N", help="of each training (default 60)")
    parser.add_argument("--first-seed", type=int, default=6001, metavar="N", help="seeds from N on (default 6001)")
    return parser.parse_args(words)


def record(options, world, folder):
    """So many as are asked for: the check before a recording may refuse a rig of the typical world. Its seeds."""
    seeds, seed = [], options.first_seed
    while len(seeds) < options.rigs:
        try:
            label_choice.printed((options.programs / "thermorig").resolve(), "record", "--fast", "--plan", options.plan,
                                 "-e", "garden", f"--simulated={seed}", "--world", world, "--json", folder=folder)
            seeds.append(seed)
        except RuntimeError as error:
            if "exit code 9" not in str(error):
                raise
        seed += 1
    return seeds


def results_of(options, preset, folder):
    """Of the folds of a study, each of which leaves one recording out."""
    label_choice.printed((options.programs / "thermorig").resolve(), "evaluate", "--study", "recordings", "-o", preset,
                         "--preset", preset, "--epochs", options.epochs, *SMALL, "--json", folder=folder)
    return [json.loads(file.read_text()) for file in sorted((folder / preset / "results").glob("*.json"))]


def rmse_by_estimator(results):
    """{estimator: median over the folds of its RMSE against rate_shaft in deg/s}."""
    errors = {}
    for result in results:
        for name, of_shaft in zip(result["estimators"], result["evaluation"]["shaft_errors"], strict=True):
            errors.setdefault(name, []).append(of_shaft["rmse_dps"])
    told = {name: [value for value in values if value is not None] for name, values in errors.items()}
    return {name: statistics.median(values) if values else None for name, values in told.items()}


def measure(options):
    """{(world, preset): {estimator: RMSE}}."""
    figures = {}
    for world in label_choice.WORLDS:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            seeds = record(options, world, folder)
            print(f"{world}: seeds {', '.join(map(str, seeds))}", file=sys.stderr)
            for preset in PRESETS:
                figures[world, preset] = rmse_by_estimator(results_of(options, preset, folder))
    return figures


def print_table(figures, options):
    print(f"Simulated rigs in virtual time: {options.rigs} a world from seed {options.first_seed} on, plan "
          f"{options.plan}, garden, {options.epochs} epochs.\n")
    columns = [(world, preset) for world in label_choice.WORLDS for preset in PRESETS]
    print("| RMSE against `rate_shaft`, deg/s | " + " | ".join(f"{world}, `{preset}`" for world, preset in columns) + " |")
    print("| --- |" + " ---: |" * len(columns))
    for name in dict.fromkeys(name for column in columns for name in figures[column]):
        cells = [label_choice.text(figures[column].get(name), 2) for column in columns]
        print(f"| `{name}` | {' | '.join(cells)} |")


def main(words):
    options = arguments_of(words)
    figures = measure(options)
    if options.json:
        print(json.dumps({f"{world}_{preset}_{name.replace('-', '_')}_rmse_dps": value
                          for (world, preset), row in figures.items() for name, value in row.items()}, indent=1))
    else:
        print_table(figures, options)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (RuntimeError, subprocess.SubprocessError) as error:
        sys.exit(f"world_study: {error}")
