# SPDX-License-Identifier: MIT
"""Called by figures.sh for each of its figures: NAME DOCUMENT COMMIT EXIT_CODE FILE, where FILE is what the script printed.

A layout makes Markdown of what a script prints: of its JSON, or of its text where that is said. Without a layout the script
prints Markdown itself. A key that is missing is a KeyError: then the script has changed.
"""
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from wrap_documents import wrapped

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
def fault_table(figures):
    """One row each place and kind of fault: "recording: EIO at one call, then power lost" is one of "recording: EIO"."""
    rows = {}
    for line in figures["lines"]:
        place, _, fault = line["fault"].partition(": ")
        name = place if place.startswith("power") or not fault else f"{place}: {re.split(r' (?:at|from) |, then', fault)[0]}"
        row = rows.setdefault(name, [0, 0, 0, 0, 0, 0.0])
        for column, key in enumerate(("points", "clean", "loud", "beyond", "silent")):
            row[column] += line[key]
        row[5] = max(row[5], line["worst_loss_ms"])
    rows["**all**"] = [figures["points"], figures["clean"], figures["loud"], figures["beyond"], figures["silent"],
                       max(row[5] for row in rows.values())]
    return (table(["fault", "points", "clean", "loud", "beyond", "silent", "lost at most, ms"],
                  [[name, *(f"{count:,}" for count in row[:5]), f"{row[5]:.0f}" if row[5] > 0 else ""]
                   for name, row in rows.items()])
            + f"\n\n{figures['frames']} frames, {figures['calls']:,} calls; {figures['readings']:,} different disks, "
            f"{figures['recoveries']:,} of them\nrecovered to a session; {figures['took_s'] / 60:.0f} minutes.")


@layout("sync_cost")
def sync_cost(lines):
    return table(["`--sync`", "syncs/s", "sync, median and worst ms", "oldest byte when its sync ended, ms",
                  "append, median and 99 % us", "CPU, % of a core"],
                 [[line["sync"], f"{line['syncs_per_s']:.1f}", f"{line['sync_p50_ms']:.2f}, {line['sync_worst_ms']:.1f}",
                   f"{line['oldest_byte_ms']:.0f}", f"{line['append_p50_us']:.1f}, {line['append_p99_us']:.0f}",
                   f"{line['cpu_percent']:.1f}"] for line in lines])


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
        ("the same of networks that scale each window, from degrees to deg/s",
         figures["onnx_runtime_difference_from_degrees"], "{:.1e}", "<=", 1e-5),
        ("outputs to PyTorch's, models trained and exported there, 30 shapes", figures["pytorch_export_output_difference"],
         "{:.1e}", "<=", 1e-5),
        ("gradients to PyTorch's, 45 trainings, three seeds each", figures["pytorch_gradient_difference"], "{:.1e}", "<=", 1e-4),
        ("loss path of 20 steps to PyTorch's, 45 trainings, median of three seeds", figures["pytorch_loss_path_difference"],
         "{:.1e}", "<=", 1e-4),
        (f"speeds with fp16 weights to fp32, both of `docs/models`, {figures['fp16_windows']:,} SIMULATED windows: fusion",
         figures["fp16_fusion_difference_dps"], "{:.3f} deg/s", "<=", 0.1),
        ("the same: thermal", figures["fp16_thermal_difference_dps"], "{:.3f} deg/s", "<=", 0.1)])


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


@layout("models")
def models(reports):
    def row(name, report):
        rmse = [f"{report['errors'][who]['rmse_dps']:,.2f}" for who in ("cnn-fusion", "cnn-thermal", "gyro", "gyro-rest")]
        gain = report["gain"]
        return [f"`{name}.onnx`", *rmse, f"{gain['mean']:.3f}" + (", collapsed" if gain["collapsed"] else "")]
    return table(["", "fusion", "its thermal part", "gyro", "gyro-rest", "mean Kg"],
                 [row(name, report) for name, report in reports.items()])


def sections_of(text, wanted, heading="##"):
    """Of a report those sections whose titles begin so, each to the end of its first table."""
    parts = [part for part in re.split(rf"^{heading} ", text, flags=re.MULTILINE)[1:] if part.startswith(wanted)]
    return "\n\n".join("### " + re.match(r"(?s).*?^\|.*?(?=\n\n|\Z)", part, re.MULTILINE)[0] for part in parts)


@layout("study_raw", of_text=True)
def study_raw(report):
    return sections_of(report, ("Frames of a window", "Resolution", "Claims of the paper"))


@layout("study_calibrated", of_text=True)
def study_calibrated(report):
    return sections_of(report, ("Resolution", "Claims of the paper"))


@layout("timing", of_text=True)
def timing(text):
    """Of loaded computers, as idle ones are easier, and of all servos together. The last line tells what is not met."""
    text = re.sub(r"^\| (\S+ over \S+, idle|calibrated, \S+) \|.*\n", "", text, flags=re.MULTILINE)
    begin, last = text.strip().split("\n\n", 1)[0], text.strip().rsplit("\n\n", 1)[1]
    kept = ("The servo's clock", "Camera against gyro", "Calibration of the scale", "Labels",
            "Sample times: error RMS")
    return "\n\n".join([begin, sections_of(text, kept, "###"), last])


def body_of(name, printed):
    """The Markdown of a table. Throws ValueError or KeyError where the script printed something else."""
    if name in LAYOUTS:
        body = LAYOUTS[name](printed if name in OF_TEXT else json.loads(printed))
    else:
        body = printed
    if "\n| ---" not in body or re.search(r"---:? \|$", body.rstrip()):
        raise ValueError("it printed no table")
    return wrapped(body).strip()


def main(name, document, commit, code, path):
    """A script ends with 1 also where a figure does not meet what it must: the table then says so, and is as good as any."""
    page = ROOT / document
    text, printed = page.read_text(encoding="utf-8"), pathlib.Path(path).read_text(encoding="utf-8")
    mark = re.search(rf"<!-- (table|figures) {name}, commit [0-9a-f]+ -->\n", text)
    if mark is None:
        return f"{document} has no mark of {name}"
    if code not in ("0", "1"):
        return f"{document}: {name}: left as it was, exit code {code}"
    remark = " (exit code 1: a figure is not what it must be)" if code == "1" else ""
    begin = f"<!-- {mark[1]} {name}, commit {commit} -->\n"
    if mark[1] == "figures":
        page.write_text(text[:mark.start()] + begin + text[mark.end():], encoding="utf-8")
        print(f"{document}: {name}: correct the sentences below its mark by build/figures/{name}.txt{remark}")
        return None
    try:
        end = text.index(f"<!-- end of table {name} -->", mark.end())
        body = body_of(name, printed)
    except (ValueError, KeyError) as error:
        return f"{document}: {name}: left as it was: {error!r}; see build/figures/{name}.txt"
    page.write_text(f"{text[:mark.start()]}{begin}\n{body}\n\n{text[end:]}", encoding="utf-8")
    print(f"{document}: {name}: written{remark}")
    return None


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
