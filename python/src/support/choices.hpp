// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Choices: arguments that are one of a few names. Choices without a table in the library have one here; type
// checkers get all of them (choices.cpp).
#pragma once

#include <initializer_list>
#include <morula/morula.hpp>
#include <utility>

namespace morula::python {

template <class Value>
using Choices = std::initializer_list<std::pair<const char*, Value>>;

inline constexpr Choices<Axis> axis_choices{
    {"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}, {"automatic", Axis::automatic}};
inline constexpr Choices<SignMethod> sign_method_choices{{"pseudo_normal", SignMethod::pseudo_normal},
                                                         {"winding_number", SignMethod::winding_number}};
inline constexpr Choices<Priority> priority_choices{
    {"level", Priority::level}, {"overlap", Priority::overlap}, {"importance", Priority::importance}};
inline constexpr Choices<ObstacleFeatures> feature_choices{{"vertices", ObstacleFeatures::vertices},
                                                           {"facets", ObstacleFeatures::facets}};
inline constexpr Choices<RebuildThread> rebuild_thread_choices{
    {"background", RebuildThread::background}, {"caller", RebuildThread::caller}, {"none", RebuildThread::none}};
inline constexpr Choices<RebuildEffort> rebuild_effort_choices{{"standard", RebuildEffort::standard},
                                                               {"high", RebuildEffort::high}};
inline constexpr Choices<RuleOptions::Weights> weight_choices{
    {"uniform", RuleOptions::Weights::uniform},
    {"inverse_distance", RuleOptions::Weights::inverse_distance},
    {"area", RuleOptions::Weights::area}};
inline constexpr Choices<RuleOptions::InnerCenter> inner_center_choices{
    {"children", RuleOptions::InnerCenter::children}, {"linked_vertices", RuleOptions::InnerCenter::linked_vertices}};
inline constexpr Choices<RuleOptions::InnerBoxes> inner_box_choices{
    {"child_spheres", RuleOptions::InnerBoxes::child_spheres},
    {"child_centers", RuleOptions::InnerBoxes::child_centers}};
inline constexpr Choices<RuleOptions::WrappedCenter> wrapped_center_choices{
    {"children", RuleOptions::WrappedCenter::children}, {"smallest", RuleOptions::WrappedCenter::smallest}};
inline constexpr Choices<RuleOptions::ModalBound> modal_bound_choices{{"gradient", RuleOptions::ModalBound::gradient},
                                                                      {"shift", RuleOptions::ModalBound::shift}};

}  // namespace morula::python
