// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers of the caller, checked before the module gets them: it would take 2 ** 32 for 0, and 1.5 for 1.
import {MorulaError} from './errors.js';

const isWhole = (value, least, most) => Number.isInteger(value) && value >= least && value <= most;

/** A whole number of 32 bits. */
export function whole(value, name, least = 0, most = 0xffffffff) {
  if (!isWhole(value, least, most))
    throw new MorulaError(`${name} is ${String(value)}, no whole number from ${least} to ${most}`);
  return value;
}
export const signed = (value, name) => whole(value, name, -(2 ** 31), 2 ** 31 - 1);

/** A whole number from 0 to 2^64 - 1. */
export function wide(value, name) {
  const isExact = typeof value === 'bigint' || Number.isSafeInteger(value);
  if (!isExact || BigInt.asUintN(64, BigInt(value)) !== BigInt(value))
    throw new MorulaError(`${name} is ${String(value)}, no whole number from 0 to 2^64 - 1`);
  return BigInt(value);
}

/** Indices as 32-bit numbers. */
export function indices(numbers, name) {
  const result = new Uint32Array(numbers.length);
  for (let i = 0; i < result.length; ++i) {
    if (!isWhole(numbers[i], 0, 0xffffffff)) throw new MorulaError(`${name}[${i}] is ${String(numbers[i])}, no index`);
    result[i] = numbers[i];
  }
  return result;
}

/** The bytes of a buffer, or of any view of one. */
export function bytesOf(given, name) {
  if (!(given?.byteLength >= 0)) throw new MorulaError(`${name} is neither an ArrayBuffer nor a view of one`);
  return ArrayBuffer.isView(given) ? new Uint8Array(given.buffer, given.byteOffset, given.byteLength) : new Uint8Array(given);
}
