// SPDX-License-Identifier: MIT
// One colour and one dash for each line, the same on the live page, on a session's page, in reports and in figures. Colours
// are names of line_colours.css; dashes tell the lines apart where colours do not.

export const servoLine = { colour: 'servo', dash: [6, 4], width: 1.5 };

/** What a finished session says of each frame. */
export const sessionLines = {
  commanded: servoLine,
  shaft: { colour: 'fresh', dash: [], width: 1.5 },
  'gyro-mean': { colour: 'bar', dash: [2, 3], width: 1.5 },
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

/** The line of an estimator or of a session's column, by its name; a grey one for what has none. */
export function lineOf(name) {
  return sessionLines[name] ?? estimatorLines.find(({ of }) => of === name) ?? { colour: 'quiet', dash: [], width: 1.5 };
}
