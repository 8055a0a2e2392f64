# SPDX-License-Identifier: MIT
"""app/python beside the program: the same sessions, windows and scaling, bit for bit.

Usage: package_test.py PROGRAM
"""
import contextlib
import functools
import io
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "app/python"))

import h5py  # noqa: E402
import numpy as np  # noqa: E402
import onnx  # noqa: E402

import thermorig  # noqa: E402
from thermorig import checks  # noqa: E402

PROGRAM = ""  # of the command line
BRIEF = "--plan quick --speeds 40,80 --frames-per-leg 12".split()
folder = tempfile.TemporaryDirectory()
recordings = Path(folder.name) / "recordings"


def run(*words, code=0):
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=folder.name, capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith(("{", "["))]


def record(environment, seed, *more):
    run("record", "--fast", "--world", "honest", f"--simulated={seed}", "-e", environment, "--json", *BRIEF, *more)


@functools.cache
def opened():
    """The sessions of setUpModule(), read and checked once: for tests of what is in them."""
    return thermorig.open_sessions(recordings)


def setUpModule():
    record("kitchen", 3)
    record("garden", 4, "--licence", "CC-BY-4.0")
    record("garden", 5)
    run("calibrate", "bias", "--world", "honest", "--simulated=3", "--fast", "--json")


def tearDownModule():
    folder.cleanup()


def altered_file(session, change, name="altered.h5"):
    """A file with other values, as a stranger might have written them: h5py knows nothing of check sums."""
    path = Path(folder.name) / name
    path.write_bytes(Path(session.path).read_bytes())
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def altered_copy(session, change):
    """The same by somebody who knows of them."""
    def change_and_sum(file):
        change(file)
        for name, dataset in list(checks._datasets(file)):
            if "crc32" in dataset.attrs:
                dataset.attrs.modify("crc32", np.uint32(checks.data_sum(dataset)))
        del file[checks.ATTRIBUTE_SUMS]
        sums = file.create_dataset(checks.ATTRIBUTE_SUMS, data="".join(
            f"{crc} {path}\n" for path, crc in checks.attribute_sums(file)), dtype=h5py.string_dtype())
        sums.attrs["crc32"] = np.uint32(checks.data_sum(sums))
    return thermorig.Session(altered_file(session, change_and_sum))


class TheSessions(unittest.TestCase):
    def test_are_those_of_train_in_its_order_with_its_hashes(self):
        run("train", recordings, "-o", "hashes.onnx", "--epochs", 1, "--json")
        trained = json.loads((Path(folder.name) / "hashes.run/run.json").read_text())["data"]
        ours = [{"name": session.name, "sha256": session.data_hash} for session in
                thermorig.open_sessions(recordings)]
        self.assertEqual([session["name"] for session in ours], ["garden_acq-01", "garden_acq-02", "kitchen_acq-01"])
        self.assertEqual(ours, trained)

    def test_have_the_hashes_of_train_with_each_label(self):
        for label in ("corrected", "shaft"):
            run("train", recordings, "-o", f"{label}.onnx", "--epochs", 1, "--label", label, "--json")
            trained = json.loads((Path(folder.name) / f"{label}.run/run.json").read_text())
            self.assertEqual(trained["settings"]["label"], label)
            sessions = opened()
            self.assertEqual([session.learnt_hash(label) for session in sessions],
                             [data["sha256"] for data in trained["data"]])

    def test_have_each_label_by_its_column_and_by_the_word_of_train(self):
        session = opened()[0]
        for word in ("commanded", "corrected", "shaft"):
            np.testing.assert_array_equal(session.label(word), session.column(f"rate_{word}"))
            np.testing.assert_array_equal(session.label_uncertainty(word), session.column(f"rate_{word}_uncertainty"))
        old = altered_copy(session, lambda file: file.__delitem__("samples/rate_corrected"))
        with self.assertRaisesRegex(ValueError, "thermorig reprocess"):
            old.label("corrected")

    def test_say_what_inspect_says(self):
        for said in run("inspect", "--json", recordings)[0]:
            with thermorig.Session(said["file"]) as session:
                for name in ("environment", "acquisition", "uuid", "simulated", "plan", "verdict", "verdict_reasons"):
                    self.assertEqual(getattr(session, name), said[name], name)
                self.assertEqual(session.licence or "", said["licence"])
                self.assertEqual(session.start.isoformat().replace("+00:00", "Z"), said["start_time"])
                self.assertEqual(len(session), said["frames"])
                self.assertEqual(int((session.valid & (session.column("leg") > 0)).sum()), said["frames_valid"])
                self.assertEqual(session.world, "honest")

    def test_name_their_times_their_bias_and_what_stands_against_a_frame(self):
        session = opened()[0]
        np.testing.assert_array_equal(session.exposure_end_s, session.file["camera/time"][:])
        exposure_s = session.exposure_end_s - session.exposure_begin_s
        quarter_s = (session.exposure_end_s - session.middle_s)[10:]
        np.testing.assert_allclose(quarter_s, exposure_s[10:] / 4, atol=2e-3)
        timing = run("inspect", "--timing", "--json", session.path)[0][0]["timing"]
        self.assertEqual(session.gyro_bias_dps, tuple(timing["gyro"]["bias_dps"][key]
                                                      for key in ("value", "uncertainty")))
        self.assertIn("outside_leg", session.reasons(0))
        self.assertEqual(session.reasons(int(np.flatnonzero(session.valid)[0])), [])
        self.assertTrue(session.mirrored)
        np.testing.assert_array_equal(session.upright_c[:, :, 0], session.frames_c[:, :, 31])
        with self.assertRaisesRegex(ValueError, "commanded, corrected, shaft"):
            session.label("rate_label")

    def test_follow_what_was_said_of_them_afterwards(self):
        record("attic", 6, "--operator", "A. Person", "--place", "under the roof", "--note", "it is hot")
        path = thermorig.find_sessions(recordings / "attic")[0]
        begin_s, end_s = 5.0, 8.0
        run("annotate", path, "--note", "the window was open")
        run("annotate", path, "--exclude", f"{begin_s}..{end_s}")
        moved = run("annotate", path, "--environment", "roof", "--json")[0]["file"]
        with thermorig.Session(moved) as session:
            self.assertEqual((session.name, session.operator, session.place), ("roof_acq-01", "A. Person",
                                                                               "under the roof"))
            self.assertEqual(session.notes, ["it is hot", "the window was open"])
            within = (session.exposure_begin_s < end_s) & (session.exposure_end_s > begin_s)
            self.assertGreater(within.sum(), 10)
            self.assertFalse(session.run[within].any())
            for frame in np.flatnonzero(within):
                self.assertIn("operator", session.reasons(frame))
            data = thermorig.windows(session, 3)
            start = run("train", moved, "-o", "roof.onnx", "--epochs", 1, "--no-choose-epoch", "--json")[0]
            self.assertEqual(start["environments"]["roof"]["windows"], len(data))
        Path(moved).unlink()

    def test_that_are_none_are_refused(self):
        with h5py.File(Path(folder.name) / "other.h5", "w"):
            pass
        with self.assertRaisesRegex(thermorig.NotASession, "other.h5"):
            thermorig.Session(Path(folder.name) / "other.h5")
        text = Path(folder.name) / "text.h5"
        text.write_text("no session")
        with self.assertRaisesRegex(thermorig.NotASession, "text.h5: "):
            thermorig.Session(text)
        text.unlink()
        with self.assertRaisesRegex(ValueError, "there is no session"):
            thermorig.scaling_of([])
        first = opened()[0]
        with self.assertRaisesRegex(thermorig.NotASession, "thermorig reprocess"):
            altered_copy(first, lambda file: file.attrs.__setitem__("format_version", "1.3.0"))
        with self.assertRaises(FileNotFoundError):
            thermorig.find_sessions(Path(folder.name) / "nowhere")
        with self.assertRaisesRegex(ValueError, "holds the same recording"):
            thermorig.open_sessions(first.path, altered_copy(first, lambda file: None).path)

    def test_that_are_bad_are_left_out_of_a_folder_as_train_does_and_refused_by_name(self):
        there = Path(folder.name) / "some"
        for place in ("kitchen", "garden"):
            (there / place).mkdir(parents=True)
            source = thermorig.find_sessions(recordings / place)[0]
            (there / place / source.name).write_bytes(source.read_bytes())
        bad = thermorig.find_sessions(there / "kitchen")[0]
        run("annotate", bad, "--exclude", "all")
        with self.assertWarnsRegex(UserWarning, "left out: .*kitchen.*all were excluded"):
            names = [session.name for session in thermorig.open_sessions(there)]
        self.assertEqual(names, ["garden_acq-01"])
        start = run("train", there, "-o", "some.onnx", "--epochs", 1, "--no-choose-epoch", "--json")[0]
        self.assertEqual([Path(file).name for file in start["left_out"]], [bad.name])
        for paths in ((bad,), (there, bad), (there / "kitchen",)):
            with self.assertRaisesRegex(thermorig.BadSession, "verdict is bad"):
                thermorig.open_sessions(*paths)
            run("train", *paths, "-o", "none.onnx", code=9)
        self.assertEqual(len(thermorig.open_sessions(there, accept_bad=True)), 2)

    def test_that_were_changed_are_refused_whatever_was_changed(self):
        first = opened()[0]
        middle = len(first) // 2

        def value(path, at, new):
            return lambda file: file[path].__setitem__(at, new)

        def attribute(path, name, new):
            return lambda file: file[path].attrs.modify(name, new)

        def linked_away(file):
            del file["samples/rate_commanded"]
            file["samples/rate_commanded"] = h5py.ExternalLink("altered.h5", "/samples/rate_shaft")

        def without(path):
            return lambda file: file.__delitem__(path)

        header = json.loads(first.file["rig"].attrs["header_json"])
        forged = {
            "a label": value("samples/rate_commanded", middle, 1.0),
            "a validity": value("samples/valid", slice(None), 1),
            "a pixel": value("camera/temperature", (middle, 3, 3), 77.0),
            "a raw byte": value("raw/gyro/bytes", 7, 1),
            "a verdict": attribute("quality", "verdict", "usable"),
            "another kind of verdict": lambda file: file["quality"].attrs.__setitem__("verdict", 1),
            "a profile": attribute("rig/profile/camera", "mirrored", 0),
            "a bias": attribute("sync", "gyro_bias_dps", 7.0),
            "a header without a number": attribute("rig", "header_json", json.dumps(
                {key: value for key, value in header.items() if key != "acquisition"})),
            "a header that is no JSON": attribute("rig", "header_json", "{"),
            "no header": lambda file: file["rig"].attrs.__delitem__("header_json"),
            "no table": without("samples/run"), "no group": without("events"), "no sums": without("quality"),
            "no version": lambda file: file.attrs.__delitem__("format_version"),
            "a label from another file": linked_away}
        for what, change in forged.items():
            with self.subTest(what), self.assertRaisesRegex(thermorig.NotASession, "forged.h5"):
                thermorig.Session(altered_file(first, change, "forged.h5"))
        for broken in ("environment", "uuid", "start_time_utc", "simulated", "plan_name"):  # with sums that are right
            with self.subTest(broken), self.assertRaises(thermorig.NotASession):
                altered_copy(first, attribute("rig", "header_json", json.dumps(
                    {key: value for key, value in header.items() if key != broken})))
        (Path(folder.name) / "forged.h5").unlink()

        def added(file):
            file.attrs["license"] = "CC0-1.0"
            file.attrs["mine"] = [1.0, 2.0]
            file["notes"] = np.arange(3)
        self.assertEqual(thermorig.Session(altered_file(first, added)).licence, "CC0-1.0")

    def test_that_are_special_files_are_refused_or_skipped_as_the_program_does(self):
        there = Path(folder.name) / "special"
        there.mkdir()
        source = Path(opened()[0].path)
        (there / "sound.h5").write_bytes(source.read_bytes())
        (there / "folder.h5").mkdir()
        os.mkfifo(there / "pipe.h5")
        os.symlink("nowhere", there / "dangling.h5")
        os.symlink("loop.h5", there / "loop.h5")
        os.symlink("/dev/null", there / "device.h5")
        self.assertEqual([session.path for session in thermorig.open_sessions(there)], [str(there / "sound.h5")])
        self.assertEqual(len(run("list", there, "--json")[0]), 1)
        for name in ("pipe", "device", "folder"):
            with self.subTest(name), self.assertRaisesRegex(thermorig.NotASession, f"{name}.h5"):
                thermorig.Session(there / f"{name}.h5")
        for name in ("dangling", "loop", "missing"):
            with self.subTest(name), self.assertRaisesRegex(OSError, f"{name}.h5"):
                thermorig.Session(there / f"{name}.h5")
        for name, data in {"empty": b"", "cut": source.read_bytes()[:100_000]}.items():
            (there / f"{name}.h5").write_bytes(data)
            with self.subTest(name), self.assertRaisesRegex(thermorig.NotASession, f"{name}.h5"):
                thermorig.Session(there / f"{name}.h5")


class TheWindows(unittest.TestCase):
    def test_are_as_many_as_train_counts(self):
        sessions = opened()
        for frames in (2, 3, 6):
            data = thermorig.windows(sessions, frames)
            start = run("train", recordings, "-o", f"count{frames}.onnx", "--nf", frames, "--epochs", 1, "--json")[0]
            self.assertEqual(len(data), start["data"]["windows"])
            self.assertEqual(start["label"], "commanded")
            for environment in ("garden", "kitchen"):
                of_it = [name.startswith(environment) for name in data.names]
                self.assertEqual(int(np.array(of_it)[data.session].sum()),
                                 start["environments"][environment]["windows"])

    def test_have_the_scaling_that_train_keeps_in_its_model(self):
        run("train", recordings, "-o", "scaling.onnx", "--epochs", 1, "--preset", "paper", "--json")
        facts = {entry.key: entry.value for entry in onnx.load(Path(folder.name) / "scaling.onnx").metadata_props}
        scaling = thermorig.scaling_of(opened())
        self.assertEqual(np.float32(facts["temp_mean_c"]), np.float32(scaling.temp_mean_c))
        self.assertEqual(np.float32(facts["temp_deviation_c"]), np.float32(scaling.temp_deviation_c))

    def test_lie_within_one_run_and_end_where_a_longer_history_lets_them(self):
        session = opened()[0]
        data = thermorig.windows(session, 3)
        for last in data.last.astype(int):
            self.assertEqual(len(set(session.run[last - 2:last + 1])), 1)
            self.assertTrue(session.valid[last - 2:last + 1].all())
        np.testing.assert_array_equal(thermorig.windows(session, 2, history=6).last, thermorig.windows(session, 6).last)

    def test_leave_out_frames_with_numbers_that_are_not_sound(self):
        session = opened()[0]
        victims = thermorig.windows(session, 3).last[:3].astype(int)

        def spoil(file):
            file["camera/temperature"][victims[0], 5, 5] = 400.5
            file["samples/rate_gyro"][victims[1]] = np.nan
            file["samples/rate_commanded"][victims[2]] = -10_001
        spoilt = altered_copy(session, spoil)
        np.testing.assert_array_equal(spoilt.run[victims], 0)
        self.assertFalse(set(victims) & set(thermorig.windows(spoilt, 2).last.astype(int)))

    def test_turn_the_other_way_when_flipped(self):
        data = thermorig.windows(opened(), 3, 2)
        flipped = data.flipped()
        np.testing.assert_array_equal(flipped.images[:, :, :, 0], data.images[:, :, :, -1])
        np.testing.assert_array_equal(flipped.label_dps, -data.label_dps)
        np.testing.assert_array_equal(flipped.gyro_dps, -data.gyro_dps)

    def test_can_do_without_the_bias_of_the_gyro_and_learn_the_shafts_speed(self):
        session = opened()[0]
        raw, freed = (thermorig.windows(session, 3, remove_bias=remove) for remove in (False, True))
        np.testing.assert_allclose(raw.gyro_dps - freed.gyro_dps, session.gyro_bias_dps.value, atol=1e-4)
        for label in ("rate_shaft", "corrected"):
            other = thermorig.windows(session, 3, label=label)
            np.testing.assert_array_equal(other.last, raw.last)
            self.assertFalse((other.label_dps == raw.label_dps).all())

    def test_of_a_session_come_back_by_its_name(self):
        sessions = opened()
        data = thermorig.windows(sessions, 3)
        np.testing.assert_array_equal(data.of("kitchen_acq-01").images, thermorig.windows(sessions[2], 3).images)


class ThePage(unittest.TestCase):
    def test_runs_as_it_stands(self):
        blocks = re.findall(r"```python\n(.*?)```", (SOURCE / "docs/python.md").read_text(), re.S)
        blocks = [block for block in blocks if "# needs torch" not in block]
        self.assertGreaterEqual(len(blocks), 3)
        before = os.getcwd()
        os.chdir(folder.name)
        try:
            for block in blocks:
                with contextlib.redirect_stdout(io.StringIO()) as printed, warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # h5netcdf's of names, pandas' of what it will deprecate
                    exec(compile(block, "docs/python.md", "exec"), {})
                self.assertTrue(printed.getvalue())
        finally:
            os.chdir(before)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
