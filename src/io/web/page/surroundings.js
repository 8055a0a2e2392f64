// SPDX-License-Identifier: MIT
import { estimateOf, stateText } from './estimators.js';
import { decodeImage, drawImage } from './temperatures.js';
import { byId, fixed, number, plain, say } from './text.js';

const height = 24;
const mostColumns = 3600;
const describedEvery = 10_000;  // ms between texts for those who do not see the image
const wholeTurn = 360;

/** Share of the width from the left at which an azimuth lies: 0 deg in the middle, and growing to the left, as the camera sees it. */
const placeOf = (azimuth) => {
  const turns = 0.5 - azimuth / wholeTurn;
  return turns - Math.floor(turns);
};

/** Rows whose azimuth grows, as one looks at them. */
function asSeen(temperatures, columns) {
  return temperatures.map((_, i) => {
    const x = i % columns;
    const azimuth = (columns + Math.floor(columns / 2) - 1 - x) % columns;
    return temperatures[i - x + azimuth];
  });
}

/**
 * What an estimator has seen all around the shaft, with the part that the camera looks at, and a dial with the estimator's heading and
 * the servo's angle.
 */
export class Surroundings {
  constructor() {
    this.figure = byId('surroundings');
    this.canvas = byId('around');
    this.views = [...this.figure.querySelectorAll('.view')];
    this.clear();
  }

  clear() {
    this.temperatures = null;
    this.estimator = null;
    this.described = -Infinity;
    this.figure.hidden = true;
  }

  /** `estimators`: those of the run. */
  take(message, estimators) {
    const columns = number(message.columns);
    const view = number(message.view_deg);
    const estimator = estimators.find(({ name }) => name === message.estimator);
    if (estimator === undefined || !Number.isInteger(columns) || columns < 2 || columns > mostColumns || view === null || view <= 0) return;
    const temperatures = decodeImage(message.pixels, columns * height);
    if (temperatures === null) return;
    this.estimator = estimator;
    this.view = Math.min(view, wholeTurn);
    this.temperatures = asSeen(temperatures, columns);
    this.canvas.width = columns;
    this.figure.hidden = false;
  }

  /** `frame`: the message of the newest frame; `table`, `range`: colours as the image has them. */
  draw(frame, table, range) {
    if (this.temperatures === null) return;
    if (range.low !== null) drawImage(this.canvas, this.temperatures, table, range);
    if (frame === null) return;
    const estimate = estimateOf(frame, this.estimator);
    const servo = estimate.heading === null || estimate.angle === null ? null : estimate.heading - estimate.angle;
    this.showView(estimate.heading);
    this.showDial(estimate, servo);
    say(byId('heading'), `${this.estimator.label}: heading ${fixed(estimate.heading, 1, { sign: true })}°${
      estimate.angleSigma === null ? '' : ` ± ${fixed(estimate.angleSigma, 2)}`}, servo ${fixed(servo, 1, { sign: true })}°`);
    say(byId('heading-state'), stateText(estimate));
    this.describe(estimate);
  }

  /** Over both ends of the image, if need be. */
  showView(heading) {
    const width = this.view / wholeTurn;
    const left = heading === null ? 0 : placeOf(heading) - width / 2;
    this.views.forEach((box, i) => {
      box.hidden = heading === null;
      box.style.width = `${100 * width}%`;
      box.style.left = `${100 * (i === 0 ? left : left < 0 ? left + 1 : left - 1)}%`;
    });
  }

  showDial({ heading, angleSigma }, servo) {
    const turn = (id, angle) => {
      byId(id).toggleAttribute('hidden', angle === null);
      byId(id).setAttribute('transform', `rotate(${angle === null ? 0 : (-angle % wholeTurn).toFixed(2)})`);
    };
    turn('heading-hand', heading);
    turn('servo-hand', servo);
    const half = Math.min(179.9, angleSigma ?? 0) * Math.PI / 180;
    const [x, y] = [44 * Math.sin(half), -44 * Math.cos(half)].map((value) => value.toFixed(2));
    byId('heading-sigma').setAttribute('d', half === 0 ? '' : `M0 0L${-x} ${y}A44 44 0 ${half > Math.PI / 2 ? 1 : 0} 1 ${x} ${y}Z`);
  }

  describe(estimate) {
    if (Date.now() - this.described < describedEvery) return;
    this.described = Date.now();
    const seen = this.temperatures.filter((value) => !Number.isNaN(value)).length / this.temperatures.length;
    this.canvas.setAttribute('aria-label', `Surroundings as ${plain(this.estimator.name, 40)} has seen them, ${fixed(100 * seen, 0)} % of a whole turn; ` +
      `the camera looks at ${fixed(estimate.heading, 0, { sign: true })} degrees`);
  }
}
