# SPDX-License-Identifier: MIT
"""The table of raw_camera.sh: a row a kind of camera, of all seeds together."""
import argparse
import concurrent.futures
import json
import math
import os
import statistics
import subprocess
import sys

CAMERAS = {"text": "sketch, both halves merged", "half": "GY-MCU90640, half-fresh", "raw": "I2C-Stick, half-frames",
           "i2c": "I2C bus, half-frames"}
ENVIRONMENTS = ("laboratory", "dining", "kitchen", "garden")


def one(program, seed, world, camera):
    environment = ENVIRONMENTS[seed % len(ENVIRONMENTS)]
    run = subprocess.run([program, str(seed), environment, world, world, camera], capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{camera}, seed {seed}: {run.stderr.strip()}")
    return json.loads(run.stdout)


def root_mean_square(values):
    return math.sqrt(statistics.fmean(value * value for value in values)) if values else math.nan


def row(camera, cases):
    made = [case for case in cases if not case["refusal"]]
    of_all = {name: [value for case in made for value in case["labels"][name] if value is not None]
              for name in ("shaft_dps", "uncertainty_dps")}
    times = [case["times"]["camera"] for case in made]
    errors_ms = sorted(error for each in times for error in each["quantiles_ms"])
    samples = sum(each["samples"] for each in times)
    return {"camera": camera, "sessions": len(made), "refused": len(cases) - len(made),
            "valid_share": len(of_all["shaft_dps"]) / max(sum(case["labels"]["frames"] for case in made), 1),
            "label_rms_dps": root_mean_square(of_all["shaft_dps"]),
            "label_rms_by_seed_dps": [root_mean_square([v for v in case["labels"]["shaft_dps"] if v is not None])
                                      for case in made],
            "stated_rms_dps": root_mean_square(of_all["uncertainty_dps"]),
            "time_error_ms": {"median": statistics.median(errors_ms),
                              "95 %": errors_ms[int(0.95 * len(errors_ms))]} if errors_ms else None,
            "outside_share": sum(each["outside"] for each in times) / max(samples, 1),
            "width_ms": statistics.median(each["median_width_ms"] for each in times) if times else None}


def main():
    parser = argparse.ArgumentParser(prog="raw_camera.sh")
    parser.add_argument("program", help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true", help="a JSON list, an object a kind of camera")
    parser.add_argument("--quick", action="store_true", help="2 seeds")
    parser.add_argument("--seeds", type=int, default=10, metavar="N", help="of each kind of camera (default 10)")
    parser.add_argument("--first-seed", type=int, default=1, metavar="N", help="seeds from N on (default 1)")
    parser.add_argument("--world", default="typical", metavar="NAME", help="of docs/worlds.md (default typical)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="sessions at a time")
    options = parser.parse_args()
    seeds = range(options.first_seed, options.first_seed + (2 if options.quick else options.seeds))
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        cases = {camera: [pool.submit(one, options.program, seed, options.world, camera) for seed in seeds]
                 for camera in CAMERAS}
        rows = [row(camera, [case.result() for case in of_camera]) for camera, of_camera in cases.items()]
    if options.json:
        print(json.dumps(rows))
        return
    print(f"world {options.world}, {len(seeds)} seeds; labels against the shaft's true speed, times against the exposure\n")
    print(f"{'camera':28} {'sessions':>8} {'valid':>6} {'label RMS':>10} {'stated':>7} {'time error':>16} {'outside':>8} "
          f"{'bounds':>8}")
    for each in rows:
        error = each["time_error_ms"] or {"median": math.nan, "95 %": math.nan}
        width = each["width_ms"] if each["width_ms"] is not None else math.nan
        print(f"{CAMERAS[each['camera']]:28} {each['sessions']:>8} {100 * each['valid_share']:>5.1f}% "
              f"{each['label_rms_dps']:>6.3f} d/s {each['stated_rms_dps']:>7.3f} {error['median']:>5.2f}, {error['95 %']:>5.2f} ms "
              f"{100 * each['outside_share']:>7.2f}% {width:>5.2f} ms")


if __name__ == "__main__":
    main()
