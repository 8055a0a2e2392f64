# SPDX-License-Identifier: MIT
"""The rows of the hard table: which worlds, and which words name what is wrong in them."""
import dataclasses
import fnmatch
import re

ENVIRONMENTS = ("laboratory", "dining", "kitchen", "garden")

# A knob that does nothing without another one, and what it is turned with.
COMPANIONS = {
    "servo.ripple_period_deg": "servo.ripple=0.03",
    "clock.wave_period_s": "clock.wave_ppm=40",
    "links.stall_interval_s": "links.stall_ms=200",
    "gyro.self_heating_k": "gyro.bias_per_k_dps=0.3",
    "gyro.self_heating_s": "gyro.self_heating_k=10,gyro.bias_per_k_dps=0.3",
    "gyro.bias_per_k_dps": "gyro.self_heating_k=10",
    "gyro.scale_per_k": "gyro.self_heating_k=10",
    "camera.lever_arm_m": "scene.distance_m=0.7",
    "scene.distance_m": "camera.lever_arm_m=0.05",
}

# What these change is measured by a calibration in the same world. Each has rows of its own in which the rig was
# calibrated in the honest world and has changed since: yesterday's profile.
CHANGES_AFTER_CALIBRATION = ("gyro.scale_change", "camera.extra_latency_ms")

# Nothing of a mix stands at an end of its range: several effects that one rig may well have together.
MIXES = {
    "mix: worn servo, filtered gyro": "servo.damping=0.45,servo.backlash_deg=1.5,servo.ripple=0.01,"
                                      "servo.top_speed_dps=190,gyro.bandwidth_hz=20,gyro.vibration_dps=1",
    "mix: busy computer, resonator": "clock.error_ppm=3000,clock.wave_ppm=20,links.baud_error=0.01,"
                                     "links.hub_delay_ms=1.5,links.hub_jitter_ms=1.5,links.stall_ms=100,"
                                     "links.host_slew_ppm=200,links.read_delay_ms=3",
    "mix: eleven at once": "servo.damping=0.5,servo.stick_deg=1,servo.ripple=0.01,clock.warm_up_ppm=150,"
                           "links.baud_error=0.01,links.hub_delay_ms=1,gyro.bandwidth_hz=40,gyro.vibration_dps=0.5,"
                           "camera.rolling_rows=0.3,camera.pitch_error=0.015,scene.person_dps=20",
}

# What whoever built the rig or wrote its profile got wrong: each is to be named, and no label silently wrong.
MISTAKES = ("gyro.unit=0.01745", "gyro.unit=57.3", "gyro.unit=16.4", "gyro.unit=0.125", "gyro.unit=0.25",
            "gyro.unit=0.5", "gyro.unit=2", "gyro.unit=4", "gyro.unit=8", "gyro.mounted_deg=30", "gyro.mounted_deg=90")

_SERVO_SLOW = r"supply|\bload\b|\bweak|\breach|too slow|top speed"
_SERVO_LOOP = r"damping|overshoot|\bring|servo's (own )?loop|servo follows"
_GEAR = r"\bgear|ripple|uneven|backlash|\bplay\b"
_STICK = r"\bstick|stiction|friction|dead band|backlash|\bplay\b|uneven"
_SERVO_CLOCK = r"^(?!.*suspended).*((clock|times) of the servo|servo's clock|micro-controller's clock|resonator|quartz)"
_TIMES = r"(times|clock) of the WRONG_STREAM|\bhub\b|\bUSB\b|stall|\bbusy\b|late reads|arriv"
_HOST_CLOCK = r"host's (clock|time)|host whose time|\bslew|\bNTP\b"
_FILTER = r"filter|low.?pass|bandwidth|group delay|gyro('s| is)[^;]*(late|delay)"
_BIAS = r"bias[^;]*(drift|mov|change|rest|warm|temperature)|drift[^;]*bias|warms? up"
_SCALE = r"scale"
_CAMERA_LATE = r"camera('s| is|'s times are)?[^;]*(late|later|earlier|latency|delay|offset)|calibrate latency"
_HALVES = (r"camera's (messages|frames) (were lost|are missing)|lost (sub)?(page|hal)|chess hal|repeat|not fresh|stale"
           r"|camera sends [0-9.]+ frames")
_IMAGE = r"\bimages?\b|field of view|\blens\b|distort|optics"

# Which words of a verdict name the cause, by knob: searched in any case. One that speaks of the effect alone ("gyro
# and servo disagree") does not: nobody knows from it what to look at. Nor does one that blames what is innocent (a host
# that was suspended). WRONG_STREAM: what is told of the times of one device does not warn of another's.
CAUSES = {
    "servo.damping": _SERVO_LOOP,
    "servo.backlash_deg": _GEAR,
    "servo.stick_deg": _STICK,
    "servo.cold_friction_deg": _STICK,
    "servo.dead_band_deg": _STICK,
    "servo.load_deg": rf"{_GEAR}|\bload\b|balance",
    "servo.ripple": _GEAR,
    "servo.ripple_period_deg": _GEAR,
    "servo.top_speed_dps": _SERVO_SLOW,
    "servo.supply_sag": _SERVO_SLOW,
    "clock.error_ppm": _SERVO_CLOCK,
    "clock.warm_up_ppm": _SERVO_CLOCK,
    "clock.wave_ppm": _SERVO_CLOCK,
    "clock.wave_period_s": _SERVO_CLOCK,
    "links.baud_error": rf"{_TIMES}|baud",
    "links.hub_delay_ms": _TIMES,
    "links.hub_jitter_ms": _TIMES,
    "links.stall_ms": _TIMES,
    "links.stall_interval_s": _TIMES,
    "links.frame_jitter_ms": _TIMES,
    "links.read_delay_ms": _TIMES,
    "links.host_slew_ppm": _HOST_CLOCK,
    "gyro.bandwidth_hz": _FILTER,
    "gyro.cross_axis": rf"{_SCALE}|\baxis|\baxes",
    "gyro.g_sensitivity_dps": rf"{_BIAS}|gravity|\blean",
    "gyro.self_heating_k": _BIAS,
    "gyro.self_heating_s": _BIAS,
    "gyro.bias_per_k_dps": _BIAS,
    "gyro.scale_per_k": rf"{_SCALE}|warms? up|temperature",
    "gyro.scale_change": _SCALE,
    "gyro.vibration_dps": r"vibrat|shak|\bgear|noise",
    "gyro.zero_below_dps": r"zeroes itself",
    "gyro.unit": r"rad/s|counts|\brange\b|\bunit\b|varies by",
    "gyro.mounted_deg": r"\baxis\b|round|\bleans\b",
    "camera.rolling_rows": r"\broll|\brows?\b",
    "camera.lost_subpages": _HALVES,
    "camera.repeated_frames": _HALVES,
    "camera.membrane_lag_ms": _CAMERA_LATE,
    "camera.extra_latency_ms": _CAMERA_LATE,
    "camera.tilt_deg": rf"{_IMAGE}|\btilt|\blean",
    "camera.roll_deg": rf"{_IMAGE}|\broll|turned about",
    "camera.lever_arm_m": rf"{_IMAGE}|parallax|lever",
    "camera.pitch_error": _IMAGE,
    "camera.distortion": _IMAGE,
    "camera.warm_up_k": r"warm",
    "camera.dead_pixels": r"pixel",
    "camera.turned_over": r"mirrored",
    "scene.distance_m": rf"{_IMAGE}|parallax|lever",
    "scene.person_dps": rf"{_IMAGE}|moves? in|moving|person",
    "scene.pet_dps": rf"{_IMAGE}|moves? in|moving|\bpet\b",
    "scene.sun_k": rf"{_IMAGE}|\bsun",
    "scene.contrast": rf"{_IMAGE}|contrast",
    "scene.saturation_c": rf"{_IMAGE}|saturat|pixel",
}


@dataclasses.dataclass(frozen=True)
class Row:
    """One world, and how often it is looked at."""
    name: str
    world: str
    seeds: int
    calibrated_in: str = ""  # empty: in the same world
    shift: int = 0           # of the environments over the seeds

    def environment(self, index):
        return ENVIRONMENTS[(self.shift + index) % len(ENVIRONMENTS)]


def number_text(value):
    return f"{value:g}"


def knob_rows(knobs, seeds):
    """Each knob at both ends of its range, but where that is what the honest world has."""
    rows = []
    for knob in knobs:
        if knob["name"].startswith("encoder."):
            continue  # of a sensor that these rigs do not have: shaft.sh
        name = knob["name"]
        companion = "," + COMPANIONS[name] if name in COMPANIONS else ""
        for value in (knob["low"], knob["high"]):
            if value == knob["honest"]:
                continue
            setting = f"{name}={number_text(value)}"
            world = f"honest,{setting}{companion}"
            rows.append(Row(setting, world, seeds))
            if name in CHANGES_AFTER_CALIBRATION:
                rows.append(Row(f"{setting} after calibration", world, seeds, calibrated_in="honest"))
    return rows


def all_rows(knobs, seeds, honest_seeds, typical_seeds):
    """Each begins with another environment, so that a few seeds do not always see the same one."""
    rows = [Row("honest", "honest", honest_seeds), Row("typical", "typical", typical_seeds), Row("hard", "hard", seeds)]
    rows += [Row(name, f"honest,{text}", seeds) for name, text in MIXES.items()]
    rows += knob_rows(knobs, seeds)
    rows += [Row(setting, f"honest,{setting}", seeds) for setting in MISTAKES]
    return [dataclasses.replace(row, shift=shift) for shift, row in enumerate(rows)]


def chosen(rows, pattern):
    """Rows of that name, of that knob, or that the pattern fits."""
    return [row for row in rows
            if row.name == pattern or row.name.split("=")[0] == pattern or fnmatch.fnmatch(row.name, pattern)]


def knobs_of(world):
    """Names of the knobs that a world's text turns: `honest,gyro.bandwidth_hz=20`."""
    return [part.split("=")[0] for part in world.split(",")[1:]]


def names_cause(world, sentences, wrong_streams=()):
    """Whether one of the sentences names what one of the world's knobs does. `wrong_streams`: devices whose times are
    not what they are said to be."""
    streams = f"({'|'.join(wrong_streams)})" if wrong_streams else "(?!)"
    return any(re.search(CAUSES[knob].replace("WRONG_STREAM", streams), sentence, re.IGNORECASE)
               for knob in knobs_of(world) for sentence in sentences)
