# SPDX-License-Identifier: MIT
"""Writes seed files for a fuzzer: golden vectors of protocols/vectors, captures of real devices where they are, small files
and texts as the program writes them. The model fuzzer's are files.

Usage: seeds.py FUZZER VECTORS_FOLDER CORPUS_FOLDER [CAPTURES_FOLDER]. A vector's second column is its hex.
"""
import json
import pathlib
import shutil
import sys

fuzzer, vectors, corpus = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
captures = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
capture_bytes = 4096  # of each: a corpus is to stay small
source = pathlib.Path(__file__).resolve().parent.parent.parent

DEEP = 20_000 * "[" + 20_000 * "]"
LINK = {"port": "p", "usb_path": "1-4.2", "baud": 9600, "latency_s": 0.01, "reset_on_open": False}
FORMAT_1_PROFILE = {
    "name": "rig",
    "camera": {"link": LINK, "model": "m", "output_rate_hz": 8, "field_of_view_deg": 55, "mirrored": True, "checksum": "word"},
    "gyro": {"link": LINK, "model": "m", "protocol": "mavlink", "settings": {"system": 3.0, "raw_scale_dps": 0.05},
             "text": {"prefix": "", "rate": [0, 1, 2], "scale_dps": 1, "time": -1, "time_unit_s": 0.001},
             "output_rate_hz": 200, "axis": 2, "sign": 1},
    "servo": {"link": LINK, "model": "m", "kind": "positional", "travel_deg": 270, "full_rate_dps": 0, "pulse_min_us": 500,
              "pulse_max_us": 2500, "max_rate_dps": 220, "acceleration_dps2": 2000, "stop_margin_deg": 2, "settle_s": 0.2}}
FORMAT_1_HEADER = {
    "uuid": "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60", "environment": "garden", "acquisition": 2, "title": "t",
    "start_time_utc": "2026-07-25T14:35:59.900001Z", "time_reference": 1, "realtime_offset_ns": 0, "simulated": True,
    "simulation_seed": 3, "simulation": "", "profile": FORMAT_1_PROFILE, "profile_toml": "", "plan_name": "", "plan_toml": "",
    "frames_per_leg": 3, "creator": "", "creator_git": "", "host_name": "", "kernel": "", "firmware": ""}
TEXTS = {
    "plan": [
        "magnitudes_dps = [7.5, 90.0]\norder = \"given\"\nvalid_per_leg = 0\nframes_per_leg = 12\nseed = 3\n",
        "name = \"x\"\nmin_dps = 10\nmax_dps = 100\nstep_dps = 7.5\norder = \"seeded\"\nboth_directions = false\n"
        "opening_rest_s = 1\nclosing_rest_s = 2.5\nrepeat = true\n",
        "leg_rates_dps = [-20.0, 20.0]\n",
        "a=" + DEEP,
        "magnitudes_dps = [" + 8_000 * "1.5, " + "2]\n",
    ],
    "profile": [
        "name = \"rig\"\n[camera]\nport = \"/dev/ttyUSB0\"\nbaud = 460800\noutput_rate_hz = 8\n[gyro]\n"
        "protocol = \"text\"\naxis = 2\nsign = -1\n[gyro.text]\nprefix = \"a/g:\"\nrate_columns = [3, -1, 5]\n"
        "[servo]\nkind = \"continuous\"\nfull_rate_dps = 220\ntravel_deg = 720\n",
        "a" + 5_000 * ".a" + " = 1\n",
        "[servo]\nkind = \"positional\"\ntravel_deg = 180\npulse_min_us = 500\npulse_max_us = 2500\n",
    ],
    "web": [
        "{\"note\":" + DEEP + "}",
        "{\"note\":\"a mark\"}",
        "{}",
        "{\"token\":\"0123456789abcdef0123456789abcdef\"}",
    ],
    "header_json": [
        "{\"uuid\":\"8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60\",\"environment\":\"garden\",\"acquisition\":2,"
        "\"title\":\"t\",\"start_time_utc\":\"2026-07-25T14:35:59.900001Z\",\"time_reference_ns\":1,"
        "\"simulated\":true,\"simulation_seed\":3}",
        "{\"acquisition\":" + DEEP + "}",
        json.dumps(FORMAT_1_HEADER),
    ],
    "result": ["{\"job\":" + DEEP + "}", "{\"job\":{\"kind\":\"held-out\",\"seed\":1},\"mae_dps\":1.5}"],
    "run": [
        "{\"data\":0,\"settings\":{\"epochs\":" + DEEP + "}}",
        "{\"data\":[{\"name\":\"garden/1\",\"sha256\":\"00ff\"}],\"settings\":{\"epochs\":3}}",
    ],
    "map": ["THRMAP01", "THRMAP02"],
    "firmware": [],
    "journal": [],
    "session": [],
}
DEVICES = {"camera": "gy_mcu90640", "witmotion": "witmotion", "text_gyro": "text_gyro", "text_camera": "text_camera", "binary_camera": "binary_camera", "i2c_stick": "i2c_stick", "mlx_raw": "mlx_raw", "mavlink": "mavlink_gyro", "framed": ("vectornav", "xsens", "hipnuc", "mip"), "servo": "servo_link", "bus_servo": ("dynamixel", "grbl", "sts3215")}


def keep(name, content):
    (corpus / name).write_bytes(content)


def keep_vectors(stem, prefix=b""):
    for path in sorted(vectors.glob("*.txt")):
        if stem and path.stem not in ((stem,) if isinstance(stem, str) else stem):
            continue
        for number, line in enumerate(path.read_text().splitlines()):
            fields = [field.strip() for field in line.split("|")]
            if line.startswith("#") or len(fields) < 2:
                continue
            try:
                keep(f"{path.stem}-{number}", prefix + bytes.fromhex(fields[1]))
            except ValueError:
                sys.exit(f"{path}:{number + 1}: the second column is not hex")


def keep_captures(words):
    if captures is None or not captures.is_dir():
        return
    for path in sorted(captures.rglob("*")):
        if path.is_file() and any(word in str(path.relative_to(captures)) for word in words):
            keep(f"capture-{path.parent.name}-{path.name}"[:80], path.read_bytes()[:capture_bytes])


kind = fuzzer.removesuffix("_fuzzer").removesuffix("_scanner")
if kind == "model":
    for path in sorted((pathlib.Path(__file__).parent / "model_seeds").glob("*.onnx")):
        shutil.copy(path, corpus)
elif kind == "firmware":
    keep_vectors("servo_link", prefix=bytes([96, 254]))  # configured, armed, then these bytes
elif kind in TEXTS:
    for number, text in enumerate(TEXTS[kind]):
        keep(f"text-{number}", text.encode())
    if kind in ("session", "map"):
        for number in range(64):
            keep(f"edit-{number}", bytes((number * 37 + i * 11) % 256 for i in range(4 + number % 20)))
    if kind == "journal":
        keep("records", bytes([2, 0, 12] + [1] * 12 + [4, 0, 14] + [0] * 10 + [97] * 4 + [6, 0, 8] + [2] * 8))
    if kind == "plan":
        for path in sorted(source.glob("docs/**/*.toml")) + sorted(source.glob("tests/**/*.toml")):
            keep(f"file-{path.name}", path.read_bytes())
else:
    keep_vectors(DEVICES.get(kind))
    keep_captures({"camera": ["gy_mcu90640"], "text_gyro": ["mpu6050"], "witmotion": ["wit"]}.get(kind, []))
