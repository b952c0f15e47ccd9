// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <morula/io/mesh_file.hpp>
#include <morula/version.hpp>
#include <new>
#include <stdexcept>

#include "c/handles.hpp"

namespace morula::detail {
namespace {

// The buffer has a fixed size, so that the message about missing memory needs no memory.
thread_local std::array<char, 1024> message_of_thread{};

}  // namespace

morula_status fails(morula_status code, const char* words) noexcept {
  std::snprintf(message_of_thread.data(), message_of_thread.size(), "%s", words);
  return code;
}

morula_status code_of(const Status& status) {
  if (status) return MORULA_OK;
  const bool is_argument = status.code == Status::Code::bad_option || status.code == Status::Code::bad_level;
  return fails(is_argument ? MORULA_BAD_ARGUMENT : MORULA_REFUSED, message(status).c_str());
}

morula_status code_of_resume(const Status& status) {
  const bool has_moved = status.code == Status::Code::other_frame || status.code == Status::Code::other_transform;
  return has_moved ? fails(MORULA_REFUSED, "a body has moved since the search began: begin it again") : code_of(status);
}

morula_status of_current_exception() noexcept {
  try {
    throw;
  } catch (const BuildStopped& e) {
    return fails(MORULA_STOPPED, e.what());
  } catch (const FileError& e) {
    return fails(MORULA_BAD_FILE, e.what());
  } catch (const std::invalid_argument& e) {
    return fails(MORULA_BAD_ARGUMENT, e.what());
  } catch (const std::bad_alloc&) {
    return fails(MORULA_OUT_OF_MEMORY, "out of memory");
  } catch (const std::length_error&) {
    return fails(MORULA_OUT_OF_MEMORY, "out of memory: a count is too large for any machine");
  } catch (const std::exception& e) {
    return fails(MORULA_INTERNAL, e.what());
  } catch (...) {
    return fails(MORULA_INTERNAL, "an exception that is none of the standard's");
  }
}

}  // namespace morula::detail

const char* morula_message(void) {
  return morula::detail::message_of_thread.data();
}
const char* morula_version(void) {
  return morula::version;
}
