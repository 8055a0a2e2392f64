// SPDX-License-Identifier: MIT
// Colours come from the style sheets, so light, dark and print have one place.
import { lineOf } from '../../../line_styles.js';

/** `colour(name)`: a colour of the style sheet, by its name. */
export function themeOf(colour, font) {
  return {
    paper: colour('paper'),
    ink: colour('ink'),
    quiet: colour('quiet'),
    line: colour('line'),
    font,
    colourOf: (key) => colour(lineOf(key).colour),
    strokeOf: (key) => {
      const { dash, width } = lineOf(key);
      return { type: dash.length === 0 ? 'solid' : dash, width };
    },
  };
}

export function themeNow() {
  const style = getComputedStyle(document.documentElement);
  return themeOf((name) => style.getPropertyValue(`--${name}`).trim(), getComputedStyle(document.body).fontFamily);
}

/** Text of a number on an axis or in a tooltip. */
export function number(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return '-';
  const size = Math.abs(value);
  if (size >= 1e6) return `${Number((value / 1e6).toPrecision(3))} M`;
  if (size >= 1e4) return `${Number((value / 1e3).toPrecision(3))} k`;
  return String(Number(value.toPrecision(3)));
}

export function textStyle(theme) {
  return { color: theme.ink, fontFamily: theme.font, fontSize: 12 };
}

export function axis(theme, name, rest) {
  return {
    name,
    nameLocation: 'middle',
    nameTextStyle: { color: theme.quiet, fontSize: 12 },
    axisLabel: { color: theme.quiet, hideOverlap: true, formatter: number },
    axisLine: { show: true, onZero: false, lineStyle: { color: theme.quiet } },
    axisTick: { lineStyle: { color: theme.quiet } },
    splitLine: { lineStyle: { color: theme.line, width: 0.7 } },
    ...rest,
  };
}

/** Tooltips are drawn, not written as markup: names in results stay text. */
export function tooltip(theme, rest) {
  return {
    renderMode: 'richText',
    confine: true,
    backgroundColor: theme.paper,
    borderColor: theme.quiet,
    textStyle: { color: theme.ink, fontSize: 12 },
    ...rest,
  };
}

/** Not drawn: it only knows what is hidden. The page has the legend, see legend.js. */
export function legend(names) {
  return { show: false, data: names };
}
