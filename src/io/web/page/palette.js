// SPDX-License-Identifier: MIT
// Colour maps of the image, each 16 evenly spaced colours, interpolated linearly in sRGB. inferno, viridis and cividis:
// matplotlib's tables (CC0). ironbow: gnuplot's rgbformulae 30,31,32 (black, blue, violet, yellow, white).
const anchors = {
  inferno: '000004 0c0826 240c4f 420a68 5d126e 781c6d 932667 ae305c c73e4c dd513a ed6925 f8850f fca50a fac62d f2e661 fcffa4',
  ironbow: '000000 000044 000088 0000cc 0d00ff 4200ff 7800ff ad18e7 e23ac5 ff5ca3 ff7e81 ffa05f ffc23d ffe41b ffff2a ffffff',
  viridis: '440154 481a6c 472f7d 414487 39568c 31688e 2a788e 23888e 1f988b 22a884 35b779 54c568 7ad151 a5db36 d2e21b fde725',
  cividis: '00224e 002e6c 1e3a6f 35456c 47516c 575d6d 666970 757575 848279 948e77 a59c74 b7a96e c8b866 dbc75a eed649 fee838',
  grey: '000000 111111 222222 333333 444444 555555 666666 777777 888888 999999 aaaaaa bbbbbb cccccc dddddd eeeeee ffffff',
};

export const paletteNames = Object.keys(anchors);

/** 256 colours as bytes r, g, b. */
export function paletteTable(name, inverted) {
  const colours = anchors[name].split(' ').map((text) => [0, 2, 4].map((i) => parseInt(text.slice(i, i + 2), 16)));
  const table = new Uint8Array(256 * 3);
  for (let i = 0; i < 256; ++i) {
    const place = ((inverted ? 255 - i : i) / 255) * (colours.length - 1);
    const low = Math.min(Math.floor(place), colours.length - 2);
    for (let c = 0; c < 3; ++c) {
      table[i * 3 + c] = Math.round(colours[low][c] + (colours[low + 1][c] - colours[low][c]) * (place - low));
    }
  }
  return table;
}
