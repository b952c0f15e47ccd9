// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Values by key, each made once.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace morula::study {

/// Makes values on demand, on any threads. It keeps all of them.
template <class Key, class Value>
class MadeOnce {
 public:
  /// The value for the key; `make` makes it the first time.
  Value find(const Key& key, const std::function<Value()>& make) {
    std::shared_ptr<Entry> entry;
    {
      const std::lock_guard lock(mutex_);
      std::shared_ptr<Entry>& kept = entries_[key];
      if (!kept) kept = std::make_shared<Entry>();
      entry = kept;
    }
    const std::lock_guard lock(entry->mutex);
    if (!entry->value) entry->value = make();
    return *entry->value;
  }

 private:
  struct Entry {
    std::mutex mutex;  // held while the value is made, so that others wait for it
    std::optional<Value> value;
  };

  std::mutex mutex_;  // of the map
  std::map<Key, std::shared_ptr<Entry>> entries_;
};

}  // namespace morula::study
