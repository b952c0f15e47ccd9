// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Worker: a process that takes one mesh of a batch after the other and forks a process for each.
//
// A build cannot spoil the next one. It runs in a process of its own, whose memory is gone when it ends. The worker
// gets an exit status, texts of limited length and a file from it, and trusts none of them. The worker itself reads no
// mesh and has one thread. A build that crashes, hangs or takes all memory costs its own mesh.
#pragma once

namespace morula::cli {

/// The word that makes a program a worker: "morula --batch-worker".
inline constexpr const char* worker_word = "--batch-worker";
/// Is this the command line of a worker?
bool is_worker(int argc, char** argv);
/// Takes tasks as lines on standard input and answers each with a line on standard output, its result. Ends with the
/// input, together with the build that runs then. For a process that has one thread. Returns an exit code.
int serve_batch();

}  // namespace morula::cli
