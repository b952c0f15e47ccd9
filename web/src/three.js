// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds, picking and drawings for three.js. three.d.ts has the contracts.
export {MorulaBounds} from './three/bounds.js';
export {ContactLines, SphereLines} from './three/lines.js';
