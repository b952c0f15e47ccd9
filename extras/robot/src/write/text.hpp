// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Functions that the writers share.
#pragma once

#include <tinyxml2.h>

#include <morula/robot/output.hpp>
#include <nlohmann/json.hpp>

namespace morula::robot {

using Json = nlohmann::ordered_json;
/// Indented; names that are not UTF-8 are replaced.
std::string json_text(const Json& json);

/// The shortest digits that read back the same, with a point and without an exponent: readers of YAML 1.1 take 1e-05
/// for a word and 0 for no float.
std::string decimal(double value);
/// "[a, b, c]".
std::string decimals(const Vec3& v);
/// "a b c".
std::string words(const Vec3& v);
/// In double quotes, as in JSON and YAML.
std::string quoted(const std::string& text);
/// "[a, b]" of names in quotes.
std::string quoted_list(std::span<const std::string> names);

/// Letters, digits and underscores, not beginning with a digit: for names of files, and for C++.
std::string identifier(const std::string& text);

/// "Spheres by morula 0.1.0", and their limits.
std::string made_note(const Description& description);
/// Indented, with a first line and a comment that names the program.
std::string xml_text(tinyxml2::XMLDocument& document, const Description& description);
tinyxml2::XMLElement* add_element(tinyxml2::XMLNode* parent, const char* name);
void set(tinyxml2::XMLElement* at, const char* attribute, const std::string& value);

std::vector<std::string> tool_frames(const Description& description);
std::vector<std::string> own_joint_names(const Robot& robot);
/// Partners of every link that has some, by name, each pair once.
std::map<std::string, std::vector<std::string>> ignored_by_link(const Description& description);
/// "Ignored pairs: 2 given, …": the number for each reason, the number proven, and the bound for the others.
std::string ignored_note(const Description& description);
/// "surfaces touch at rest": the reason why a pair is ignored; for a sampled one also the bound.
std::string reason_text(const Description& description, IgnoreReason reason);
/// The links, the reason, and for `apart` and `never` whether it is proven and the share of configurations, with 95 %
/// confidence, below which they meet.
Json ignored_pair_json(const Robot& robot, const SelfCollision& self_collision, const IgnoredPair& pair);
/// Tested pairs whose spheres overlap at rest or nearly always.
Json overlapping_json(const Robot& robot, const SelfCollision& self_collision);

std::vector<OutputFile> write_curobo(const Description&);
std::vector<OutputFile> write_curobo_old(const Description&);
std::vector<OutputFile> write_xrdf_1(const Description&);
std::vector<OutputFile> write_xrdf_2(const Description&);
std::vector<OutputFile> write_urdf(const Description&);
std::vector<OutputFile> write_srdf(const Description&);
std::vector<OutputFile> write_vamp(const Description&);
std::vector<OutputFile> write_mjcf(const Description&);
std::vector<OutputFile> write_sdf(const Description&);
std::vector<OutputFile> write_foam(const Description&);
std::vector<OutputFile> write_ballpark(const Description&);
std::vector<OutputFile> write_morphit(const Description&);
std::vector<OutputFile> write_bubblify(const Description&);
std::vector<OutputFile> write_csv(const Description&);
std::vector<OutputFile> write_json(const Description&);

}  // namespace morula::robot
