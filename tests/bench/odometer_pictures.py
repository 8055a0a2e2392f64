# SPDX-License-Identifier: MIT
"""Draws docs/odometer_{map,innovations,errors}.png from what odometer_pictures prints. Usage: odometer_pictures.py FOLDER"""
import json
import pathlib
import sys

import matplotlib
import PIL.Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

TRACKING = 1
STARTING_COLOUR = "0.88"
BLUE, RED = "#1f5fa8", "#b5351c"
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 100})


def save(figure, path):
    figure.text(0.995, 0.995, "SIMULATED: kitchen, seed 7003", ha="right", va="top", fontsize=7, color="0.4")
    figure.savefig(path)
    plt.close(figure)
    PIL.Image.open(path).convert("RGB").quantize(96).save(path, optimize=True)  # a third of the bytes


def shade_start(axis, rows):
    begins = rows["time_s"][rows["state"] == TRACKING][0]
    axis.axvspan(0, begins, color=STARTING_COLOUR, lw=0)
    axis.text(begins / 2, 0.97, "starting", transform=axis.get_xaxis_transform(), ha="center", va="top", color="0.4")


def draw_map(data, path):
    maps = [np.array(one["temp_c"], float).reshape(24, -1) for one in data["maps"]]
    low, high = np.nanpercentile(maps[-1], [1, 99])
    figure, axes = plt.subplots(4, 1, figsize=(8, 6), gridspec_kw={"height_ratios": [1, 1, 1, 1]}, layout="constrained")
    for axis, image, one in zip(axes, maps, data["maps"]):
        shown = axis.imshow(image, extent=(0, 360, 24, 0), aspect="auto", cmap="inferno", vmin=low, vmax=high)
        axis.set_title(f"the map after {one['time_s']:.0f} s", loc="left", fontsize=9)
        axis.set_ylabel("row")
        axis.set_facecolor("0.85")
        axis.spines[["top", "right"]].set_visible(True)
    heading = data["maps"][-1]["heading_deg"] % 360
    for edge in (heading - 27.5, heading + 27.5):
        axes[2].axvline(edge % 360, color="white", lw=1.2)
    axes[2].set_xlabel("azimuth from the map's origin, deg; between the white lines: what the camera looks at")
    frame = np.array(data["newest_frame"], float).reshape(24, 32)
    if data["mirrored"]:
        frame = frame[:, ::-1]
    axes[3].imshow(frame, extent=(heading - 27.5, heading + 27.5, 24, 0), aspect="auto", cmap="inferno", vmin=low, vmax=high)
    axes[3].set_title("a frame at that time, as it came", loc="left", fontsize=9)
    axes[3].set_xlabel("azimuth, deg")
    axes[3].set_ylabel("row")
    figure.colorbar(shown, ax=axes, label="degC", fraction=0.03, pad=0.01)
    save(figure, path)


def draw_innovations(rows, path):
    known = (rows["state"] == TRACKING) & np.isfinite(rows["innovation_deg"])
    time, innovation, sigma = (rows[name][known] for name in ("time_s", "innovation_deg", "innovation_sigma_deg"))
    figure, (over, bars) = plt.subplots(1, 2, figsize=(8, 3), gridspec_kw={"width_ratios": [3, 1]}, layout="constrained")
    over.fill_between(time, -2 * sigma, 2 * sigma, color=RED, alpha=0.25, lw=0, label="2 sigma, as expected beforehand")
    over.plot(time, innovation, ".", ms=1.5, color=BLUE, label="innovation")
    over.set_xlabel("s")
    over.set_ylabel("deg")
    over.set_ylim(-2, 2)  # before a bare wall sigma is beyond that
    over.legend(loc="upper right", fontsize=8, markerscale=5)
    edges = np.linspace(-4, 4, 41)
    bars.hist(innovation / sigma, edges, density=True, color=BLUE)
    bars.plot(edges, np.exp(-edges**2 / 2) / np.sqrt(2 * np.pi), color=RED, label="normal")
    bars.set_xlabel("innovation / sigma")
    bars.legend(fontsize=8)
    save(figure, path)


def draw_errors(rows, path):
    known = rows["state"] == TRACKING
    first = np.flatnonzero(known)[0]
    error = rows["heading_deg"] - rows["shaft_deg"]
    error = error - error[first]
    gyro = rows["gyro_deg"] - rows["shaft_deg"]
    figure, (far, near) = plt.subplots(2, 1, figsize=(8, 5), sharex=True, layout="constrained")
    far.plot(rows["time_s"], gyro, color=RED, label="the same gyro, integrated")
    far.plot(rows["time_s"][known], error[known], color=BLUE, label="odometer")
    far.set_ylabel("heading error, deg")
    far.legend(loc="center right")
    shade_start(far, rows)
    near.fill_between(rows["time_s"][known], -2 * rows["heading_sigma_deg"][known], 2 * rows["heading_sigma_deg"][known],
                      color=BLUE, alpha=0.2, lw=0, label="2 sigma, as it says")
    near.plot(rows["time_s"][known], error[known], color=BLUE, lw=0.7, label="odometer, the same curve")
    near.set_ylim(-2, 2)
    near.set_xlabel("s")
    near.set_ylabel("heading error, deg")
    near.legend(loc="lower right")
    shade_start(near, rows)
    save(figure, path)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    data = json.load(sys.stdin)
    table = np.array(data["rows"], float)
    rows = {name: table[:, i] for i, name in enumerate(data["columns"])}
    draw_map(data, folder / "odometer_map.png")
    draw_innovations(rows, folder / "odometer_innovations.png")
    draw_errors(rows, folder / "odometer_errors.png")


main()
