// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A target needs a source for its precompiled headers to be made; this one has nothing to say.
int main() {}
