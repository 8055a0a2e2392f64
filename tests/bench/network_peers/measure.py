# SPDX-License-Identifier: MIT
"""Lets our network and its peers run in turn on one core and compares medians. Called by network_peers.sh.

    measure.py BIN_FOLDER LIBONNXRUNTIME NODE_MODULES [--json] [--quick] [--model MODEL.onnx]... [--sessions SESSION.h5...]
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
INTEROP = HERE.parents[1] / "interop"
WARM = {"infer": (20, 10), "infer_fp16": (20, 10), "train": (10, 1)}
ROUND = {"infer": (60, 10), "infer_fp16": (60, 10), "train": (40, 1)}
STARTS = 31
DIFFERENCE_LIMITS = {"onnx_runtime_output_difference": 1e-5, "onnx_runtime_difference_from_degrees": 1e-5,
                     "pytorch_gradient_difference": 1e-4,
                     "pytorch_loss_path_difference": 1e-4, "pytorch_export_output_difference": 1e-5,
                     "model_file_weight_difference": 0.0}


class Worker:
    """A process that answers "task groups calls" (worker.h)."""

    def __init__(self, *command):
        self.process = subprocess.Popen([str(part) for part in command], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)

    def ask(self, task, groups, calls):
        self.process.stdin.write(f"{task} {groups} {calls}\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def libraries(self):
        return pathlib.Path(f"/proc/{self.process.pid}/maps").read_text()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def require_openblas(worker):
    """Debian's default is the reference BLAS, several times slower: no fair peer."""
    maps = worker.libraries()
    if "openblas" not in maps:
        sys.exit("the peer runs without OpenBLAS: choose it with update-alternatives --config libblas.so.3-*")
    query = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", "libopenblas0-pthread"], capture_output=True,
                           text=True, check=False)
    return f"OpenBLAS {query.stdout or 'of unknown version'}"


def run_in_turn(workers, rounds):
    """Medians over the rounds: {(worker, task): {"processor_us", "wall_us", ...}}."""
    answers = {}
    for number in range(rounds + 1):
        for name, (worker, tasks) in workers.items():
            for task in tasks:
                answer = worker.ask(task, *(ROUND if number else WARM)[task])
                answers.setdefault((name, task), []).append(answer)
    return {key: {figure: statistics.median(row[figure] for row in rows[1:]) for figure in rows[0]}
            for key, rows in answers.items()}


def add_start_up(name, table, *command, most=None):
    """From exec to the end of a process that loads the model and estimates once: processor time, and wall clock."""
    processor, wall = [], []
    for _ in range(STARTS):
        begin = time.perf_counter()
        process = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        wall.append((time.perf_counter() - begin) * 1e3)
        processor.append((used.ru_utime + used.ru_stime) * 1e3)
        if status != 0:
            sys.exit(f"{command[0]} failed")
    table.add(f"{name}_ms", statistics.median(processor), most=most)
    table.add(f"{name}_wall_ms", statistics.median(wall))


def add_share_of_peak(bench, table):
    """The network benchmark's own: a training step's multiply-adds a second beside the core's measured peak."""
    for name, key, least in (("AVX-512", "avx512", 0.8), ("AVX2", "avx2", 0.7)):
        out = subprocess.run([bench, f"--benchmark_filter=^{name}/Nf=3/Nr=1/fusion/step", "--benchmark_format=json"],
                             check=True, capture_output=True, text=True).stdout
        rows = json.loads(out)["benchmarks"] if out.strip() else []  # nothing where the machine lacks it
        table.add(f"train_{key}_share_of_peak", rows[0]["of_peak"] if rows else None, least=least)
        table.add(f"train_{key}_peak_gflops", rows[0]["peak_gflops"] if rows else None)


def add_differences(options, table):
    """What tests/interop/run.sh tells, with its limits."""
    command = [sys.executable, INTEROP / "compare.py", options.binaries / "network_interop", options.library, "--json"]
    out = subprocess.run(command + (["--quick"] if options.quick else []), capture_output=True, text=True,
                         check=False).stdout
    for key, value in json.loads(out).items():
        table.add(key, value, most=DIFFERENCE_LIMITS.get(key))


def half_precision(options):
    """The worst of the models; nothing where there is none."""
    rows = [json.loads(subprocess.run([options.binaries / "network_fp16_difference", model, *options.sessions],
                                      check=True, capture_output=True, text=True).stdout)
            for model in options.model]
    return {key: max(row[key] for row in rows) for key in rows[0]} if rows else {}


class Table:
    def __init__(self):
        self.rows = []

    def add(self, key, value, least=None, most=None):
        self.rows.append((key, value, least, most))

    def met(self):
        return all(self.verdict(row) != "NOT MET" for row in self.rows)

    @staticmethod
    def verdict(row):
        _, value, least, most = row
        if least is None and most is None:
            return ""
        if value is None:
            return "not measured"
        return "met" if (least is None or value >= least) and (most is None or value <= most) else "NOT MET"

    def print_text(self):
        for row in self.rows:
            key, value, least, most = row
            shown = "-" if value is None else value if isinstance(value, str) else f"{value:.4g}"
            limit = f">= {least:g}" if least is not None else f"<= {most:g}" if most is not None else ""
            print(f"{key:44} {shown:>12}  {limit:10} {self.verdict(row)}".rstrip())

    def print_json(self):
        print(json.dumps({key: value for key, value, _, _ in self.rows}, indent=1))


def time_workers(options, folder, table):
    binaries, library = options.binaries, options.library
    model, weights = folder / "model.onnx", folder / "weights.bin"
    interop = binaries / "network_interop"
    subprocess.run([interop, "seeded-model", "3", "1", "fusion", "100", model], check=True)
    subprocess.run([interop, "weights", model, weights], check=True)
    ours, onnx_runtime = binaries / "network_peer_ours", binaries / "network_peer_onnx_runtime"
    libtorch = binaries / "network_peer_libtorch"
    workers = {
        "ours": (Worker(ours, model, "serve"), ("infer", "infer_fp16", "train")),
        "onnx_runtime": (Worker(onnx_runtime, library, model, "serve"), ("infer",)),
        "onnx_runtime_node": (Worker("node", HERE / "node.js", options.node_modules, model), ("infer",)),
        "libtorch": (Worker(libtorch, weights, "serve"), ("infer", "train")),
        "pytorch": (Worker(sys.executable, HERE / "pytorch.py", weights), ("infer", "train")),
    }
    times = run_in_turn(workers, 3 if options.quick else 15)
    blas = {require_openblas(workers[name][0]) for name in ("libtorch", "pytorch")}
    table.add("blas_of_the_peers", ", ".join(sorted(blas)))
    for worker, _ in workers.values():
        worker.close()
    add_times(times, table)
    add_start_up("start_up", table, ours, model, "once", most=15)
    add_start_up("start_up_fp16", table, ours, model, "once", "fp16", most=15)
    add_start_up("onnx_runtime_start_up", table, onnx_runtime, library, model, "once")
    add_start_up("libtorch_start_up", table, libtorch, weights, "once")


def add_times(times, table):
    def us(worker, task):
        return times[worker, task]["processor_us"]

    for (worker, task), row in times.items():
        table.add(f"{worker}_{task}_us", row["processor_us"])
        table.add(f"{worker}_{task}_wall_us", row["wall_us"])
    onnx_runtime = min(us("onnx_runtime", "infer"), us("onnx_runtime_node", "infer"))
    table.add("infer_ratio_onnx_runtime", onnx_runtime / us("ours", "infer"), least=1.5)
    table.add("infer_fp16_ratio_onnx_runtime", onnx_runtime / us("ours", "infer_fp16"), least=1.9)
    table.add("infer_ratio_libtorch", us("libtorch", "infer") / us("ours", "infer"), least=3)
    table.add("infer_ratio_pytorch", us("pytorch", "infer") / us("ours", "infer"))
    table.add("train_ratio_pytorch", us("pytorch", "train") / us("ours", "train"), least=3)
    table.add("train_ratio_libtorch", us("libtorch", "train") / us("ours", "train"), least=2.5)
    for task in ("infer", "infer_fp16"):
        table.add(f"{task}_allocations", times["ours", task]["allocations"], most=0)


def parse(arguments):
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries", type=pathlib.Path)
    parser.add_argument("library", type=pathlib.Path)
    parser.add_argument("node_modules", type=pathlib.Path)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--model", type=pathlib.Path, action="append", default=[])
    parser.add_argument("--sessions", nargs="*", default=[])
    return parser.parse_args(arguments)


def main(arguments):
    options = parse(arguments)
    table = Table()
    table.add("cores_used", str(len(os.sched_getaffinity(0))))
    with tempfile.TemporaryDirectory() as folder:
        time_workers(options, pathlib.Path(folder), table)
    add_differences(options, table)
    add_share_of_peak(options.binaries / "network_bench", table)
    half = half_precision(options)
    table.add("fp16_windows", half.get("windows"))
    table.add("fp16_fusion_difference_dps", half.get("fusion_dps"), most=0.1)
    table.add("fp16_thermal_difference_dps", half.get("thermal_dps"), most=0.1)
    table.print_json() if options.json else table.print_text()
    return 0 if table.met() else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
