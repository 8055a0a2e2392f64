# SPDX-License-Identifier: MIT
"""The judge's own arithmetic: letters, figures and limits of the hard table, and that it has a row for every knob.

    python3 tests/hard_table_test.py
"""
import collections
import pathlib
import re
import sys
import unittest

TESTS = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(TESTS / "bench"))
import hard_figures
import hard_rows
import hard_table


def times(outside=0, samples=1000, sizes=(0.1, 0.2)):
    return {"samples": samples, "outside": outside, "mean_ms": 0.0, "quantiles_ms": list(sizes)}


def session(world="honest,gyro.bandwidth_hz=5", verdict="good", reasons=(), errors=(0.1,) * 200, sigma=0.1, frames=None,
            useless=0, outside=None, refusal="", message=""):
    """What hard_case prints of a session; that of an honest one unless told otherwise."""
    outside = outside or {}
    return {"world": world, "refusal": refusal, "verdict": verdict, "verdict_reasons": list(reasons), "message": message,
            "refused_calibrations": [],
            "labels": {"frames": frames or len(errors), "useless": useless, "rejected_useless": useless,
                       "shaft_dps": list(errors),
                       "uncertainty_dps": [sigma] * len(errors), "commanded_dps": [1.0] * len(errors)},
            "times": {device: times(outside.get(device, 0)) for device in hard_figures.DEVICES}}


def refused(why, world="honest,camera.lost_subpages=0.33"):
    return {"world": world, "refusal": why, "refused_calibrations": []}


def knobs_of_document():
    """Names of the knobs, as docs/worlds.md lists them; a test of the simulation holds that against the program."""
    text = (TESTS.parent / "docs" / "worlds.md").read_text(encoding="utf-8")
    return re.findall(r"^\| `([a-z]+\.[a-z_]+)` \|", text, re.MULTILINE)


class Letters(unittest.TestCase):
    def test_right_is_a_whatever_the_verdict(self):
        self.assertEqual(hard_figures.letter_of(session()), "a")
        self.assertEqual(hard_figures.letter_of(session(verdict="bad", reasons=["no idea"])), "a")

    def test_one_percent_of_labels_beyond_three_deviations_is_right_and_more_is_not(self):
        self.assertEqual(hard_figures.letter_of(session(errors=[0.31] * 2 + [0.1] * 198)), "a")
        self.assertEqual(hard_figures.letter_of(session(errors=[0.31] * 3 + [0.1] * 197)), "c")

    def test_one_percent_of_the_times_of_any_device_outside_is_right_and_more_is_not(self):
        for device in hard_figures.DEVICES:
            self.assertEqual(hard_figures.letter_of(session(outside={device: 10})), "a")
            self.assertEqual(hard_figures.letter_of(session(outside={device: 11})), "c")

    def test_a_label_without_a_number_or_an_uncertainty_is_wrong(self):
        self.assertEqual(hard_figures.beyond_three([None, 0.1, 0.1, -0.4, 0.3], [0.1, None, 0.1, 0.1, 0.1]), 3)

    def test_wrong_and_told_is_b_only_with_its_cause(self):
        wrong = {"outside": {"gyro": 1000}, "verdict": "usable"}
        self.assertEqual(hard_figures.letter_of(session(reasons=["the gyro's filter: 5 Hz?"], **wrong)), "b")
        self.assertEqual(hard_figures.letter_of(session(reasons=["gyro and servo disagree in 20 % of the frames"], **wrong)),
                         "b?")

    def test_nothing_valid_is_not_right(self):
        nothing = session(errors=(), frames=100, verdict="bad", reasons=["no frame is valid"])
        self.assertEqual(hard_figures.letter_of(nothing), "b?")
        self.assertEqual(hard_figures.letter_of(session(errors=(), frames=100)), "c")

    def test_a_refusal_says_that_something_is_wrong_and_may_say_what(self):
        self.assertEqual(hard_figures.letter_of(refused("4.2 % of the camera's frames are missing")), "b")
        self.assertEqual(hard_figures.letter_of(refused("the disk is full")), "b?")

    def test_the_letter_of_a_row_is_that_of_its_worst_session(self):
        for letters, worst in (("aab", "b"), (("a", "b?", "b"), "b?"), (("c", "b?"), "c")):
            row = hard_figures.figures_of([session()])
            row.letters = collections.Counter(letters)
            self.assertEqual(row.letter(), worst)


class Causes(unittest.TestCase):
    def test_what_is_said_of_one_devices_times_does_not_warn_of_anothers(self):
        said = ["the times of the servo are known to 1.0 ms only"]
        world = "honest,links.hub_delay_ms=3"
        self.assertTrue(hard_rows.names_cause(world, said, ["servo"]))
        self.assertTrue(hard_rows.names_cause(world, said, ["camera", "servo"]))
        self.assertFalse(hard_rows.names_cause(world, said, ["camera"]))
        self.assertFalse(hard_rows.names_cause(world, said))

    def test_a_clock_that_is_put_down_to_a_suspended_host_is_not_named(self):
        world, began = "honest,clock.warm_up_ppm=-300", "the clock of the servo began anew: "
        self.assertFalse(hard_rows.names_cause(world, [began + "the host was suspended"]))
        self.assertTrue(hard_rows.names_cause(world, [began + "a clock that wanders"]))

    def test_only_knobs_that_are_turned_count(self):
        said = ["the gyro's scale changed"]
        self.assertTrue(hard_rows.names_cause("honest,gyro.scale_change=0.01", said))
        self.assertFalse(hard_rows.names_cause("honest,camera.rolling_rows=1", said))
        self.assertFalse(hard_rows.names_cause("honest", said))

    def test_every_knob_has_words(self):
        self.assertEqual(sorted(hard_rows.CAUSES), sorted(knobs_of_document()))
        for pattern in hard_rows.CAUSES.values():
            re.compile(pattern)


class Rows(unittest.TestCase):
    KNOBS = ({"name": "servo.damping", "honest": 0.7, "low": 0.3, "high": 1.2},
             {"name": "clock.wave_period_s", "honest": 300, "low": 60, "high": 1200},
             {"name": "gyro.scale_change", "honest": 0, "low": -0.01, "high": 0.01},
             {"name": "camera.extra_latency_ms", "honest": 0, "low": 0, "high": 30})

    def rows(self):
        return {row.name: row for row in hard_rows.all_rows(self.KNOBS, seeds=5, honest_seeds=100, typical_seeds=50)}

    def test_each_knob_stands_at_both_ends_but_where_that_is_honest(self):
        rows = self.rows()
        self.assertEqual(rows["servo.damping=0.3"].world, "honest,servo.damping=0.3")
        self.assertIn("servo.damping=1.2", rows)
        self.assertIn("camera.extra_latency_ms=30", rows)
        self.assertNotIn("camera.extra_latency_ms=0", rows)

    def test_a_knob_that_needs_another_has_it(self):
        self.assertEqual(self.rows()["clock.wave_period_s=60"].world, "honest,clock.wave_period_s=60,clock.wave_ppm=40")

    def test_what_a_calibration_measures_changes_after_it_as_well(self):
        rows = self.rows()
        for name in ("gyro.scale_change=-0.01", "gyro.scale_change=0.01", "camera.extra_latency_ms=30"):
            self.assertEqual(rows[name].calibrated_in, "")
            self.assertEqual(rows[name + " after calibration"].calibrated_in, "honest")
            self.assertEqual(rows[name + " after calibration"].world, rows[name].world)

    def test_honest_and_typical_have_seeds_of_their_own_number(self):
        rows = self.rows()
        self.assertEqual((rows["honest"].seeds, rows["typical"].seeds, rows["hard"].seeds), (100, 50, 5))

    def test_five_seeds_see_all_environments(self):
        for row in self.rows().values():
            self.assertEqual({row.environment(index) for index in range(5)}, set(hard_rows.ENVIRONMENTS))

    def test_mixes_and_companions_name_knobs_that_there_are(self):
        known = set(knobs_of_document())
        for text in (*hard_rows.MIXES.values(), *hard_rows.COMPANIONS.values()):
            self.assertLessEqual(set(hard_rows.knobs_of("honest," + text)), known)
        self.assertLessEqual({*hard_rows.COMPANIONS, *hard_rows.CHANGES_AFTER_CALIBRATION}, known)

    def test_only_takes_a_knob_or_a_pattern(self):
        rows = list(self.rows().values())
        self.assertEqual(len(hard_rows.chosen(rows, "gyro.scale_change")), 4)  # after calibration as well
        self.assertEqual(len(hard_rows.chosen(rows, "gyro.scale_*")), 4)
        self.assertEqual([row.name for row in hard_rows.chosen(rows, "typical")], ["typical"])


class Figures(unittest.TestCase):
    def test_frames_and_samples_of_all_sessions_count_alike(self):
        few = session(errors=[3.0] * 100, frames=200, useless=60, sigma=0.5, outside={"camera": 500})
        many = session(errors=[-1.0] * 300, frames=300, sigma=2.0)
        row = hard_figures.figures_of([few, many])
        self.assertAlmostEqual(row.label_rms_dps, ((100 * 9.0 + 300 * 1.0) / 400) ** 0.5)
        self.assertAlmostEqual(row.beyond_share, 0.25)
        self.assertAlmostEqual(row.sigma_dps, 2.0)
        self.assertAlmostEqual(row.commanded_rms_dps, 1.0)
        self.assertAlmostEqual(row.rejected_share, 0.2)
        self.assertAlmostEqual(row.useless_share, 0.12)
        self.assertAlmostEqual(row.needless_share, 0.08)
        self.assertAlmostEqual(row.outside["camera"], 0.25)
        self.assertEqual(row.letters, {"c": 1, "a": 1})

    def test_the_99th_percentile_is_of_all_samples(self):
        one, other = session(), session()
        one["times"]["gyro"] = times(sizes=[0.1] * 98 + [7.0, 9.0])
        other["times"]["gyro"] = times(sizes=[0.2] * 100)
        self.assertEqual(hard_figures.figures_of([one]).p99_ms["gyro"], 9.0)
        self.assertEqual(hard_figures.figures_of([one, other]).p99_ms["gyro"], 7.0)

    def test_a_refused_session_has_no_frames_but_counts_as_a_session(self):
        row = hard_figures.figures_of([refused("no camera"), session()])
        self.assertEqual((row.sessions, row.verdicts["refused"], row.verdicts["good"]), (2, 1, 1))
        self.assertAlmostEqual(row.label_rms_dps, 0.1)

    def test_without_any_session_there_is_nothing_to_measure(self):
        row = hard_figures.figures_of([refused("no camera")])
        self.assertEqual((row.label_rms_dps, row.beyond_share, row.sigma_dps, row.p99_ms["camera"]), (None,) * 4)

    def test_each_sentence_stands_once_whatever_its_numbers(self):
        words = hard_figures.words_of([session(verdict="usable", reasons=["off by 1.5 ms"]),
                                       session(verdict="usable", reasons=["off by 22 ms"])])
        self.assertEqual(words, "usable 2; off by 1.5 ms (2 times)")


class Limits(unittest.TestCase):
    def verdicts(self, **rows):
        return {limit.key: limit.verdict() for limit in
                hard_figures.limits_of({name: hard_figures.figures_of(cases) for name, cases in rows.items()})}

    def test_an_honest_table_passes(self):
        verdicts = self.verdicts(honest=[session()], typical=[session()])
        self.assertEqual(set(verdicts.values()), {"PASS"}, verdicts)

    def test_what_was_not_made_is_not_measured(self):
        verdicts = self.verdicts(honest=[session()])
        self.assertEqual(verdicts["typical_label_rms_dps"], "not measured")
        self.assertEqual(verdicts["honest_false_alarm_percent"], "PASS")

    def test_one_session_that_is_silently_wrong_is_one_too_many(self):
        many = [session()] * 99
        self.assertEqual(self.verdicts(knob=many)["silently_wrong"], "PASS")
        self.assertEqual(self.verdicts(knob=[*many, session(outside={"gyro": 1000})])["silently_wrong"], "MISS")

    def test_nine_of_ten_causes_must_be_named(self):
        wrong = {"outside": {"gyro": 1000}, "verdict": "usable"}
        named, unnamed = session(reasons=["the gyro's filter"], **wrong), session(reasons=["something"], **wrong)
        self.assertEqual(self.verdicts(knob=[named] * 9 + [unnamed])["cause_named_percent"], "PASS")
        self.assertEqual(self.verdicts(knob=[named] * 8 + [unnamed])["cause_named_percent"], "MISS")

    def test_typical_must_be_good_precise_covered_and_not_rejected(self):
        told = session(verdict="usable")
        for key, cases in (("typical_good_percent", [session()] * 3 + [told]),
                           ("typical_label_rms_dps", [session(errors=[0.31] * 200, sigma=0.31)]),
                           ("typical_coverage_percent", [session(errors=[0.31] * 2 + [0.1] * 198)]),
                           ("typical_rejected_percent", [session(frames=223)]),
                           ("typical_sigma_ratio", [session(sigma=0.21)])):
            missed = {name for name, verdict in self.verdicts(typical=cases).items() if verdict == "MISS"}
            self.assertEqual(missed, {key})

    def test_labels_without_any_uncertainty_have_no_ratio_and_are_not_covered(self):
        verdicts = self.verdicts(typical=[session(sigma=None)])
        self.assertEqual(verdicts["typical_sigma_ratio"], "not measured")
        self.assertEqual(verdicts["typical_coverage_percent"], "MISS")

    def test_false_alarms_are_verdicts_that_are_not_good_and_refusals(self):
        for alarm in (session(verdict="usable"), refused("no", world="honest")):
            self.assertEqual(self.verdicts(honest=[session()] * 49 + [alarm])["honest_false_alarm_percent"], "PASS")
            self.assertEqual(self.verdicts(honest=[session()] * 48 + [alarm])["honest_false_alarm_percent"], "MISS")


class Json(unittest.TestCase):
    def test_keys_are_snake_case_and_low_and_high_ends_are_told_apart(self):
        figures = {name: hard_figures.figures_of([session()])
                   for name in ("honest", "camera.tilt_deg=-5", "camera.tilt_deg=5", "mix: eleven at once")}
        printed = hard_table.json_of(figures, hard_figures.limits_of(figures))
        self.assertEqual(len(printed), sum(len(list(hard_table.values_of(row))) for row in figures.values()) + 9)
        for key in printed:
            self.assertRegex(key, r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$")
        self.assertEqual(printed["honest_label_rms_dps"]["value"], figures["honest"].label_rms_dps)
        self.assertIn("camera_tilt_deg_minus_5_label_rms_dps", printed)
        self.assertEqual(printed["limit_typical_good_percent"]["met"], None)


if __name__ == "__main__":
    unittest.main()
