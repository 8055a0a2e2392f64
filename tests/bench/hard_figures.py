# SPDX-License-Identifier: MIT
"""The arithmetic of the hard table: sessions against the truth -> letters, figures and limits. What hard_case prints of
a session goes in; it has judged nothing, and here nothing is estimated."""
import collections
import dataclasses
import math
import re

from hard_rows import names_cause

DEVICES = ("camera", "gyro", "servo")
RIGHT_SHARE = 0.01  # of the valid frames beyond three deviations, and of any stream's times outside their bounds
LETTERS = ("a", "b", "b?", "c")  # from the best to the worst


def share(part, whole):
    return part / whole if whole else None


def rms(values):
    known = [value for value in values if value is not None]
    return math.sqrt(sum(value * value for value in known) / len(known)) if known else None


def quantile(values, part):
    """The value below which that part of them lies; None of nothing."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))] if ordered else None


def beyond_three(errors, uncertainties):
    """How many labels are wrong by more than three of their deviations. One that is no number, or states none, is."""
    return sum(error is None or uncertainty is None or abs(error) > 3.0 * uncertainty
               for error, uncertainty in zip(errors, uncertainties, strict=True))


def outside_shares(case):
    return {device: share(case["times"][device]["outside"], case["times"][device]["samples"]) for device in DEVICES}


def is_small(part):
    """A share of nothing is none: without valid frames, or without a sample of a stream, nothing could be right."""
    return part is not None and part <= RIGHT_SHARE


def labels_are_right(case):
    labels = case["labels"]
    return is_small(share(beyond_three(labels["shaft_dps"], labels["uncertainty_dps"]), len(labels["shaft_dps"])))


def wrong_streams(case):
    """Devices whose times are not what they are said to be."""
    return [device for device, part in outside_shares(case).items() if not is_small(part)]


def sentences_of(case):
    """All that the user is told where a session is not good: the verdict's reasons, or why nothing was recorded."""
    if case["refusal"]:
        return [case["refusal"]]
    return [*case["verdict_reasons"], *([case["message"]] if case["message"] else [])]


def letter_of(case):
    """a: right. b: not right, but the verdict says so and why. b?: it says so, but not why. c: silently wrong."""
    streams = []
    if not case["refusal"]:
        streams = wrong_streams(case)
        if not streams and labels_are_right(case):
            return "a"
        if case["verdict"] == "good":
            return "c"
    return "b" if names_cause(case["world"], sentences_of(case), streams) else "b?"


def without_numbers(sentence):
    return re.sub(r"\d[\d.,]*", "N", sentence)


def verdict_of(case):
    return "refused" if case["refusal"] else case["verdict"]


def words_of(cases):
    """Verdicts, and each different sentence once, numbers apart: the first as it was said."""
    verdicts = collections.Counter(verdict_of(case) for case in cases)
    text = ", ".join(f"{verdict} {count}" for verdict, count in verdicts.most_common())
    sentences, counts = {}, collections.Counter()
    for case in cases:
        for sentence in sentences_of(case):
            sentences.setdefault(without_numbers(sentence), sentence)
            counts[without_numbers(sentence)] += 1
    for kind, count in counts.most_common(4):
        text += f"; {sentences[kind]}" + (f" ({count} times)" if count > 1 else "")
    refused = collections.Counter(one["name"] for case in cases for one in case["refused_calibrations"])
    for name, count in refused.items():
        text += f"; calibrate {name} refused {count} of {len(cases)}"
    return text.replace("|", "/")


@dataclasses.dataclass
class RowFigures:
    """Of all sessions of a row together; None: there was nothing to measure."""
    sessions: int
    letters: collections.Counter
    verdicts: collections.Counter
    label_rms_dps: float | None
    beyond_share: float | None
    sigma_dps: float | None
    commanded_rms_dps: float | None
    rejected_share: float | None
    useless_share: float | None  # of the frames: the world's own doing, by the truth
    needless_share: float | None  # rejected though they are not useless
    p99_ms: dict
    outside: dict
    words: str

    def letter(self):
        return max(self.letters, key=LETTERS.index)


def figures_of(cases):
    """Frames and samples of all its sessions count alike."""
    recorded = [case for case in cases if not case["refusal"]]
    labels = [case["labels"] for case in recorded]
    errors = [error for one in labels for error in one["shaft_dps"]]
    sigmas = [sigma for one in labels for sigma in one["uncertainty_dps"]]
    frames = sum(one["frames"] for one in labels)
    times = {device: [case["times"][device] for case in recorded] for device in DEVICES}
    return RowFigures(
        sessions=len(cases),
        letters=collections.Counter(letter_of(case) for case in cases),
        verdicts=collections.Counter(verdict_of(case) for case in cases),
        label_rms_dps=rms(errors),
        beyond_share=share(beyond_three(errors, sigmas), len(errors)),
        sigma_dps=quantile([sigma for sigma in sigmas if sigma is not None], 0.5),
        commanded_rms_dps=rms([error for one in labels for error in one["commanded_dps"]]),
        rejected_share=share(frames - len(errors), frames),
        useless_share=share(sum(one["useless"] for one in labels), frames),
        needless_share=share(frames - len(errors) - sum(one["rejected_useless"] for one in labels), frames),
        p99_ms={device: quantile([size for one in times[device] for size in one["quantiles_ms"]], 0.99)
                for device in DEVICES},
        outside={device: share(sum(one["outside"] for one in times[device]),
                               sum(one["samples"] for one in times[device])) for device in DEVICES},
        words=words_of(cases))


@dataclasses.dataclass
class Limit:
    """Something that the whole table must show."""
    key: str
    text: str
    value: float | None  # None: the rows for it were not made
    at_most: float | None = None
    at_least: float | None = None
    unit: str = ""

    def verdict(self):
        if self.value is None:
            return "not measured"
        met = ((self.at_most is None or self.value <= self.at_most)
               and (self.at_least is None or self.value >= self.at_least))
        return "PASS" if met else "MISS"


def percent(part):
    return None if part is None else 100.0 * part


def letters_of(rows):
    return sum((figures.letters for figures in rows.values()), collections.Counter())


def named_share(letters):
    """Of the sessions that are not right but say so: those that say why. None of them: nothing was left unnamed."""
    told = letters["b"] + letters["b?"]
    return letters["b"] / told if told else 1.0


def sigma_ratio(figures):
    """How wide what is stated is for what it is."""
    if figures is None or not figures.label_rms_dps or figures.sigma_dps is None:
        return None
    return figures.sigma_dps / figures.label_rms_dps


def limits_of(rows):
    """`rows`: RowFigures by the row's name."""
    letters, typical, honest = letters_of(rows), rows.get("typical"), rows.get("honest")

    def of(figures, value):
        return None if figures is None else value(figures)

    def good(figures):
        return percent(figures.verdicts["good"] / figures.sessions)

    return [
        Limit("silently_wrong", "sessions that are silently wrong (c)", letters["c"] if rows else None, at_most=0),
        Limit("cause_named_percent", "cause named where a session is not right", percent(named_share(letters)),
              at_least=90, unit="%"),
        Limit("typical_label_rms_dps", "typical: label RMS", of(typical, lambda row: row.label_rms_dps), at_most=0.3,
              unit="deg/s"),
        Limit("typical_coverage_percent", "typical: valid frames within 3 stated sigma",
              of(typical, lambda row: None if row.beyond_share is None else 100.0 * (1.0 - row.beyond_share)),
              at_least=99.5, unit="%"),
        Limit("typical_rejected_percent", "typical: frames rejected",
              of(typical, lambda row: percent(row.rejected_share)), at_most=10, unit="%"),
        Limit("typical_good_percent", "typical: verdict good", of(typical, good), at_least=80, unit="%"),
        Limit("honest_false_alarm_percent", "honest: verdict not good, or refused",
              of(honest, lambda row: 100.0 - good(row)), at_most=2, unit="%"),
        Limit("typical_sigma_ratio", "typical: median stated sigma over RMS error", sigma_ratio(typical), at_most=2),
        Limit("honest_sigma_ratio", "honest: median stated sigma over RMS error", sigma_ratio(honest), at_most=2),
    ]
