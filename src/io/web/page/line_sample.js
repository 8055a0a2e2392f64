// SPDX-License-Identifier: MIT
const drawing = 'http://www.w3.org/2000/svg';

/** A short piece of a line, as in the plots. */
export function lineSample({ colour, dash, width }) {
  const svg = document.createElementNS(drawing, 'svg');
  svg.setAttribute('width', '32');
  svg.setAttribute('height', '8');
  svg.setAttribute('aria-hidden', 'true');
  const line = document.createElementNS(drawing, 'line');
  for (const [name, value] of Object.entries({ x1: 0, x2: 32, y1: 4, y2: 4, 'stroke-width': width + 0.5, 'stroke-dasharray': dash.join(' ') || 'none' })) {
    line.setAttribute(name, value);
  }
  line.style.stroke = `var(--${colour})`;
  svg.append(line);
  return svg;
}
