# SPDX-License-Identifier: MIT
"""How what a script prints becomes the table of a document: LAYOUTS[name of the mark](what it printed), as Markdown.

What a layout gets is what the script prints with --json, read; where it is said, the text that it prints without. A mark
without a layout has a script that prints Markdown itself. A key that is missing is a KeyError: then the script has changed.
"""
import re

LAYOUTS = {}
OF_TEXT = set()  # layouts that get text


def layout(name, of_text=False):
    def keep(function):
        LAYOUTS[name] = function
        if of_text:
            OF_TEXT.add(name)
        return function
    return keep


def table(head, rows, numbers_from=1):
    """Markdown; the columns from numbers_from on are aligned to the right."""
    lines = [head, ["---" if column < numbers_from else "---:" for column in range(len(head))], *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def limits(rows):
    """Rows of (what, value or None, how it is shown, "<=" or ">=" or None, limit): a table that says what is met."""
    def verdict(value, sign, limit):
        if sign is None or value is None:
            return ""
        return "met" if (value <= limit if sign == "<=" else value >= limit) else "**not met**"
    return table(["figure", "measured", "must be", ""],
                 [[what, "not measured" if value is None else shown.format(value),
                   "" if sign is None else f"{sign} {shown.format(limit)}", verdict(value, sign, limit)]
                  for what, value, shown, sign, limit in rows])


@layout("fault_table")
def fault_table(both):
    figures = both["thermorig"]
    rows = [[line["fault"], f"{line['points']:,}", f"{line['clean']:,}", f"{line['loud']:,}", line["beyond"], line["silent"],
             f"{line['worst_loss_ms']:.0f}" if line["worst_loss_ms"] > 0 else ""] for line in figures["lines"]]
    most_ms = max(line["worst_loss_ms"] for line in figures["lines"])
    rows.append(["**all**", f"**{figures['points']:,}**", f"{figures['clean']:,}", f"{figures['loud']:,}",
                 f"**{figures['beyond']}**", f"**{figures['silent']}**", f"{most_ms:.0f}"])
    return (table(["fault", "points", "clean", "loud", "beyond", "silent", "lost at most, ms"], rows)
            + f"\n\n{figures['frames']} frames, {figures['calls']:,} calls; {figures['readings']:,} different disks, "
            f"{figures['recoveries']:,} of them\nrecovered to a session; {figures['took_s'] / 60:.0f} minutes.")


@layout("plain_hdf5")
def plain_hdf5(both):
    keys = ["points", "good", "needs_flag", "short", "silent", "unreadable"]
    return table(["plain HDF5", "points", "good", "flag", "short", "silent", "unreadable"],
                 [[f"{line['mode']}, {line['fault']}", *(line[key] for key in keys)] for line in both["plain_hdf5"]])


@layout("sync_cost")
def sync_cost(lines):
    return table(["`--sync`", "syncs/s", "sync, median and worst ms", "oldest byte when its sync ended, ms",
                  "append, median and 99 % us", "CPU, % of a core"],
                 [[line["sync"], f"{line['syncs_per_s']:.1f}", f"{line['sync_p50_ms']:.2f}, {line['sync_worst_ms']:.1f}",
                   f"{line['oldest_byte_ms']:.0f}", f"{line['append_p50_us']:.1f}, {line['append_p99_us']:.0f}",
                   f"{line['cpu_percent']:.1f}"] for line in lines])


@layout("coverage", of_text=True)
def coverage(text):
    rows = re.findall(r"^(\w+) +(\d+) +(\d+\.\d) %$", text, re.MULTILINE)
    return table(["module", "lines", "run"], [[module, f"{int(lines):,}", f"{run} %"] for module, lines, run in rows])


@layout("soak")
def soak(line):
    return table(["virtual time", "sessions", "finished", "a device did not come back", "refused before anything moved",
                  "memory, start to end", "file handles"],
                 [[f"{line['virtual_hours']:.0f} h", f"{line['sessions']:,}", f"{line['complete']:,}",
                   f"{line['device_lost']:,}", f"{line['refused']:,}",
                   f"{line['memory_mb_before']} -> {line['memory_mb_after']} MB",
                   f"{line['handles_before']} -> {line['handles_after']}"]])


@layout("drills")
def drills(figures):
    return table(["mishap", "command", "runs", "at rest after, at most"],
                 [[row["mishap"], row["command"], row["runs"], f"{row['rest_ms_max']:.0f} ms"] for row in figures["rows"]], 2)


@layout("fuzzers", of_text=True)
def fuzzers(text):
    rows = re.findall(r"^(\w+)_fuzzer: no finding in (\d+) s, (\d+) runs", text, re.MULTILINE)
    return table(["fuzzer", "seconds", "runs", "findings"],
                 [[name, seconds, f"{int(runs):,}", 0] for name, seconds, runs in sorted(rows)])


@layout("live_latency")
def live_latency(figures):
    return limits([
        ("from the chunk that completes a frame to its estimate, p99", figures["latency_p99_us"] / 1e3, "{:.2f} ms", "<=", 1.0),
        ("the same, median", figures["latency_p50_us"] / 1e3, "{:.2f} ms", None, None),
        ("the same, largest", figures["latency_max_us"] / 1e3, "{:.2f} ms", None, None),
        ("frames and samples dropped", figures["dropped_frames"] + figures["dropped_gyro_samples"], "{:.0f}", "<=", 0),
        ("memory after 1 h of virtual time", figures["resident_after_1_h_mb"], "{:.1f} MB", None, None),
        ("memory after 24 h", figures["resident_after_24_h_mb"], "{:.1f} MB", "<=",
         figures["resident_after_1_h_mb"] + 1.0)])


@layout("live_process")
def live_process(figures):
    return limits([
        ("the whole process, share of a core", figures["process_cpu_percent"], "{:.1f} %", "<=", 10.0),
        (f"frames and samples lost or dropped in {figures['seconds']:.0f} s", figures["lost"] + figures["dropped"], "{}",
         "<=", 0),
        ("memory after 10 s", figures["resident_begin_mb"], "{:.1f} MB", None, None),
        (f"memory after {figures['seconds'] + 10:.0f} s", figures["resident_end_mb"], "{:.1f} MB", None, None)])


@layout("live_page")
def live_page(figures):
    return limits([("the page's files, gzipped", figures["page_gzip_bytes"], "{:,} bytes", "<=", 100_000),
                   ("first paint, median of five loads", figures["first_paint_median_ms"], "{} ms", None, None),
                   ("first paint, greatest of five loads", figures["first_paint_max_ms"], "{} ms", "<=", 1000)])


@layout("network_speeds")
def network_speeds(figures):
    f = figures

    def times(key):
        return f"{f[key]:,.0f} us"

    def ratio(key, least=None):
        value = f[key]
        return [f"{value:.1f}", "", ""] if least is None else [
            f"{value:.1f}", f">= {least:g}", "met" if value >= least else "**not met**"]

    def share(key, least, name):
        part, peak = f[f"train_{key}_share_of_peak"], f[f"train_{key}_peak_gflops"]
        if part is None:
            return [f"multiply-add rate of a training step, {name}", "not measured", "", "", f">= {least}", ""]
        return [f"multiply-add rate of a training step, {name}", f"{part * peak:.0f} GFLOP/s",
                f"the core's peak, {peak:.0f} GFLOP/s", f"{part:.2f}", f">= {least}",
                "met" if part >= least else "**not met**"]

    rows = [
        ["inference, batch 1, fp32", times("ours_infer_us"), f"ONNX Runtime {times('onnx_runtime_infer_us')}",
         *ratio("infer_ratio_onnx_runtime", 1.5)],
        ["inference, batch 1, fp16 weights", times("ours_infer_fp16_us"), "the same",
         *ratio("infer_fp16_ratio_onnx_runtime", 1.9)],
        ["the same through onnxruntime-node", "", times("onnx_runtime_node_infer_us"), "", "", ""],
        ["inference, batch 1, fp32", times("ours_infer_us"), f"libtorch {times('libtorch_infer_us')}",
         *ratio("infer_ratio_libtorch", 3)],
        ["inference, batch 1, fp32", times("ours_infer_us"), f"PyTorch {times('pytorch_infer_us')}",
         *ratio("infer_ratio_pytorch")],
        ["training step, batch 32", times("ours_train_us"), f"PyTorch {times('pytorch_train_us')}",
         *ratio("train_ratio_pytorch", 3)],
        ["training step, batch 32", times("ours_train_us"), f"libtorch {times('libtorch_train_us')}",
         *ratio("train_ratio_libtorch", 2.5)],
        ["start-up with model load, processor time", f"{f['start_up_ms']:.0f} ms",
         f"ONNX Runtime {f['onnx_runtime_start_up_ms']:.0f} ms, libtorch {f['libtorch_start_up_ms']:.0f} ms", "", "<= 15 ms",
         "met" if f["start_up_ms"] <= 15 else "**not met**"],
        ["the same by the wall clock", f"{f['start_up_wall_ms']:.0f} ms",
         f"{f['onnx_runtime_start_up_wall_ms']:.0f} ms, {f['libtorch_start_up_wall_ms']:,.0f} ms", "", "", ""],
        ["allocations of an inference", f"{f['infer_allocations']:.0f}", "", "", "0",
         "met" if f["infer_allocations"] == 0 else "**not met**"],
        share("avx512", 0.8, "AVX-512"), share("avx2", 0.7, "AVX2")]
    return table(["what", "ours", "beside it", "ratio", "must be", ""], rows, 6)


@layout("network_differences")
def network_differences(figures):
    return limits([
        ("outputs to ONNX Runtime's on the exported file, 30 shapes", figures["onnx_runtime_output_difference"], "{:.1e}",
         "<=", 1e-5),
        ("outputs to PyTorch's, models trained and exported there, 30 shapes", figures["pytorch_export_output_difference"],
         "{:.1e}", "<=", 1e-5),
        ("gradients to PyTorch's, 45 trainings, three seeds each", figures["pytorch_gradient_difference"], "{:.1e}", "<=", 1e-4),
        ("loss path of 20 steps to PyTorch's, 45 trainings, median of three seeds", figures["pytorch_loss_path_difference"],
         "{:.1e}", "<=", 1e-4),
        (f"speeds with fp16 weights to fp32, both of `docs/models`, {figures['fp16_windows']:,} SIMULATED windows: fusion",
         figures["fp16_fusion_difference_dps"], "{:.3f} deg/s", "<=", 0.1),
        ("the same: thermal", figures["fp16_thermal_difference_dps"], "{:.3f} deg/s", "<=", 0.1)])


@layout("network_training")
def network_training(figures):
    return table(["one training, 40 epochs, one core", "seconds"], [
        ["51,561 windows, from the measured step", f"{figures['training_of_40_epochs_s']:.0f}"],
        ["really, `thermorig train --preset paper --threads 1`, 18 simulated acquisitions, reading included",
         f"{figures['real_training_of_40_epochs_s']:.0f}"]])


@layout("int8_cost")
def int8_cost(figures):
    def row(shape, name):
        thermal_only = name.endswith("thermal")
        rmse = "{fusion}{thermal:.2f} deg/s".format(
            fusion="" if thermal_only else f"{figures[name + '_fusion_rmse_dps']:.2f} / ",
            thermal=figures[name + "_thermal_rmse_dps"])
        fusion = "" if thermal_only else f"{figures[name + '_fusion_int8_mse_percent']:+.1f} %"
        return [shape, rmse, fusion, f"{figures[name + '_thermal_int8_mse_percent']:+.1f} %"]
    return table(["Nf, Nr", "RMSE float32, fusion / thermal", "MSE with int8, fusion", "MSE with int8, thermal"], [
        row("3, 1 (`docs/models/best.onnx`)", "best"), row("3, 2", "nf3_nr2"), row("3, 3", "nf3_nr3"),
        row("3, 1, thermal-only", "nf3_nr1_thermal")])


@layout("export_sizes", of_text=True)
def export_sizes(text):
    line = re.compile(r"^(Cortex\S+) +Nf 3, Nr (\d), (\w+) *: flash (\d+) B, RAM (\d+) B and (\d+) B of stack, "
                      r"(\d+) instructions", re.MULTILINE)
    cores = ["Cortex-M4F", "Cortex-M3", "Cortex-M0+"]
    rows = sorted(line.findall(text), key=lambda row: (cores.index(row[0]), row[2] == "float32", row[1]))
    return table(["core", "Nr", "weights", "flash", "RAM", "stack", "instructions a window"],
                 [[core, nr, weights, f"{int(flash):,}", f"{int(ram):,}", stack, f"{int(count) / 1e6:.1f} million"]
                  for core, nr, weights, flash, ram, stack, count in rows], 3)


@layout("thermal_likelihood")
def thermal_likelihood(figures):
    def value(section, scene, column, shown):
        return shown.format(figures[re.sub(r"[^a-zA-Z0-9]", "_", f"{section} {scene} {column}")]["value"])
    windows, sigma, bound = "Windows of three frames", "Stated sigma", "Beside the bound"
    return table(["scene", "MSE, 1e-6", "RMSE, deg/s", "median error, deg/s", "beyond 30 deg/s, %", "told, %",
                  "within 2 sigma", "bound, deg/s", "RMSE / bound"],
                 [[scene, value(windows, scene, "median MSE", "{:,.0f}"), value(windows, scene, "RMSE", "{:.1f}"),
                   value(windows, scene, "median error", "{:.2f}"), value(windows, scene, "beyond 30 deg/s", "{:.1f}"),
                   value(sigma, scene, "told", "{:.0f}"), value(sigma, scene, "within 2 sigma", "{:.2f}"),
                   value(bound, scene, "bound, median", "{:.2f}"), value(bound, scene, "RMSE / bound there", "{:.2f}")]
                  for scene in ("laboratory", "dining", "kitchen", "garden")])


def key_of(*words):
    return re.sub(r"[^a-z0-9]", "_", " ".join(words).lower())


def few_digits(value):
    """Three digits that count, no exponent."""
    return f"{value:,.0f}" if abs(value) >= 99.5 else f"{value:.3g}"


@layout("study_baselines")
def study_baselines(figures):
    columns = ["MSE", "RMSE, shaft", "beyond 30 deg/s", "within 1 sigma", "within 2 sigma", "drift", "angle", "drift, 30 s on",
               "angle, 30 s on", "worst, 30 s on", "trusted", "time"]
    def row(where, estimator):
        cells = [figures[key_of(where, estimator, column)]["value"] for column in columns]
        cells.append(figures[key_of("memory", estimator)]["value"])
        return [where.replace(" gyro", "").replace(" environments", " 18"), f"`{estimator}`", *map(few_digits, cells)]
    return table(["gyro", "estimator", "MSE, 1e-6", "RMSE, shaft, deg/s", "beyond 30 deg/s, %", "1 sigma", "2 sigma",
                  "drift, deg/min", "largest angle, deg", "drift from 30 s on", "largest angle from 30 s on", "of all",
                  "trusted, %", "us a frame", "kB"],
                 [row(f"{gyro} gyro, {where}", estimator) for gyro in ("raw", "calibrated")
                  for where in ("garden", "all environments")
                  for estimator in ("gyro", "gyro-rest", "gyro-kalman", "odometer", "thermal-likelihood")], 2)


@layout("map_table")
def map_table(figures):
    columns = ["recognised", "tracks after, median", "longest", "first angle, worst", "any angle, worst"]
    environments = ("laboratory", "dining", "kitchen", "garden")

    def row(shown, *key):
        return [shown, *(few_digits(figures[key_of(*key, column)]["value"]) for column in columns)]
    honest = [row(name, "same room", name) for name in (f"{environment}, {begin}" for environment in environments
                                                        for begin in ("from rest", "from 200 s on", "from 301 s on"))]
    typical = [row(f"{environment}, `typical`, all three", "same room, world typical, after calibrate lens", environment)
               for environment in environments]
    return table(["second session", "recognised, %", "tracks after, s", "longest, s", "first angle, worst, deg",
                  "any angle, worst, deg"], honest + typical)


@layout("export_odometer_angles")
def export_odometer_angles(figures):
    starts = {"in motion": "in_motion", "at rest": "at_rest"}

    def of_all(start, column, shown):
        median, most = (figures[f"All_of_them_{start}_{column}__{which}"]["value"] for which in ("median", "most"))
        return f"{median:{shown}}, {most:{shown}}"

    def of_each(start, column, shown):
        values = sorted(figure["value"] for key, figure in figures.items()
                        if key.startswith("Against") and key.endswith(f"__{start}_{column}") and figure["value"] is not None)
        return f"{values[len(values) // 2]:{shown}}, {values[-1]:{shown}}"
    rows = [("tracks after, s", of_all, "tracks_after", ".0f"),
            ("the product's odometer, s", of_each, "product__tracks_after", ".0f"),
            ("largest angle error since it tracks, from 30 s on, deg", of_all, "worst_angle", ".2f"),
            ("the product's odometer, deg", of_all, "product_s_worst_angle", ".2f"),
            ("spread about its mean, deg", of_each, "spread", ".2f"),
            ("drift, deg/min", of_each, "drift", ".3f"),
            ("largest distance of both odometers, deg", of_all, "from_the_product_s", ".2f")]
    return table(["median, worst", *(f"started {start}" for start in starts)],
                 [[name, *(of(start, column, shown) for start in starts.values())] for name, of, column, shown in rows])


def sections(text, *names):
    """Those of a report that has headings of the third level, in the order asked for."""
    parts = re.split(r"^### (.*)\n", re.sub(r"^\d+ of \d+ figures .*\n", "", text, flags=re.MULTILINE), flags=re.MULTILINE)
    found = dict(zip(parts[1::2], parts[2::2]))
    return "\n\n".join(f"### {name}\n\n{found[name].strip()}" for name in names)


@layout("odometer", of_text=True)
def odometer(text):
    return sections(text, "Honest world", "Honest world, all")


@layout("odometer_stresses", of_text=True)
def odometer_stresses(text):
    return sections(text, "Stresses")


@layout("odometer_hour", of_text=True)
def odometer_hour(text):
    return sections(text, "An hour")


@layout("odometer_typical", of_text=True)
def odometer_typical(text):
    return sections(text, "World typical", "World typical, all")


@layout("models")
def models(reports):
    def row(name, report):
        rmse = [f"{report['errors'][who]['rmse_dps']:,.2f}" for who in ("cnn-fusion", "cnn-thermal", "gyro", "gyro-rest")]
        gain = report["gain"]
        return [f"`{name}.onnx`", *rmse, f"{gain['mean']:.3f}" + (", collapsed" if gain["collapsed"] else "")]
    return table(["", "fusion", "its thermal part", "gyro", "gyro-rest", "mean Kg"],
                 [row(name, report) for name, report in reports.items()])


@layout("study_raw", of_text=True)
@layout("study_calibrated", of_text=True)
def study(report):
    """The report without its title, its headings below those of the page."""
    return re.sub(r"^## ", "### ", report.split("\n", 1)[1].strip(), flags=re.MULTILINE)
