// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0

/** The codes of errors, by the number of morula_status in morula.h. */
export const codes = ['ok', 'bad_argument', 'bad_file', 'rejected', 'stopped', 'out_of_memory', 'internal'];

/** An error of the library: its text, and its code as one of `codes`, or no_worker where buildAsync() can start none. */
export class MorulaError extends Error {
  constructor(message, code = 'bad_argument') {
    super(message);
    this.name = 'MorulaError';
    this.code = code;
  }
}
