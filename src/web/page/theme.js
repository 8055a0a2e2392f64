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
export const lines = {
  servo: { name: 'servo', dash: [6, 4], width: 1.5 },
  thermal: { name: 'thermal', dash: [3, 3], width: 1.5 },
  gyro: { name: 'gyro', dash: [10, 4], width: 1.5 },
  fusion: { name: 'fusion', dash: [], width: 2 },
  kg: { name: 'Kg', dash: [], width: 1.5 },
};
