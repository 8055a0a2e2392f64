# SPDX-License-Identifier: MIT
"""Turns the JSON of `thermorig inspect` for Table I's sessions into the table. Used by table_one.sh."""
import json
import sys

paper = {"laboratory": 12114, "dining": 12130, "kitchen": 12124, "garden": 15193}
as_json, seconds = sys.argv[1] == "1", float(sys.argv[2])
sessions = json.load(sys.stdin)
sessions = sessions if isinstance(sessions, list) else [sessions]
swept = {name: sum(s["frames_swept"] for s in sessions if s["environment"] == name) for name in paper}
valid = {name: sum(s["frames_valid"] for s in sessions if s["environment"] == name) for name in paper}
total, asked = sum(swept.values()), sum(paper.values())
if as_json:
    print(json.dumps({"acquisitions": len(sessions), "seconds": round(seconds, 2), "swept_frames": total,
                      "valid_frames": sum(valid.values()), "paper_frames": asked,
                      "difference_percent": round(100 * (total / asked - 1), 3),
                      **{f"swept_{name}": count for name, count in swept.items()}}))
else:
    print("Table I on the simulated rig (virtual time)")
    print(f"{'environment':<12} {'swept frames':>12} {'valid':>7} {'paper, real':>12}")
    for name, count in swept.items():
        print(f"{name:<12} {count:>12} {valid[name]:>7} {paper[name]:>12}")
    print(f"{'all':<12} {total:>12} {sum(valid.values()):>7} {asked:>12}   {100 * (total / asked - 1):+.2f} %")
    print("SIMULATED:", *sorted({session["simulation"] for session in sessions}), sep="\n  ")
    print(f"{len(sessions)} acquisitions recorded in {seconds:.1f} s")
