// SPDX-License-Identifier: MIT
// Messages of a run as docs/live_messages.md tells, made of sums of sines: the same numbers in each test.

export const period = 0.125;  // s between frames
const rates = [-180, -120, -60, 60, 120, 180];
const framesOfLeg = 24;

/** What each estimator does wrong: `noise` (`rampNoise` between legs) and `bias`, deg/s, `drift`, deg/min; what it states of itself. */
const table = [
  { name: 'gyro', title: 'gyro as it is', values: [], bias: 1.6, noise: 0.5, spread: 1.8, drift: 96.3, sigma: 2.2 },
  { name: 'gyro-rest', title: 'gyro, bias of the opening rest removed', values: ['bias_dps'], noise: 0.5, spread: 0.6, drift: 1.2, sigma: 0.06 },
  { name: 'gyro-kalman', title: 'gyro, bias followed by a Kalman filter', values: ['bias_dps', 'scale'], noise: 0.3, spread: 0.4, drift: 0.4, sigma: 0.04 },
  { name: 'cnn-thermal', title: 'thermal head of the network', values: [], scale: 0.98, noise: 5, rampNoise: 40, spread: 6.1, drift: -18.8 },
  { name: 'cnn-fusion', title: "network's fusion of camera and gyro", values: ['gain'], noise: 1.4, rampNoise: 12, spread: 1.5, drift: 2.4 },
  { name: 'image-shift', title: 'shift between two images', values: ['latency_s'], noise: 8, spread: 9.5, drift: 31, sigma: 7.5 },
  { name: 'camera-odometer', title: 'turns that the camera recognises', values: [], noise: 3, spread: 3.3, drift: 0.1, sigma: 3 },
  { name: 'two-gyros', title: 'mean of both gyros', values: ['bias_dps'], bias: 0.7, noise: 0.4, spread: 0.9, drift: -41, sigma: 1.1 },
];

/** The first so many of the table, as they stand in a hello. */
export const estimators = (count) => table.slice(0, count).map(({ name, title, values }) => ({ name, title, values }));

export function hello(changes = {}) {
  return { event: 'hello', version: '0.1.0', run: '0123456789abcdef', mode: 'live', recording: true, simulated: true, simulation: 'ports, seed 1', environment: 'garden',
    acquisition: 3, start_utc: '2026-01-02T03:04:05Z', control: false, frame_rate_hz: 8, model: { name: 'model.onnx', frames: 3, reduction: 1,
      fusion: true, simulated: true }, estimators: estimators(5), plan: { name: 'paper', legs: 38, frames_per_leg: 40, expected_s: 358 }, ...changes };
}

const legOf = (index) => Math.floor(index / framesOfLeg);
const rateOf = (leg) => rates[(leg * 5) % rates.length];
const wave = (index, k) => Math.sin(index * k) + 0.6 * Math.sin(index * k * 2.7 + 1);

function scoresOf(index, { spread, drift }) {
  return { frames: index, mse: (spread / 200) ** 2, rmse_dps: spread, recent: Math.min(index, 430), recent_median_mse: 0.45 * (spread / 200) ** 2,
    recent_iqr_mse: 1.1 * (spread / 200) ** 2, angle_error_deg: drift * index * period / 60 + spread * 0.05 * wave(index, 0.021), drift_deg_per_min: drift };
}

const valueOf = (name, index) => ({ gain: 0.5 + 0.18 * wave(index, 0.11), bias_dps: 1.63, scale: 1.0042, latency_s: 0.0312 })[name];

function estimateOf(index, commanded, ramp, { values, scale = 1.004, bias = 0, noise, rampNoise = noise, sigma }, k) {
  return { rate_dps: commanded * scale + bias + (ramp ? rampNoise : noise) * wave(index, 1.9 - 0.2 * k), rate_sigma_dps: sigma ?? null, angle_deg: index * 1.5,
    angle_sigma_deg: sigma === undefined ? null : sigma * index * period / 10, state: 'good', reason: null,
    values: Object.fromEntries(values.map((name) => [name, valueOf(name, index)])) };
}

/** `of`: how many estimators the run has. */
export function frame(index, changes = {}, of = 5) {
  const leg = legOf(index);
  const ramp = index % framesOfLeg < 3;
  const before = rateOf(leg - (leg > 0 ? 1 : 0));
  const share = Math.min(1, (index % framesOfLeg) / 3);
  const commanded = before + (rateOf(leg) - before) * share;
  const counted = index - 3 * (leg + 1);
  const each = (make) => Object.fromEntries(table.slice(0, of).map((estimator, k) => [estimator.name, make(estimator, k)]));
  return { event: 'frame', index, time_s: index * period, begin_s: index * period - 0.25, end_s: index * period + 0.06, counted: !ramp, valid: !ramp,
    reasons: ramp ? ['servo_ramp', 'frame_overlap'] : [], excluded: ramp ? 'servo_ramp, frame_overlap' : null, leg: leg + 1, run: ramp ? 0 : leg + 1,
    commanded_dps: commanded, estimates: each((estimator, k) => estimateOf(index, commanded, ramp, estimator, k)), inference_us: 61.25,
    fresh: index % 9 === 0 ? 'half' : 'both', scores: { counted, excluded: 3 * (leg + 1), integrated_s: counted * period, gain_mean: 0.44,
      gain_histogram: Array.from({ length: 20 }, (_, i) => Math.round(counted * Math.exp(-(((i - 9) / 3.2) ** 2)) / 5.6)), gate_collapsed: false,
      estimators: each((estimator) => scoresOf(counted, estimator)) }, ...changes };
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

/** Of which half a turn was seen: warm at azimuth `warm`, deg. */
export function surroundings(index, { warm = 30, ...changes } = {}) {
  const columns = 420;
  const pixels = Buffer.alloc(24 * columns * 2);
  for (let row = 0; row < 24; ++row) {
    for (let column = 0; column < columns; ++column) {
      const azimuth = ((column + 0.5) / columns) * 360;
      const off = ((azimuth - warm + 540) % 360) - 180;
      pixels.writeInt16LE(azimuth > 180 && azimuth < 270 ? -32768 : Math.round(100 * (9 + row * 0.12 + 20 * Math.exp(-((off / 12) ** 2)))), (row * columns + column) * 2);
    }
  }
  return { event: 'surroundings', estimator: 'gyro-kalman', time_s: index * period, view_deg: 55, columns, pixels: pixels.toString('base64'), ...changes };
}

export function event(index, changes = {}) {
  return { event: 'event', time_s: index * period, kind: 'leg_start', source: 'servo', message: `leg ${legOf(index) + 1} at ${rateOf(legOf(index))} deg/s`, ...changes };
}

/** The messages of frames `from` to `to` (without it), in the order in which a program sends them, of a run with `of` estimators. */
export function* span(from, to, of = 5) {
  for (let index = from; index < to; ++index) {
    if (index % framesOfLeg === 0) yield event(index);
    yield frame(index, {}, of);
    yield image(index);
    if (index % 2 === 0) yield state(index * period);
  }
}
