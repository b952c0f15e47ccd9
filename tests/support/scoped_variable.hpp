// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>

namespace morula::test {

/// A variable of the environment, of this process and of those that it starts, with another value for a while.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    const char* const before = std::getenv(name);
    was_set_ = before != nullptr;
    if (was_set_) before_ = before;
    set(value);
  }
  ~ScopedVariable() {
    if (was_set_)
      set(before_);
    else
      clear();
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
#ifdef _WIN32
  void set(const std::string& value) const {
    _putenv_s(name_, value.c_str());
  }
  void clear() const {
    _putenv_s(name_, "");
  }
#else
  void set(const std::string& value) const {
    setenv(name_, value.c_str(), 1);
  }
  void clear() const {
    unsetenv(name_);
  }
#endif
  const char* name_;
  std::string before_;
  bool was_set_ = false;
};

}  // namespace morula::test
