// Unpacks LZMA as `xz --format=lzma` writes it, after the LZMA specification of the 7-Zip SDK. No browser does so by itself; a
// program becomes a quarter smaller than with Deflate.

/** Lengths of a match, in three ranges. */
class Lengths {
  constructor() {
    this.choice = probabilities(2);
    this.low = Array.from({ length: 16 }, () => probabilities(8));
    this.mid = Array.from({ length: 16 }, () => probabilities(8));
    this.high = probabilities(256);
  }

  /** @type {(decoder: RangeDecoder, position: number) => number} */
  read(decoder, position) {
    if (decoder.bit(this.choice, 0) === 0) return decoder.tree(this.low[position], 3);
    if (decoder.bit(this.choice, 1) === 0) return 8 + decoder.tree(this.mid[position], 3);
    return 16 + decoder.tree(this.high, 8);
  }
}

/** @param {number} count */
const probabilities = (count) => new Uint16Array(count).fill(1024);

/** Reads bits whose probability is known. */
class RangeDecoder {
  /**
   * @param {Uint8Array} input
   * @param {number} at
   */
  constructor(input, at) {
    this.input = input;
    this.at = at + 5;
    this.range = 0xffffffff;
    this.code = new DataView(input.buffer, input.byteOffset).getUint32(at + 1);
  }

  /** @type {(table: Uint16Array, index: number) => number} */
  bit(table, index) {
    const probability = table[index];
    const bound = (this.range >>> 11) * probability;
    let bit = 0;
    if (this.code < bound) {
      this.range = bound;
      table[index] = probability + ((2048 - probability) >> 5);
    } else {
      this.range -= bound;
      this.code -= bound;
      table[index] = probability - (probability >> 5);
      bit = 1;
    }
    if (this.range < 0x1000000) this.shift();
    return bit;
  }

  shift() {
    this.range = (this.range << 8) >>> 0;
    this.code = ((this.code << 8) | this.input[this.at++]) >>> 0;
  }

  /**
   * Reads bits that are as likely 0 as 1.
   * @param {number} count
   */
  direct(count) {
    let value = 0;
    for (let left = count; left > 0; left--) {
      this.range >>>= 1;
      const isOne = this.code >= this.range;
      if (isOne) this.code -= this.range;
      value = value * 2 + Number(isOne);
      if (this.range < 0x1000000) this.shift();
    }
    return value;
  }

  /** @type {(table: Uint16Array, bits: number) => number} */
  tree(table, bits) {
    let node = 1;
    for (let left = bits; left > 0; left--) node = node * 2 + this.bit(table, node);
    return node - (1 << bits);
  }

  /** @type {(table: Uint16Array, start: number, bits: number) => number} */
  reverseTree(table, start, bits) {
    let [node, value] = [1, 0];
    for (let index = 0; index < bits; index++) {
      const bit = this.bit(table, start + node);
      node = node * 2 + bit;
      value |= bit << index;
    }
    return value;
  }
}

/** The distances of a match. */
class Distances {
  constructor() {
    this.slots = Array.from({ length: 4 }, () => probabilities(64));
    this.special = probabilities(115);
    this.align = probabilities(16);
  }

  /** @type {(decoder: RangeDecoder, length: number) => number} */
  read(decoder, length) {
    const slot = decoder.tree(this.slots[Math.min(length, 3)], 6);
    if (slot < 4) return slot;
    const bits = (slot >> 1) - 1;
    const base = (2 | (slot & 1)) * 2 ** bits;
    if (slot < 14) return base + decoder.reverseTree(this.special, base - slot, bits);
    return base + decoder.direct(bits - 4) * 16 + decoder.reverseTree(this.align, 0, 4);
  }
}

/**
 * @param {RangeDecoder} decoder
 * @param {Uint16Array} table
 * @param {number} context Where the literal's probabilities are.
 * @param {number | null} match After a match, the byte that would have continued it.
 */
function readLiteral(decoder, table, context, match) {
  let symbol = 1;
  for (let bits = match; bits !== null && symbol < 0x100; bits <<= 1) {
    const expected = (bits >> 7) & 1;
    const bit = decoder.bit(table, context + ((1 + expected) << 8) + symbol);
    symbol = (symbol << 1) | bit;
    if (bit !== expected) break;
  }
  while (symbol < 0x100) symbol = (symbol << 1) | decoder.bit(table, context + symbol);
  return symbol;
}

/** What follows after a literal, a match, a repeated match and a short one, by what came before. */
const AFTER_LITERAL = [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 4, 5];

/**
 * @param {Uint8Array} input
 * @returns {Uint8Array<ArrayBuffer>}
 */
export function unpackLzma(input) {
  const header = new DataView(input.buffer, input.byteOffset);
  const [lc, lp, pb] = [input[0] % 9, Math.floor(input[0] / 9) % 5, Math.floor(input[0] / 45)];
  const output = new Uint8Array(header.getUint32(5, true));
  const decoder = new RangeDecoder(input, 13);
  const literals = probabilities(0x300 << (lc + lp));
  const [isMatch, isRepeatedLong] = [probabilities(192), probabilities(192)];
  const [isRepeated, isFirst, isSecond, isThird] = [1, 2, 3, 4].map(() => probabilities(12));
  const [lengths, repeatedLengths, distances] = [new Lengths(), new Lengths(), new Distances()];
  /** The last four distances. */
  const last = [0, 0, 0, 0];
  let [state, at] = [0, 0];

  const literal = () => {
    const before = at > 0 ? output[at - 1] : 0;
    const context = 0x300 * (((at & ((1 << lp) - 1)) << lc) + (before >> (8 - lc)));
    output[at] = readLiteral(decoder, literals, context, state < 7 ? null : output[at - last[0] - 1]);
    at++;
    state = AFTER_LITERAL[state];
  };

  /** Moves one of the last distances to the front. Returns whether a single byte is repeated. */
  const recallsOne = (/** @type {number} */ position) => {
    if (decoder.bit(isFirst, state) === 0) return decoder.bit(isRepeatedLong, state * 16 + position) === 0;
    let index = 1;
    if (decoder.bit(isSecond, state) !== 0) index = decoder.bit(isThird, state) === 0 ? 2 : 3;
    last.unshift(...last.splice(index, 1));
    return false;
  };

  while (at < output.length) {
    const position = at & ((1 << pb) - 1);
    if (decoder.bit(isMatch, state * 16 + position) === 0) {
      literal();
      continue;
    }
    let length;
    if (decoder.bit(isRepeated, state) === 0) {
      length = lengths.read(decoder, position);
      last.unshift(distances.read(decoder, length));
      last.pop();
      state = state < 7 ? 7 : 10;
    } else if (recallsOne(position)) {
      output[at] = output[at - last[0] - 1];
      at++;
      state = state < 7 ? 9 : 11;
      continue;
    } else {
      length = repeatedLengths.read(decoder, position);
      state = state < 7 ? 8 : 11;
    }
    for (let end = at + length + 2; at < end; at++) output[at] = output[at - last[0] - 1];
  }
  return output;
}
