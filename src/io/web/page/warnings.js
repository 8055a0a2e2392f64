// SPDX-License-Identifier: MIT
import { byId } from './text.js';

/** Sentences that stand until their cause is gone; one a subject. */
export class Warnings {
  constructor() {
    this.texts = new Map();
  }

  /** An empty text takes the sentence away. */
  set(subject, text) {
    if ((this.texts.get(subject) ?? '') === text) return;
    if (text === '') this.texts.delete(subject);
    else this.texts.set(subject, text);
    byId('warnings').replaceChildren(...[...this.texts.values()].map((sentence) => {
      const paragraph = document.createElement('p');
      paragraph.textContent = `▲ ${sentence}`;
      return paragraph;
    }));
  }

  clear() {
    for (const subject of [...this.texts.keys()]) this.set(subject, '');
  }
}
