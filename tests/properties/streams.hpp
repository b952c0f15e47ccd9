// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Calls of the system that a run of properties makes.
#pragma once

namespace morula::properties {

/// Whether a person sees standard error.
bool are_errors_seen();
/// Writes to standard output, without the buffer of the C library: for a signal that ends the program.
void write_at_end(const char* text);

}  // namespace morula::properties
