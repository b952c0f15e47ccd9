// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Names that arguments take, by their types in morula.typing: for the stubs and for messages.
#include "choices.hpp"

#include <string>

#include "casters.hpp"
#include "holders.hpp"
#include "module.hpp"

namespace morula::python {

namespace {

template <class Value>
std::vector<std::string> words_of(const Choices<Value>& choices) {
  std::vector<std::string> words;
  for (const auto& [word, value] : choices) words.emplace_back(word);
  return words;
}

}  // namespace

void bind_choices(nb::module_& m) {
  nb::dict all;
  const auto add = [&](const char* type, const std::vector<std::string>& words) { all[type] = nb::cast(words); };
  add("Method", names_of(all_methods()));
  add("Quality", names_of(all_qualities()));
  add("Reduction", names_of(all_reductions()));
  add("Optimizer", names_of(all_optimizers()));
  add("Rule", names_of(all_rules()));
  add("Axis", words_of(axis_choices));
  add("SignMethod", words_of(sign_method_choices));
  add("Priority", words_of(priority_choices));
  add("Features", words_of(feature_choices));
  add("RebuildEffort", words_of(rebuild_effort_choices));
  add("RebuildThread", words_of(rebuild_thread_choices));
  add("Weights", words_of(weight_choices));
  add("InnerCenter", words_of(inner_center_choices));
  add("InnerBoxes", words_of(inner_box_choices));
  add("WrappedCenter", words_of(wrapped_center_choices));
  add("ModalBound", words_of(modal_bound_choices));
  m.attr("_choices") = all;
}

}  // namespace morula::python
