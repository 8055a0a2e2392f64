# SPDX-License-Identifier: MIT
"""Labels against the simulator's truth, and what a network makes of each. Called by label_choice.sh, which says how."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import hard_figures
import hard_rows

WORLDS = ("honest", "typical")
ERRORS = {"commanded": ("commanded_dps", "commanded_uncertainty_dps"),
          "corrected": ("corrected_dps", "corrected_uncertainty_dps"),
          "shaft": ("shaft_dps", "uncertainty_dps")}  # as hard_case names them
SMALLEST = "--nf 2 --nr 3 --seeds 1 --reference-seeds 1 --epochs 10 --preset paper".split()
LONGEST_S = 3600  # of one program: the machine may be busy


def arguments_of(words):
    parser = argparse.ArgumentParser(prog="label_choice.sh")
    parser.add_argument("programs", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true", help="one snake_case key a figure")
    parser.add_argument("--train", action="store_true", help="also a small study with each label")
    parser.add_argument("--rigs", type=int, default=5, metavar="N", help="rigs of each world (default 5)")
    parser.add_argument("--first-seed", type=int, default=6001, metavar="N", help="seeds from N on (default 6001)")
    return parser.parse_args(words)


def printed(*words, folder=None):
    words = [str(word) for word in words]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=LONGEST_S, cwd=folder)
    if done.returncode not in (0, 3):  # 3: recorded, but with losses
        raise RuntimeError(f"{' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def environment(index):
    return hard_rows.ENVIRONMENTS[index % len(hard_rows.ENVIRONMENTS)]


def cases_of(options, world):
    """What hard_case says of each rig's session."""
    def case(index):
        return json.loads(printed(options.programs / "hard_case", options.first_seed + index, environment(index), world))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(case, range(options.rigs)))


def figures_of(cases, label):
    """All valid frames of all sessions count alike."""
    kept = [case["labels"] for case in cases if not case["refusal"]]
    errors, uncertainties = ([value for one in kept for value in one[name]] for name in ERRORS[label])
    beyond = hard_figures.share(hard_figures.beyond_three(errors, uncertainties), len(errors))
    return {"label_rms_dps": hard_figures.rms(errors),
            "within_three_sigma_percent": None if beyond is None else 100 * (1 - beyond),
            "sigma_dps": hard_figures.quantile([value for value in uncertainties if value is not None], 0.5)}


def record(options, world, folder):
    for index in range(options.rigs):
        printed((options.programs / "thermorig").resolve(), "record", "--fast", "--plan", "quick", "-e", "garden",
                f"--simulated={options.first_seed + index}", "--world", world, "--json", folder=folder)


def fusion_rmse_dps(options, label, folder):
    """Median over the folds of a study: each recording is left out once."""
    printed((options.programs / "thermorig").resolve(), "evaluate", "--study", "recordings", "-o", label, *SMALLEST,
            "--label", label, "--accept-bad", "--json", folder=folder)
    results = [json.loads(file.read_text()) for file in (folder / label / "results").glob("*_fusion_*.json")]
    place = results[0]["estimators"].index("cnn-fusion")
    return statistics.median(result["evaluation"]["shaft_errors"][place]["rmse_dps"] for result in results)


def measure(options):
    """{(world, label): figures}."""
    figures = {}
    for world in WORLDS:
        cases = cases_of(options, world)
        for label in ERRORS:
            figures[world, label] = figures_of(cases, label)
        if not options.train:
            continue
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            record(options, world, folder)
            for label in ERRORS:
                figures[world, label]["fusion_rmse_dps"] = fusion_rmse_dps(options, label, folder)
    return figures


def text(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def print_table(figures, options):
    print(f"Simulated rigs in virtual time: {options.rigs} a world from seed {options.first_seed} on, plan paper.\n")
    trained = " fusion RMSE against the shaft, deg/s |" if options.train else ""
    print(f"| world | label | RMS, deg/s | within 3 sigma, % | median sigma, deg/s |{trained}")
    print("| --- | --- | ---: | ---: | ---: |" + (" ---: |" if options.train else ""))
    for (world, label), row in figures.items():
        rmse = f" {text(row['fusion_rmse_dps'], 2)} |" if options.train else ""
        print(f"| {world} | {label} | {text(row['label_rms_dps'], 3)} | "
              f"{text(row['within_three_sigma_percent'], 2)} | {text(row['sigma_dps'], 3)} |{rmse}")


def main(words):
    options = arguments_of(words)
    figures = measure(options)
    if options.json:
        print(json.dumps({f"{world}_{label}_{key}": value for (world, label), row in figures.items()
                          for key, value in row.items()}, indent=1))
    else:
        print_table(figures, options)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (RuntimeError, subprocess.SubprocessError) as error:
        sys.exit(f"label_choice: {error}")
