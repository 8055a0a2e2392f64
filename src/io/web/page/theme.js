// SPDX-License-Identifier: MIT
// Colours come from the style sheet, so that light and dark have one place.

let colours = new Map();

export function colourOf(name) {
  if (!colours.has(name)) {
    colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return colours.get(name);
}

export function onThemeChange(redraw) {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    colours = new Map();
    redraw();
  });
}

/** Dashes tell the lines apart where colours do not. */
export const servoLine = { colour: 'servo', dash: [6, 4], width: 1.5 };

/** What a finished session says of each frame. */
export const sessionLines = {
  commanded: servoLine,
  shaft: { colour: 'fresh', dash: [], width: 1.5 },
  gyro: { colour: 'line-7', dash: [2, 3], width: 1.5 },
  corrected: { colour: 'now', dash: [], width: 1.5 },
};

/** A line for each estimator of a run; `of`: whose it is in every run. Others take what is left. */
export const estimatorLines = [
  { colour: 'line-1', dash: [12, 3, 2, 3], width: 1.5, of: 'gyro-kalman' },
  { colour: 'line-2', dash: [5, 2], width: 1.5, of: 'thermal-likelihood' },
  { colour: 'line-3', dash: [2, 5], width: 2, of: 'gyro-rest' },
  { colour: 'line-4', dash: [12, 3, 2, 3, 2, 3], width: 1.5, of: 'odometer' },
  { colour: 'line-5', dash: [20, 5], width: 1.5, of: 'cnn-fusion-kalman' },
  { colour: 'line-6', dash: [10, 4], width: 1.5, of: 'gyro' },
  { colour: 'line-7', dash: [3, 3], width: 1.5, of: 'cnn-thermal' },
  { colour: 'line-8', dash: [], width: 2, of: 'cnn-fusion' },
];
