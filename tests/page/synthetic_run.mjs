// SPDX-License-Identifier: MIT
// Messages of a run as docs/live_messages.md tells, made of sums of sines: the same numbers in each test.

export const period = 0.125;  // s between frames
const rates = [-180, -120, -60, 60, 120, 180];
const framesOfLeg = 24;

export function hello(changes = {}) {
  return { event: 'hello', version: '0.1.0', run: '0123456789abcdef', mode: 'live', recording: true, simulated: true, simulation: 'ports, seed 1', environment: 'garden',
    acquisition: 3, start_utc: '2026-01-02T03:04:05Z', control: false, frame_rate_hz: 8, model: { name: 'model.onnx', frames: 3, reduction: 1,
      fusion: true, simulated: true }, plan: { name: 'paper', legs: 38, frames_per_leg: 40, expected_s: 358 }, ...changes };
}

const legOf = (index) => Math.floor(index / framesOfLeg);
const rateOf = (leg) => rates[(leg * 5) % rates.length];
const wave = (index, k) => Math.sin(index * k) + 0.6 * Math.sin(index * k * 2.7 + 1);

function scoresOf(index, spread, slope) {
  return { frames: index, mse: (spread / 200) ** 2, rmse_dps: spread, recent: Math.min(index, 430), recent_median_mse: 0.45 * (spread / 200) ** 2,
    recent_iqr_mse: 1.1 * (spread / 200) ** 2, angle_error_deg: slope * index * period / 60 + spread * 0.05 * wave(index, 0.021), drift_deg_per_min: slope };
}

export function frame(index, changes = {}) {
  const leg = legOf(index);
  const ramp = index % framesOfLeg < 3;
  const before = rateOf(leg - (leg > 0 ? 1 : 0));
  const share = Math.min(1, (index % framesOfLeg) / 3);
  const commanded = before + (rateOf(leg) - before) * share;
  const counted = index - 3 * (leg + 1);
  return { event: 'frame', index, time_s: index * period, begin_s: index * period - 0.25, end_s: index * period + 0.06, counted: !ramp, valid: !ramp,
    reasons: ramp ? ['servo_ramp', 'frame_overlap'] : [], leg: leg + 1, run: ramp ? 0 : leg + 1, commanded_dps: commanded,
    gyro_dps: commanded * 1.004 + 1.6 + 0.5 * wave(index, 1.9), thermal_dps: commanded * 0.98 + (ramp ? 40 : 5) * wave(index, 1.3),
    fusion_dps: commanded + (ramp ? 12 : 1.4) * wave(index, 0.9), gain: 0.5 + 0.18 * wave(index, 0.11), inference_us: 61.25, fresh: index % 9 === 0 ? 'half' : 'both',
    scores: { counted, apart: 3 * (leg + 1), integrated_s: counted * period, gain_mean: 0.44, gain_histogram: Array.from({ length: 20 }, (_, i) =>
      Math.round(counted * Math.exp(-(((i - 9) / 3.2) ** 2)) / 5.6)), gate_collapsed: false, thermal: scoresOf(counted, 6.1, -18.8),
    gyro: scoresOf(counted, 1.8, 96.3), fusion: scoresOf(counted, 1.5, 2.4) }, ...changes };
}

export function state(time, changes = {}) {
  const index = Math.floor(time / period);
  const leg = legOf(index);
  return { event: 'state', time_s: time, phase: 'leg', eta_s: Math.max(0, 358 - time), done_share: Math.min(1, time / 358), leg: leg + 1, leg_count: 38,
    rate_dps: rateOf(leg), next_rate_dps: rateOf(leg + 1), frames: index % framesOfLeg, frames_per_leg: 40, repeated: 1,
    speeds: Array.from({ length: 38 }, (_, i) => ({ rate_dps: i < 19 ? -200 + i * 10 : 20 + (i - 19) * 10, valid: (i * 7 + index) % 41, quota: 40 })),
    devices: {
      camera: { state: 'ok', expected_hz: 8, rate_min_hz: 7.9, rate_max_hz: 8.1, age_s: 0.06, messages: index, lost: 0, bad: 0, skipped_bytes: 0, uncertainty_s: 0.0021 },
      gyro: { state: 'ok', expected_hz: 100, rate_min_hz: 99.7, rate_max_hz: 100.2, age_s: 0.008, messages: index * 12, lost: 2, bad: 1, skipped_bytes: 12, uncertainty_s: 0.0009 },
      servo: { state: 'ok', expected_hz: 50, rate_min_hz: 49.9, rate_max_hz: 50.1, age_s: 0.014, messages: index * 6, lost: 0, bad: 0, skipped_bytes: 0, uncertainty_s: 0.0003 },
    },
    kept_frames: index, kept_bytes: 120000 + index * 1700, disk_free_bytes: 61e9, stopping: false, ...changes };
}

/** `offset`, degC, is added to every pixel. */
export function image(index, { offset = 0, ...changes } = {}) {
  const pixels = Buffer.alloc(768 * 2);
  for (let row = 0; row < 24; ++row) {
    for (let column = 0; column < 32; ++column) {
      const heat = Math.exp(-(((column - 8 - (index % 16)) / 4) ** 2) - (((row - 14) / 5) ** 2));
      const noise = Math.sin(row * 12.9898 + column * 78.233 + index) * 0.4;
      pixels.writeInt16LE(Math.round(100 * (9 + offset + row * 0.12 + 20 * heat + noise)), (row * 32 + column) * 2);
    }
  }
  return { event: 'image', index, time_s: index * period, pixels: pixels.toString('base64'), ...changes };
}

export function event(index, changes = {}) {
  return { event: 'event', time_s: index * period, kind: 'leg_start', source: 'servo', message: `leg ${legOf(index) + 1} at ${rateOf(legOf(index))} deg/s`, ...changes };
}

/** The messages of frames `from` to `to` (without it), in the order in which a program sends them. */
export function* span(from, to) {
  for (let index = from; index < to; ++index) {
    if (index % framesOfLeg === 0) yield event(index);
    yield frame(index);
    yield image(index);
    if (index % 2 === 0) yield state(index * period);
  }
}
