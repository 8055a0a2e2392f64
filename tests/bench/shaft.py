# SPDX-License-Identifier: MIT
"""Labels of a shaft that is believed, and of one that is measured. Called by shaft.sh, which says how."""
import argparse
import concurrent.futures
import json
import math
import os
import statistics
import subprocess
import sys

WORLDS = {"typical": "typical",
          "backlash": "typical,servo.backlash_deg=2",
          "stick-slip": "typical,servo.stick_deg=2",
          "load": "typical,servo.load_deg=2",
          "weak supply": "typical,servo.supply_sag=0.4",
          "failed reads": "typical,encoder.failed_reads=0.05",
          "weak magnet": "typical,encoder.weak_magnet=1"}
SENSORS = {"believed": [], "as5600": ["--encoder"], "dynamixel": ["--servo", "dynamixel"], "grbl": ["--servo", "grbl"],
           "sts3215": ["--servo", "sts3215"]}
ONLY_AS5600 = ("failed reads", "weak magnet")
NOT_OF_A_STEPPER = ("stick-slip", "load", "weak supply")  # one that loses steps is not simulated
MOST_RMS_DPS = 0.13  # with an AS5600, in typical
MOST_OFF = 1.5       # of what is stated, either way
SLOW_DPS = 20.0
LEAST_SLOW_VALID = 0.8


def arguments_of(words):
    parser = argparse.ArgumentParser(prog="shaft.sh")
    parser.add_argument("program", help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true", help="one JSON object")
    parser.add_argument("--quick", action="store_true", help="one seed a row")
    parser.add_argument("--first-seed", type=int, default=6001, metavar="N", help="seeds from N on (default 6001)")
    parser.add_argument("--shafts", nargs="+", choices=SENSORS, default=list(SENSORS), help="these alone (default: all)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="sessions at a time")
    return parser.parse_args(words)


def run(program, world, sensor, seed):
    words = [program, str(seed), "laboratory", WORLDS[world], *SENSORS[sensor]]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def rms(values):
    return math.sqrt(statistics.fmean(value * value for value in values)) if values else math.nan


def figures(cases):
    labels = [case["labels"] for case in cases if not case["refusal"]]
    pairs = [pair for one in labels for pair in zip(one["shaft_dps"], one["uncertainty_dps"]) if None not in pair]
    errors, stated = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
    slow = [speed for case in cases if not case["refusal"] for speed in case["speeds"]
            if abs(abs(speed["rate_dps"]) - SLOW_DPS) < 0.01]
    return {"sessions": len(labels), "refused": len(cases) - len(labels),
            "unused": [case["shaft"]["why_not"] for case in cases if not case["refusal"] and case["shaft"]["why_not"]],
            "rms_dps": rms(errors), "stated_dps": rms(stated),
            "within_3_sigma": statistics.fmean(abs(e) <= 3 * s for e, s in pairs) if pairs else math.nan,
            "commanded_rms_dps": rms([e for one in labels for e in one["commanded_dps"]]),
            "commanded_stated_dps": rms([e for one in labels for e in one["commanded_uncertainty_dps"]]),
            "valid": len(pairs) / max(1, sum(one["frames"] for one in labels)),
            "slow_valid": sum(speed["valid"] for speed in slow) / max(1, sum(speed["frames"] for speed in slow))}


def missed(rows):
    for world, sensors in rows.items():
        for sensor, row in sensors.items():
            ratio = row["rms_dps"] / row["stated_dps"]
            if sensor not in ("believed", "grbl") and not 1 / MOST_OFF <= ratio <= MOST_OFF:
                yield f"{world}, {sensor}: off by {ratio:.2f} of what is stated"
            if sensor == "as5600" and row["unused"]:
                yield f"{world}: not used: {row['unused'][0]}"
    if "as5600" not in rows["typical"]:
        return
    typical, slip = rows["typical"]["as5600"], rows["stick-slip"]["as5600"]
    if not typical["rms_dps"] <= MOST_RMS_DPS:
        yield f"typical: {typical['rms_dps']:.3f} deg/s are more than {MOST_RMS_DPS}"
    if not slip["slow_valid"] >= LEAST_SLOW_VALID:
        yield f"stick-slip: {100 * slip['slow_valid']:.0f} % of the frames at {SLOW_DPS:g} deg/s are valid"


def main():
    options = arguments_of(sys.argv[1:])
    seeds = range(options.first_seed, options.first_seed + (1 if options.quick else 3))
    todo = [(world, sensor) for world in WORLDS for sensor in options.shafts
            if (sensor == "as5600" or world not in ONLY_AS5600) and (sensor != "grbl" or world not in NOT_OF_A_STEPPER)]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        cases = {key: [pool.submit(run, options.program, *key, seed) for seed in seeds] for key in todo}
        rows = {}
        for (world, sensor), futures in cases.items():
            rows.setdefault(world, {})[sensor] = figures([future.result() for future in futures])
    problems = list(missed(rows))
    if options.json:
        print(json.dumps({"simulated": True, "seeds": len(seeds), "rows": rows, "missed": problems}, indent=1))
        return 1 if problems else 0
    print(f"Simulated rigs in virtual time: {len(seeds)} a world from seed {options.first_seed} on, plan paper.\n")
    print("| world | shaft | RMS, deg/s | stated, deg/s | within 3 sigma, % | valid, % | at 20 deg/s, % | commanded: RMS | stated |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for world, sensors in rows.items():
        for sensor, row in sensors.items():
            print(f"| {world} | {sensor} | {row['rms_dps']:.3f} | {row['stated_dps']:.3f} | {100 * row['within_3_sigma']:.2f} | "
                  f"{100 * row['valid']:.1f} | {100 * row['slow_valid']:.0f} | {row['commanded_rms_dps']:.3f} | "
                  f"{row['commanded_stated_dps']:.3f} |")
    for problem in problems:
        print(f"missed: {problem}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
