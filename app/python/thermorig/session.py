# SPDX-License-Identifier: MIT
"""One session file."""

from __future__ import annotations

import datetime
import hashlib
import json
import math
import os
import re
from functools import cached_property
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.typing import NDArray

from .checks import NotASession, require_regular, require_unaltered

LABELS = ("rate_commanded", "rate_corrected", "rate_shaft", "rate_measured")  # columns; `train --label` has the words behind "rate_"
PIXELS_C = (-60.0, 400.0)  # beyond them a pixel is no temperature
MARK = 10  # of /events/kind
NOTE, ENVIRONMENT = 0, 1  # of /annotations/kind
FASTEST_DPS = 10_000.0  # beyond it a rate is none
VERDICTS = ("good", "usable", "bad")
COLUMNS = ("time", "exposure_begin", "exposure_end", "rate_commanded", "rate_gyro", "valid", "run", "leg", "reason_bits")


class BadSession(ValueError):
    """The session's verdict is bad."""


class Estimate(NamedTuple):
    """A figure and its standard deviation."""

    value: float
    uncertainty: float


class Session:
    """A session file, open for reading. All of it is held against its check sums, then everything is read when it
    is asked for, and kept.

    `file` is the file itself, for whatever has no name here: `session.file["servo/angle_commanded"][:]`.
    Raises NotASession for whatever is no session, or none any more; FileNotFoundError and PermissionError.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = os.fspath(path)
        self.file = _opened(self.path)
        try:
            self._require_format()
            require_unaltered(self.file)
            self._header: dict[str, Any] = json.loads(self.file["rig"].attrs["header_json"])
            self._require_parts()
        except NotASession:
            self.file.close()
            raise
        except Exception as error:  # whatever a damaged file makes of h5py
            self.file.close()
            raise NotASession(f"{self.path}: is damaged, or was changed: {error}") from error

    def _require_format(self) -> None:
        if self.file.attrs.get("format") != "thermorig-session":
            raise NotASession(f"{self.path}: is no session of thermorig")
        version = str(self.file.attrs["format_version"])
        if version.split(".")[0] != "2":
            raise NotASession(
                f"{self.path}: is a session of format {version}, this package reads format 2: thermorig reprocess "
                f"{self.path}")

    def _require_parts(self) -> None:
        for said in ("name", "uuid", "start", "world", "plan", "notes", "for_calibration", "verdict_reasons",
                     "gyro_bias_dps", "gyro_scale", "mirrored", "leg_dps"):
            getattr(self, said)
        rows = (len(self),)
        wrong = [name for name in COLUMNS if self.file["samples"][name].shape != rows]
        if wrong or self.file["camera/temperature"].shape != (*rows, 24, 32):
            raise ValueError(f"the tables have other shapes: {wrong or 'temperature'}")
        if self.verdict not in VERDICTS:
            raise ValueError(f"the verdict is none: {self.verdict}")

    def close(self) -> None:
        self.file.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<thermorig.Session {self.name}{', simulated' if self.simulated else ''}: {self.path}>"

    # What it is.

    @property
    def environment(self) -> str:
        """Where it belongs: as it was recorded, or as `annotate --environment` said later."""
        return self._place[0]

    @property
    def acquisition(self) -> int:
        """Its number within the environment, from 1."""
        return self._place[1]

    @cached_property
    def _place(self) -> tuple[str, int]:
        for kind, text, acquisition in reversed(self._annotations):
            if kind == ENVIRONMENT:
                return text, acquisition
        return str(self._header["environment"]), int(self._header["acquisition"])

    @property
    def _annotations(self) -> list[tuple[int, str, int]]:
        if "annotations" not in self.file:
            return []
        group = self.file["annotations"]
        return [(int(kind), text.decode(), int(number))
                for kind, text, number in zip(group["kind"][:], group["text"][:], group["acquisition"][:])]

    @property
    def operator(self) -> str | None:
        return self._header.get("operator")

    @property
    def place(self) -> str | None:
        """Where exactly the rig stood."""
        return self._header.get("place")

    @property
    def notes(self) -> list[str]:
        """That of the recording, the operator's marks, and those of `annotate`."""
        first = [str(self._header["note"])] if "note" in self._header else []
        events = self.file["events"]
        marks = [text.decode() for kind, text in zip(events["kind"][:], events["message"][:]) if kind == MARK]
        return first + marks + [text for kind, text, _ in self._annotations if kind == NOTE]

    @property
    def name(self) -> str:
        """`garden_acq-01`: the name under which trainings and studies know it."""
        return f"{self.environment}_acq-{self.acquisition:02}"

    @property
    def uuid(self) -> str:
        return str(self._header["uuid"])

    @property
    def start(self) -> datetime.datetime:
        """When second 0 was, in UTC."""
        return datetime.datetime.fromisoformat(str(self._header["start_time_utc"]).replace("Z", "+00:00"))

    @property
    def simulated(self) -> bool:
        return bool(self._header["simulated"])

    @property
    def world(self) -> str | None:
        """Of a simulated rig, how hard it was: `honest`, `hard,gyro.bandwidth_hz=20`; None: real, or not known."""
        _, found, world = str(self._header.get("simulation", "")).rpartition(", world ")
        return world if found and self.simulated else None

    @property
    def plan(self) -> str:
        return str(self._header["plan_name"])

    @property
    def for_calibration(self) -> bool:
        """Was it recorded for a calibration? `train` leaves such sessions out."""
        return "\nfor_calibration = true\n" in self.file["rig/plan_toml"][()].decode()

    @property
    def licence(self) -> str | None:
        licence = str(self.file.attrs.get("license", ""))
        return None if licence in ("", "not stated") else licence

    @property
    def verdict(self) -> str:
        """`good`, `usable` or `bad`."""
        return str(self.file["quality"].attrs["verdict"])

    @property
    def verdict_reasons(self) -> list[str]:
        return [str(reason) for reason in self.file["quality"].attrs.get("verdict_reasons", [])]

    # Frames. A row a frame, N of them.

    def __len__(self) -> int:
        return int(self.file["samples/time"].shape[0])

    def column(self, name: str) -> NDArray[Any]:
        """A column of /samples, a row a frame: `rate_commanded`, `reason_bits`, `leg`, ..."""
        return np.asarray(self.file["samples"][name][:])

    def label(self, name: str = "rate_commanded") -> NDArray[np.float32]:
        """Speed in deg/s, NaN where it is not known, by its column or by the word of `train --label`.
        `rate_commanded` ("commanded") is what was commanded, and what `train` learns unless it is told otherwise;
        `rate_corrected` is the same, corrected by what the session measured of the servo; `rate_shaft` is what the shaft did:
        measured, where a sensor on it is believed, else by the servo model; `rate_measured` is the sensor's alone, NaN where
        there is none. All are means over the frame's exposure. Without a servo each of them is the gyro's, `rate_shaft`."""
        column = "rate_shaft" if self.is_labelled_by_gyro else _label_column(name)
        if column not in self.file["samples"]:
            raise ValueError(f"{self.path}: is of a format that had no {column}: thermorig reprocess {self.path}")
        return self.column(column)

    def label_uncertainty(self, name: str = "rate_commanded") -> NDArray[np.float32]:
        """How far that label may be from the shaft's true speed: one standard deviation in deg/s, NaN: unknown."""
        return self.column(("rate_shaft" if self.is_labelled_by_gyro else _label_column(name)) + "_uncertainty")

    @cached_property
    def is_labelled_by_gyro(self) -> bool:
        """Whether its rig had no servo: its labels are the gyro's."""
        source = self.file["samples"].attrs.get("label_source", "command")
        return (source.decode() if isinstance(source, bytes) else source) == "gyro"

    @cached_property
    def shaft_sensor(self) -> str | None:
        """What measured the shaft, "AS5600" for one, whether it is believed or not; None: nothing did. Each of its readings:
        `table("shaft")`."""
        sensor = self.file["shaft"].attrs["sensor"] if "shaft" in self.file else None
        return sensor.decode() if isinstance(sensor, bytes) else sensor

    @cached_property
    def shaft_deg(self) -> NDArray[np.float64]:
        """(N) where that sensor had the shaft at `middle_s`, in degrees, turns counted; NaN where it did not."""
        return self.column("angle_measured") if self.shaft_sensor else np.full(len(self), np.nan)

    @cached_property
    def gyro_dps(self) -> NDArray[np.float32]:
        """(N) mean of the gyro over each frame's exposure, about the servo's axis. Its bias is in it."""
        return self.column("rate_gyro")

    @cached_property
    def middle_s(self) -> NDArray[np.float64]:
        """(N) seconds since `start` in the middle of the exposure of each frame's newest half: `/samples/time`."""
        return self.column("time")

    @cached_property
    def exposure_begin_s(self) -> NDArray[np.float64]:
        """(N) begin of the exposure of the older half. Labels and gyro means are over begin to end."""
        return self.column("exposure_begin")

    @cached_property
    def exposure_end_s(self) -> NDArray[np.float64]:
        """(N) end of the exposure of the newest half: `/camera/time`."""
        return self.column("exposure_end")

    @cached_property
    def frames_c(self) -> NDArray[np.float32]:
        """(N, 24, 32) degrees Celsius, bad pixels filled from those around: that is what networks are fed with. As
        the camera sent them: `file["camera/temperature"]`."""
        return _mended(np.asarray(self.file["camera/temperature"][:]), self.bad_pixels)

    @cached_property
    def bad_pixels(self) -> list[tuple[int, int]]:
        """Row and column, from 0, of each dead, stuck or hot pixel that was found."""
        text = str(self.file["sync"].attrs.get("camera_bad_pixels", "")) if "sync" in self.file else ""
        return [(int(row), int(column)) for row, column in re.findall(r"(\d+),(\d+)", text)
                if int(row) < 24 and int(column) < 32]

    @property
    def mirrored(self) -> bool:
        """Is what the camera sends a mirror image of the scene?"""
        return bool(self.file["rig/profile/camera"].attrs["mirrored"])

    @property
    def upright_c(self) -> NDArray[np.float32]:
        """(N, 24, 32) as somebody beside the camera sees the scene: for people, not for networks of `train`."""
        return self.frames_c[:, :, ::-1] if self.mirrored else self.frames_c

    @cached_property
    def valid(self) -> NDArray[np.bool_]:
        """(N) is there no reason against the frame?"""
        return self.column("valid") == 1

    @cached_property
    def run(self) -> NDArray[np.uint32]:
        """(N) unbroken run of valid frames, from 1; 0: in none. As `train` takes it: also 0 where label, gyro
        mean or a pixel is no sound number, whatever the file says."""
        run = np.where(self.valid, self.column("run"), 0).astype(np.uint32)
        with np.errstate(invalid="ignore"):
            sound = np.abs(self.label()) <= FASTEST_DPS
            sound &= np.abs(self.gyro_dps) <= FASTEST_DPS
            pixels = self.frames_c.reshape(len(self), -1)
            sound &= ((pixels >= PIXELS_C[0]) & (pixels <= PIXELS_C[1])).all(axis=1)
        run[~sound] = 0
        return run

    def run_with(self, label: str) -> NDArray[np.uint32]:
        """(N) the same, also 0 where that label is no sound number: what a training with it takes."""
        with np.errstate(invalid="ignore"):
            return np.where(np.abs(self.label(label)) <= FASTEST_DPS, self.run, 0).astype(np.uint32)

    @cached_property
    def leg_dps(self) -> NDArray[np.float32]:
        """(N) speed that the leg of the frame was to have; 0 outside legs, NaN without a servo."""
        if self.is_labelled_by_gyro:
            return np.full(len(self), np.nan, np.float32)
        rates = dict(zip(self.file["servo/step_leg"][:].tolist(), self.file["servo/step_rate"][:].tolist()))
        rates[0] = 0.0
        return np.array([rates.get(leg, 0.0) for leg in self.column("leg").tolist()], np.float32)

    def reasons(self, frame: int) -> list[str]:
        """Names of what stands against a frame: `["servo_ramp", "leg_change"]`."""
        column = self.file["samples/reason_bits"]
        names = str(column.attrs["flag_meanings"]).split()
        return [name for mask, name in zip(column.attrs["flag_masks"], names) if int(column[frame]) & int(mask)]

    # The gyro's errors: rate_gyro = scale * true rate + bias.

    @property
    def gyro_bias_dps(self) -> Estimate | None:
        """Of this recording, from its rests; None: it has none. Nothing in the file is corrected for it."""
        return self._estimate("gyro_bias_dps", "gyro_bias_uncertainty_dps")

    @property
    def gyro_scale(self) -> Estimate:
        """Calibrated, or else 1 with the uncertainty of a data sheet."""
        scale = self._estimate("gyro_scale", "gyro_scale_uncertainty")
        return scale if scale else Estimate(1.0, math.nan)

    def _estimate(self, value: str, uncertainty: str) -> Estimate | None:
        attributes = self.file["sync"].attrs
        found = Estimate(float(attributes[value]), float(attributes[uncertainty]))
        return None if math.isnan(found.value) else found

    # Beyond frames.

    def table(self, group: str = "samples") -> dict[str, NDArray[Any]]:
        """The columns of a group that have a value a row, for pandas: `pandas.DataFrame(session.table("gyro"))`."""
        rows = self.file[group]["time"].shape
        return {name: np.asarray(column[:]) for name, column in self.file[group].items()
                if isinstance(column, h5py.Dataset) and column.shape == rows}

    @cached_property
    def data_hash(self) -> str:
        """SHA-256 of what a training takes of it, whatever the file's name and date: the hash in a model file."""
        return self.learnt_hash()

    def learnt_hash(self, label: str = "rate_commanded") -> str:
        """The same with another label in place of the commanded speed: the hash in `run.json`."""
        times_ns = np.round(self.middle_s * 1e9).astype(np.int64)
        parts = [
            np.array([len(self)], np.uint64), _hashed(self.frames_c), _hashed(self.label(label)),
            _hashed(self.gyro_dps), (times_ns - times_ns[:1]).astype(np.uint64), self.run_with(label),
            _hashed(self.leg_dps),
        ]
        digest = hashlib.sha256()
        for part in parts:
            digest.update(np.ascontiguousarray(part).tobytes())
        return digest.hexdigest()


AROUND = ((-1, -1), (-1, 1), (1, -1), (1, 1), (-2, 0), (0, -2), (0, 2), (2, 0))  # of the same half-frame


def _mended(frames_c: NDArray[np.float32], bad: list[tuple[int, int]]) -> NDArray[np.float32]:
    """Each bad pixel as the mean of the good ones around it, in whole hundredths: as `train` has it, bit for bit."""
    for row, column in bad:
        total = np.zeros(len(frames_c), np.float32)
        count = np.zeros(len(frames_c), np.float32)
        for down, right in AROUND:
            other = (row + down, column + right)
            if not (0 <= other[0] < 24 and 0 <= other[1] < 32) or other in bad:
                continue
            value = frames_c[:, other[0], other[1]]
            good = np.isfinite(value)
            total += np.where(good, value, np.float32(0))
            count += good.astype(np.float32)
        some = count > 0
        hundredths = (total[some] / count[some] * np.float32(100)).astype(np.float64)
        rounded = np.copysign(np.floor(np.abs(hundredths) + 0.5), hundredths).astype(np.float32)
        frames_c[some, row, column] = rounded / np.float32(100)
    return frames_c


def _opened(path: str) -> h5py.File:
    """h5py's own sentences leave out which file it was."""
    require_regular(path)
    with open(path, "rb"):  # says itself what is not there, or not allowed
        pass
    try:
        return h5py.File(path, "r")
    except Exception as error:
        raise NotASession(f"{path}: is no HDF5 file, or cut short: {error}") from error


def _label_column(name: str) -> str:
    column = name if name in LABELS else f"rate_{name}"
    if column not in LABELS:
        raise ValueError(f"there is no label {name!r}: {', '.join(label.removeprefix('rate_') for label in LABELS)}")
    return column


def _hashed(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Processors differ in the sign of the NaN that they make."""
    return np.where(np.isnan(values), np.float32("nan"), values).astype("<f4")
