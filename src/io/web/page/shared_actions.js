// SPDX-License-Identifier: MIT
import { savePicture } from './picture.js';
import { byId, say } from './text.js';

/** The button of a key shows whether what it switches is on. */
export function press(key, pressed) {
  document.querySelector(`button[data-key="${key}"]`).setAttribute('aria-pressed', String(pressed));
}

/** What keys do on both pages, each of which shows `image`. */
export function sharedActions(image) {
  return {
    c: () => image.nextPalette(),
    l() {
      image.lock();
      press('l', image.range.locked);
    },
    i() {
      image.invert();
      press('i', image.inverted);
    },
    f() {
      const done = document.fullscreenElement === null ? document.documentElement.requestFullscreen?.() : document.exitFullscreen();
      done?.catch(() => say(byId('announcement'), 'This browser refuses full screen'));
    },
    s: savePicture,
    '?': () => byId('help').showModal(),
  };
}
