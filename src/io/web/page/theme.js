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
