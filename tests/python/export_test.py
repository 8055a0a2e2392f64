# SPDX-License-Identifier: MIT
"""What `thermorig export SESSION` writes, read back by programs that know nothing of it.

Usage: export_test.py PROGRAM FOLDER     (FOLDER keeps the packages from npm that read MCAP)
"""
import base64
import csv
import hashlib
import io
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(SOURCE / "app/python"), str(Path(__file__).parent)]

import h5py  # noqa: E402
import mcap_reader  # noqa: E402
import numpy as np  # noqa: E402
import pandas  # noqa: E402

import thermorig  # noqa: E402

PROGRAM = MCAP_FOLDER = ""  # of the command line
BRIEF = "--plan quick --speeds 40,80 --frames-per-leg 12".split()
folder = tempfile.TemporaryDirectory()
session: thermorig.Session


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=folder.name, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def exported(*words):
    """What the session becomes, on standard output."""
    return run("export", session.path, *words, "-o", "-")


def setUpModule():
    global session
    rig = "--fast --world honest --simulated=3 --simulated-encoder as5600 -o recordings".split()
    run("calibrate", "encoder", *rig, "--save", "rig.toml")
    run("live", "--record", *rig, "--rig", "rig.toml", "-e", "garden", *BRIEF)
    session = thermorig.Session(thermorig.find_sessions(Path(folder.name) / "recordings/garden")[0])


def tearDownModule():
    session.close()
    folder.cleanup()


def stored(name):
    return session.file[name][:]


class NumPy(unittest.TestCase):
    def arrays(self, *words):
        data = io.BytesIO(exported(*words))
        self.assertIsNone(zipfile.ZipFile(data).testzip())
        data.seek(0)
        with np.load(data) as arrays:
            return dict(arrays)

    def test_windows_are_those_of_the_package_bit_for_bit(self):
        for frames, reduction in ((3, 1), (2, 2), (6, 3)):
            arrays = self.arrays("--npz", "--nf", frames, "--nr", reduction)
            windows = thermorig.windows(session, frames, reduction)
            for name in ("images", "label_dps", "gyro_dps", "last", "middle_s"):
                ours = getattr(windows, name)
                self.assertEqual((arrays[name].dtype, arrays[name].shape), (ours.dtype, ours.shape), name)
                self.assertEqual(arrays[name].tobytes(), ours.tobytes(), name)
            self.assertGreater(len(windows), 5)
            for label in ("corrected", "shaft", "measured"):
                ours = thermorig.windows(session, frames, reduction, label=label).label_dps
                self.assertEqual(arrays[f"{label}_dps"].tobytes(), ours.tobytes(), label)

    def test_rows_are_the_columns_of_the_file(self):
        arrays = self.arrays("--npz=rows")
        np.testing.assert_array_equal(arrays.pop("temperature"), stored("camera/temperature"))
        about = json.loads(str(arrays.pop("about")))
        self.assertEqual((about["environment"], about["uuid"], about["simulated"]), ("garden", session.uuid, True))
        self.assertGreater(len(arrays), 12)
        for name, array in arrays.items():
            column = stored("samples/" + name)
            self.assertEqual(array.dtype, column.dtype, name)
            np.testing.assert_array_equal(array, column, name)

    def test_the_same_session_gives_the_same_bytes(self):
        self.assertEqual(exported("--npz"), exported("--npz"))


class Csv(unittest.TestCase):
    def table(self, name):
        text = exported("--csv=" + name).decode("utf-8")
        self.assertEqual(text.count("\n"), text.count("\r\n"))
        return pandas.read_csv(io.StringIO(text), float_precision="round_trip")

    def test_reads_back_as_the_values_of_the_file(self):
        groups = {"samples": "samples", "gyro": "gyro", "servo": "servo", "estimates": "estimates"}
        for name, group in groups.items():
            table, compared = self.table(name), 0
            for heading in table.columns:
                column = session.file[group].get(heading.split(" [")[0])
                if column is None or column.dtype.kind == "O":
                    continue
                if " [" in heading:
                    self.assertEqual(heading.split(" [")[1][:-1], column.attrs["units"])
                np.testing.assert_array_equal(table[heading].to_numpy().astype(column.dtype), column[:], heading)
                compared += 1
            self.assertGreaterEqual(compared, 3, name)

    def test_has_every_pixel_of_an_image(self):
        table = self.table("camera")
        pixels = table[[f"temperature_{row}_{column} [degC]" for row in range(24) for column in range(32)]]
        np.testing.assert_array_equal(pixels.to_numpy(np.float32).reshape(-1, 24, 32), stored("camera/temperature"))

    def test_has_what_each_estimator_said_live(self):
        table = self.table("estimates")
        names = [name.decode() for name in stored("estimates/estimator")]
        for index, name in enumerate(names):
            for column in ("rate", "rate_sigma", "angle"):
                unit = "deg" if column == "angle" else "deg/s"
                values = stored("estimates/" + column)[:, index]
                read = table[f"{name}.{column} [{unit}]"].to_numpy().astype(values.dtype)
                np.testing.assert_array_equal(read, values, name)
        self.assertIn("gyro-kalman", names)

    def test_has_events_as_text(self):
        rows = list(csv.reader(io.StringIO(exported("--csv=events").decode(), newline="")))
        self.assertEqual(rows[0], ["time [s]", "kind", "source", "message"])
        self.assertEqual([row[3] for row in rows[1:]], [message.decode() for message in stored("events/message")])


class Tum(unittest.TestCase):
    def trajectory(self, name):
        rows = np.loadtxt(io.BytesIO(exported("--tum=" + name)))
        self.assertEqual(rows.shape[1], 8)
        np.testing.assert_array_equal(rows[:, 1:6], 0)
        np.testing.assert_allclose(np.hypot(rows[:, 6], rows[:, 7]), 1, atol=1e-12)
        half = np.unwrap(np.arctan2(rows[:, 6], rows[:, 7]))
        return rows[:, 0] - session.start.timestamp(), np.degrees(2 * half)

    def test_estimators_turn_as_they_said_live(self):
        names = [name.decode() for name in stored("estimates/estimator")]
        for index, name in enumerate(names):
            time, angle = self.trajectory(name)
            said = stored("estimates/angle")[:, index]
            known = np.isfinite(said)
            np.testing.assert_allclose(time, stored("estimates/exposure_end")[known], atol=2e-6)
            turned = said[known]
            np.testing.assert_allclose(np.diff(angle), np.diff(turned), atol=1e-6)

    def test_the_shaft_turns_at_the_speed_of_its_label(self):
        time, angle = self.trajectory("shaft")
        ends = session.exposure_end_s
        period = np.median(np.diff(ends))
        steady = np.flatnonzero(session.valid[1:] & session.valid[:-1]) + 1
        index = np.searchsorted(time, ends[steady] - period / 2)
        rate = (angle[index] - angle[index - 1]) / (time[index] - time[index - 1])
        self.assertGreater(len(steady), 20)
        np.testing.assert_allclose(rate, session.label("rate_shaft")[steady], atol=1.5)

    def test_the_measured_shaft_is_each_reading_of_its_sensor(self):
        time, angle = self.trajectory("measured")
        readings = session.table("shaft")
        known = np.isfinite(readings["angle"])
        self.assertGreater(known.sum(), 1000)
        np.testing.assert_allclose(time, readings["time"][known], atol=2e-6)
        np.testing.assert_allclose(np.diff(angle), np.diff(readings["angle"][known]), atol=1e-6)


class Mcap(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bytes = exported("--mcap")
        cls.mcap = mcap_reader.read(cls.bytes)
        cls.offset_ns = int(session.file["sync"].attrs["realtime_offset_ns"])
        cls.reference_ns = int(session.file.attrs["time_reference_ns"])

    def times_of(self, group):
        return np.round(stored(group + "/time") * 1e9).astype(np.int64) + self.reference_ns + self.offset_ns

    def messages(self, topic):
        return [json.loads(data) for _, _, data in self.mcap.messages[topic]]

    def test_has_every_message_at_its_time_in_order(self):
        groups = {"/camera": "camera", "/gyro": "gyro", "/servo": "servo", "/label": "samples", "/events": "events",
                  "/shaft": "shaft"}
        self.assertEqual(set(self.mcap.messages), set(groups))
        for topic, group in groups.items():
            times = self.times_of(group)
            np.testing.assert_array_equal([log for log, _, _ in self.mcap.messages[topic]], times)
            np.testing.assert_array_equal([publish for _, publish, _ in self.mcap.messages[topic]], times)
        self.assertEqual(self.mcap.order, sorted(self.mcap.order))
        self.assertGreater(self.mcap.chunks, 1)

    def test_has_the_measured_shaft(self):
        readings, labels = self.messages("/shaft"), self.messages("/label")
        self.assertGreater(np.isfinite(stored("samples/rate_measured")).sum(), 20)
        np.testing.assert_array_equal([r["angle_deg"] for r in readings], stored("shaft/angle"))
        np.testing.assert_allclose([r["uncertainty_deg"] for r in readings], stored("shaft/angle_uncertainty"), rtol=1e-6)
        for name, column in (("rate_measured_dps", "rate_measured"), ("angle_measured_deg", "angle_measured")):
            said = np.array([label[name] for label in labels], np.float64)
            np.testing.assert_allclose(said, stored("samples/" + column), rtol=1e-6)

    def test_has_every_pixel(self):
        images = self.messages("/camera")
        self.assertEqual({(i["width"], i["height"], i["encoding"], i["step"]) for i in images}, {(32, 24, "32FC1", 128)})
        pixels = np.stack([np.frombuffer(base64.b64decode(i["data"]), "<f4").reshape(24, 32) for i in images])
        self.assertEqual(pixels.tobytes(), stored("camera/temperature").tobytes())
        stamps = [i["timestamp"]["sec"] * 10**9 + i["timestamp"]["nsec"] for i in images]
        np.testing.assert_array_equal(stamps, self.times_of("camera"))

    def test_has_rates_labels_and_reasons(self):
        rates = np.array([[m["angular_velocity"][axis] for axis in "xyz"] for m in self.messages("/gyro")])
        np.testing.assert_allclose(np.degrees(rates), stored("gyro/rate_xyz"), rtol=1e-12)
        labels = self.messages("/label")
        for key, column in {"rate_commanded_dps": "rate_commanded", "rate_shaft_dps": "rate_shaft",
                            "rate_gyro_dps": "rate_gyro"}.items():
            read = np.array([label[key] for label in labels], np.float32)  # null becomes NaN
            np.testing.assert_array_equal(read, stored("samples/" + column))
        self.assertEqual([label["reasons"] for label in labels],
                         [session.reasons(frame) for frame in range(len(session))])

    def test_has_schemas_that_name_every_field(self):
        for number, (schema_number, topic, encoding) in self.mcap.channels.items():
            name, kind, text = self.mcap.schemas[schema_number]
            self.assertEqual((encoding, kind), ("json", "jsonschema"))
            schema = json.loads(text)
            self.assertEqual(schema["title"], name)
            self.assertEqual(set(self.messages(topic)[0]), set(schema["properties"]), topic)
        self.assertEqual(self.mcap.metadata["session"]["uuid"], session.uuid)

    def test_reader_of_this_test_notices_what_is_changed(self):
        for at in range(100, len(self.bytes), len(self.bytes) // 40):
            changed = bytearray(self.bytes)
            changed[at] ^= 1
            with self.assertRaises((mcap_reader.Malformed, UnicodeDecodeError), msg=str(at)):
                mcap_reader.read(bytes(changed))


class McapByItsOwnReader(unittest.TestCase):
    """@mcap/core is the reader of those who defined the format, which Foxglove uses."""

    @classmethod
    def setUpClass(cls):
        kept = Path(MCAP_FOLDER)
        kept.mkdir(parents=True, exist_ok=True)
        for name in ("package.json", "package-lock.json", "read.mjs"):
            shutil.copy(SOURCE / "tests/interchange/mcap_core" / name, kept)
        lock, installed = kept / "package-lock.json", kept / "node_modules/.installed"
        if not installed.exists() or installed.read_bytes() != lock.read_bytes():
            subprocess.run("npm ci --ignore-scripts --no-audit --no-fund --no-update-notifier --prefer-offline "
                           "--loglevel=error".split(), cwd=kept, check=True)
            shutil.copy(lock, installed)

    def read(self, compression):
        path = Path(folder.name) / f"{compression}.mcap"
        path.write_bytes(exported("--mcap=" + compression))
        done = subprocess.run(["node", "read.mjs", path], cwd=MCAP_FOLDER, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return json.loads(done.stdout)

    def test_finds_every_message_time_and_pixel_compressed_or_not(self):
        told = mcap_reader.read(exported("--mcap"))
        pixels = hashlib.sha256(stored("camera/temperature").astype("<f4").tobytes()).hexdigest()
        for compression, name in (("none", ""), ("zstd", "zstd")):
            found = self.read(compression)
            self.assertEqual((found["compressions"], found["chunks"]), ([name], told.chunks))
            self.assertEqual(set(found["topics"]), set(told.messages))
            for topic, messages in told.messages.items():
                of_topic = found["topics"][topic]
                self.assertEqual((of_topic["encoding"], of_topic["counted"]), ("json", len(messages)), topic)
                self.assertEqual([int(time) for time in of_topic["log_times"]], [log for log, _, _ in messages])
                self.assertEqual([int(time) for time in of_topic["publish_times"]], [out for _, out, _ in messages])
                data = hashlib.sha256(b"".join(data for _, _, data in messages)).hexdigest()
                self.assertEqual(of_topic["data"], data, topic)
            self.assertEqual(found["topics"]["/camera"]["pixels"], pixels)
            self.assertEqual(found["topics"]["/camera"]["schema"], "foxglove.RawImage")

    def test_compressed_is_smaller_by_far(self):
        self.assertLess(3 * len(exported("--mcap=zstd")), len(exported("--mcap=none")))


if __name__ == "__main__":
    PROGRAM, MCAP_FOLDER = sys.argv.pop(1), sys.argv.pop(1)
    unittest.main()
