# SPDX-License-Identifier: MIT
"""The windows that a network learns from and is judged by: those of `thermorig train`, bit for bit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from .session import Session

ORIGIN_C = 25.0  # in the midst of the pixels, so that sums of squares lose no digit


@dataclass(frozen=True)
class Scaling:
    """How degrees and deg/s become a network's numbers."""

    temp_mean_c: float
    temp_deviation_c: float
    label_scale_dps: float = 200.0


@dataclass(frozen=True)
class Windows:
    """W windows of Nf frames. Images in degrees Celsius, speeds in deg/s, unless they were `normalised`."""

    images: NDArray[np.float32]  # (W, Nf, H, W), oldest frame first
    label_dps: NDArray[np.float32]  # (W) mean of the frames' labels
    gyro_dps: NDArray[np.float32]  # (W) mean of the frames' gyro means, bias in it unless it was removed
    last: NDArray[np.uint32]  # (W) index of the newest frame in its session
    session: NDArray[np.uint32]  # (W) index of the session
    middle_s: NDArray[np.float64]  # (W) middle of the newest frame's exposure, since its session's start
    names: tuple[str, ...]  # of the sessions: "garden_acq-01"

    def __len__(self) -> int:
        return len(self.last)

    def flipped(self) -> Windows:
        """The scene left to right: it turns the other way, so speeds are negated."""
        return replace(self, images=self.images[..., ::-1], label_dps=-self.label_dps, gyro_dps=-self.gyro_dps)

    def normalised(self, scaling: Scaling) -> Windows:
        """As the network takes them: (degrees - mean) / deviation, speeds over the label scale."""
        mean, deviation = np.float32(scaling.temp_mean_c), np.float32(scaling.temp_deviation_c)
        scale = np.float32(scaling.label_scale_dps)
        return replace(self, images=(self.images - mean) / deviation, label_dps=self.label_dps / scale,
                       gyro_dps=self.gyro_dps / scale)

    def of(self, name: str) -> Windows:
        """Those of one session: `data.of("garden_acq-01")`."""
        return self[self.session == self.names.index(name)]

    def __getitem__(self, chosen: NDArray[np.bool_] | NDArray[np.integer] | slice) -> Windows:
        return replace(self, images=self.images[chosen], label_dps=self.label_dps[chosen],
                       gyro_dps=self.gyro_dps[chosen], last=self.last[chosen], session=self.session[chosen],
                       middle_s=self.middle_s[chosen])


def windows(sessions: Session | Iterable[Session], frames: int = 3, reduction: int = 1, *, history: int = 0,
            label: str = "rate_commanded", remove_bias: bool = False) -> Windows:
    """All windows of `frames` (Nf, 2 to 6) consecutive frames of one run of valid frames, stride 1. A window never
    crosses a run, so never a leg, a gap or an invalid frame.

    `reduction` (Nr, 1 to 3): pixels are averaged Nr x Nr; columns that do not fill a block are cropped at the
    right. `history` >= frames: so many valid frames in a row before a window may end, so that windows of
    different lengths end at the same frames. `label`: as Session.label(), so also "corrected" or "shaft"; which
    windows there are does not depend on it, unless it is no sound number in a frame. `remove_bias`: takes the gyro's bias of the recording off, where it is known; `train` does not.
    """
    if not 1 <= frames <= 6 or not 1 <= reduction <= 3:
        raise ValueError("frames must be 1 to 6, reduction 1 to 3")
    listed = [sessions] if isinstance(sessions, Session) else list(sessions)
    parts = [_windows_of(session, index, frames, reduction, history, label, remove_bias)
             for index, session in enumerate(listed)]
    if not parts:
        raise ValueError("there is no session")
    joined = {name: np.concatenate([getattr(part, name) for part in parts])
              for name in ("images", "label_dps", "gyro_dps", "last", "session", "middle_s")}
    return Windows(**joined, names=tuple(session.name for session in listed))


def ends_of_windows(run: NDArray[np.uint32], frames: int, history: int = 0) -> NDArray[np.uint32]:
    """Indices of the frames at which a window may end."""
    needed = max(frames, history)
    ends = np.ones(max(len(run) - needed + 1, 0), bool)
    for before in range(needed):
        ends &= run[needed - 1 - before:len(run) - before] == run[needed - 1:]
    ends &= run[needed - 1:] != 0
    return (np.flatnonzero(ends) + needed - 1).astype(np.uint32)


def reduced(frames_c: NDArray[np.float32], reduction: int) -> NDArray[np.float32]:
    """(N, H, W) means of Nr x Nr neighbours, added in the order in which thermorig adds them."""
    rows, columns = (size // reduction for size in frames_c.shape[1:])
    used = frames_c[:, :rows * reduction, :columns * reduction]
    total = np.zeros((len(frames_c), rows, columns), np.float32)
    for row in range(reduction):
        for column in range(reduction):
            total += used[:, row::reduction, column::reduction]
    return total / np.float32(reduction * reduction)


def mean_rates(rates: NDArray[np.float32], last: NDArray[np.uint32], frames: int) -> NDArray[np.float32]:
    """Of the windows that end at these frames."""
    total = np.zeros(len(last), np.float64)
    for before in reversed(range(frames)):
        total += rates[last.astype(np.int64) - before]
    return (total / frames).astype(np.float32)


def scaling_of(sessions: Sequence[Session], label_scale_dps: float = 200.0) -> Scaling:
    """Mean and deviation of all pixels of the frames in runs: what `train --preset paper` writes into a model of these
    sessions. A network of preset `best` scales each window by itself."""
    if not sessions:
        raise ValueError("there is no session")
    pixels = [session.frames_c[session.run != 0].reshape(-1) for session in sessions]
    off = np.concatenate(pixels).astype(np.float64) - ORIGIN_C
    if not len(off):
        return Scaling(0.0, 1.0, label_scale_dps)
    mean = np.cumsum(off)[-1] / len(off)  # one after the other, as thermorig adds them: numpy's sum() does not
    variance = np.cumsum(off * off)[-1] / len(off) - mean * mean
    deviation = np.float32(np.sqrt(variance)) if variance > 1e-12 else np.float32(1)
    return Scaling(float(np.float32(ORIGIN_C + mean)), float(deviation), label_scale_dps)


def _windows_of(session: Session, index: int, frames: int, reduction: int, history: int, label: str,
                remove_bias: bool) -> Windows:
    last = ends_of_windows(session.run_with(label), frames, history)
    first = last.astype(np.int64) - (frames - 1)
    gyro = session.gyro_dps
    bias = session.gyro_bias_dps if remove_bias else None
    if bias:
        gyro = gyro - np.float32(bias.value)
    return Windows(images=reduced(session.frames_c, reduction)[first[:, None] + np.arange(frames)],
                   label_dps=mean_rates(session.label(label), last, frames),
                   gyro_dps=mean_rates(gyro, last, frames), last=last,
                   session=np.full(len(last), index, np.uint32), middle_s=session.middle_s[last], names=())
