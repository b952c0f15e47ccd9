// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// tinygltf leaves indices, sizes and types unchecked: all its structures are checked here, ahead of any use.
#include "io/gltf/document.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <morula/io/mesh_file.hpp>
#include <set>

#include "io/gltf/accessors.hpp"
#include "io/gltf/model.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::gltf {
using namespace detail;

void Document::fail(const std::string& problem) const {
  throw FileError(name + ": " + problem);
}

namespace {

namespace fs = std::filesystem;

class Reader {
 public:
  // bytes: number of bytes of the text and of all buffers.
  Reader(const fs::path& path, const morula_tinygltf::Model& model, std::size_t bytes)
      : model_(model), bytes_(bytes), accessors_(document_, model, bytes) {
    document_.name = platform::text_of(path);
    document_.bytes = bytes;
  }

  Document read() {
    read_nodes();
    for (std::size_t i = 0; i < model_.meshes.size(); ++i) read_mesh_data(i);
    note_divided_weights();
    for (std::size_t i = 0; i < model_.skins.size(); ++i) read_skin_data(i);
    for (const std::uint32_t node : document_.drawn) check_drawn(node);
    require_modest();
    for (std::size_t i = 0; i < model_.animations.size(); ++i) read_animation(i);
    return std::move(document_);
  }

 private:
  static std::string called(const char* what, std::size_t i) { return std::string(what) + " " + std::to_string(i); }

  std::uint32_t index(int value, std::size_t count, const std::string& owner, const char* what) const {
    if (value < 0 || static_cast<std::size_t>(value) >= count)
      document_.fail(owner + " refers to " + what + " " + std::to_string(value) + " of " + std::to_string(count));
    return static_cast<std::uint32_t>(value);
  }

  void require_finite(const std::vector<double>& values, std::size_t count, const std::string& owner) const {
    if (!values.empty() && count != 0 && values.size() != count)
      document_.fail(owner + " has " + std::to_string(values.size()) + " numbers where " + std::to_string(count) +
                     " are needed");
    for (const double value : values)
      if (!std::isfinite(value)) document_.fail(owner + " has a number that is not finite");
  }

  AffineTransform matrix(const double* m, const std::string& owner) const {
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      document_.fail(owner + " has a matrix whose last row is not 0 0 0 1");
    return {{Vec3{m[0], m[1], m[2]}, Vec3{m[4], m[5], m[6]}, Vec3{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
  }

  void read_nodes() {
    const std::size_t count = model_.nodes.size();
    document_.nodes.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const morula_tinygltf::Node& from = model_.nodes[i];
      const std::string owner = called("node", i);
      Node& node = document_.nodes[i];
      if (from.mesh != -1) node.mesh = index(from.mesh, model_.meshes.size(), owner, "mesh");
      if (from.skin != -1) node.skin = index(from.skin, model_.skins.size(), owner, "skin");
      require_finite(from.matrix, 16, owner + "'s matrix");
      require_finite(from.translation, 3, owner + "'s translation");
      require_finite(from.rotation, 4, owner + "'s rotation");
      require_finite(from.scale, 3, owner + "'s scale");
      require_finite(from.weights, 0, owner + "'s weights");
      node.weights = from.weights;
      node.name = from.name;
      if (!from.matrix.empty()) {
        node.has_matrix = true;
        node.matrix = matrix(from.matrix.data(), owner);
      }
      if (!from.translation.empty())
        node.pose.translation = {from.translation[0], from.translation[1], from.translation[2]};
      if (!from.rotation.empty()) std::copy(from.rotation.begin(), from.rotation.end(), node.pose.rotation.begin());
      if (!from.scale.empty()) node.pose.scale = {from.scale[0], from.scale[1], from.scale[2]};
    }
    for (std::size_t i = 0; i < count; ++i)
      for (const int child : model_.nodes[i].children) {
        Node& below = document_.nodes[index(child, count, called("node", i), "node")];
        if (below.parent != none) document_.fail(called("node", static_cast<std::size_t>(child)) + " has two parents");
        below.parent = static_cast<std::uint32_t>(i);
      }
    for (std::uint32_t i = 0; i < count; ++i)
      if (document_.nodes[i].parent == none) walk(i, document_.parents_first);
    // Since each node has one parent, nodes that no root reaches form a cycle.
    if (document_.parents_first.size() != count) document_.fail("its nodes contain each other in a circle");
    find_drawn();
  }

  // The node and all below it, parents first, children in order.
  void walk(std::uint32_t root, std::vector<std::uint32_t>& order) const {
    std::vector<std::uint32_t> waiting{root};
    while (!waiting.empty()) {
      const std::uint32_t node = waiting.back();
      waiting.pop_back();
      order.push_back(node);
      const std::vector<int>& children = model_.nodes[node].children;
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        waiting.push_back(static_cast<std::uint32_t>(*child));
    }
  }

  void find_drawn() {
    std::vector<std::uint32_t> order;
    if (model_.scenes.empty()) {
      order = document_.parents_first;
    } else {
      const int chosen = model_.defaultScene == -1 ? 0 : model_.defaultScene;
      const auto& scene = model_.scenes[index(chosen, model_.scenes.size(), "the file", "scene")];
      std::vector<bool> seen(model_.nodes.size());
      for (const int root : scene.nodes) {
        const std::uint32_t node =
            index(root, model_.nodes.size(), called("scene", static_cast<std::size_t>(chosen)), "node");
        if (seen[node] || document_.nodes[node].parent != none)
          document_.fail(called("node", node) + " is in a scene twice, or is no root");
        seen[node] = true;
        walk(node, order);
      }
    }
    for (const std::uint32_t node : order)
      if (document_.nodes[node].mesh != none) document_.drawn.push_back(node);
    const auto has_mesh = [](const Node& node) { return node.mesh != none; };
    const auto all = static_cast<std::size_t>(std::count_if(document_.nodes.begin(), document_.nodes.end(), has_mesh));
    if (const std::size_t others = all - document_.drawn.size(); others > 0)
      document_.notes.push_back(std::to_string(others) +
                                (others == 1 ? " node with a mesh is" : " nodes with meshes are") +
                                " not in the default scene and left out");
  }

  using Attributes = std::vector<std::pair<std::string, int>>;

  void read_mesh_data(std::size_t i) {
    MeshData mesh;
    std::map<Attributes, std::size_t> known;  // primitives with the same attributes share their vertices
    const std::string owner = called("mesh", i);
    std::size_t target_count = 0;
    for (std::size_t p = 0; p < model_.meshes[i].primitives.size(); ++p) {
      const morula_tinygltf::Primitive& from = model_.meshes[i].primitives[p];
      const std::string own = owner + ", primitive " + std::to_string(p);
      if (from.mode < 0 || from.mode > 6) document_.fail(own + " has a mode that glTF does not know");
      if (from.mode < TINYGLTF_MODE_TRIANGLES) continue;  // skips points and lines
      const auto position = from.attributes.find("POSITION");
      if (position == from.attributes.end()) document_.fail(own + " has no positions");
      Attributes attributes{{"POSITION", position->second}};
      for (const auto& [attribute, accessor] : from.attributes)
        if (attribute.starts_with("JOINTS_") || attribute.starts_with("WEIGHTS_"))
          attributes.emplace_back(attribute, accessor);
      for (const auto& target : from.targets) {
        const auto moved = target.find("POSITION");
        attributes.emplace_back("target", moved == target.end() ? -1 : moved->second);
      }
      target_count = std::max(target_count, from.targets.size());
      const auto [place, is_new] = known.emplace(attributes, mesh.vertices.size());
      if (is_new) mesh.vertices.push_back(read_vertices(attributes, own));
      mesh.primitives.push_back({p, place->second, read_facets(from, mesh.vertices[place->second], own)});
    }
    mesh.weights = model_.meshes[i].weights;
    require_finite(mesh.weights, 0, owner + "'s weights");
    if (!mesh.weights.empty() && mesh.weights.size() != target_count)
      document_.fail(owner + " has " + std::to_string(mesh.weights.size()) + " weights for " +
                     std::to_string(target_count) + " morph targets");
    mesh.weights.resize(target_count);
    document_.meshes.push_back(std::move(mesh));
  }

  VertexSet read_vertices(const Attributes& attributes, const std::string& owner) {
    VertexSet set;
    set.positions = accessors_.vectors(attributes[0].second, owner + "'s positions");
    const std::size_t count = set.positions.size();
    for (const auto& [name, accessor] : attributes) {
      if (name != "target") continue;
      if (accessor == -1) {  // a target of normals only
        set.targets.emplace_back();
        continue;
      }
      if (accessors_.count_of(accessor, owner) != count)
        document_.fail(owner + " has a morph target with another number of vertices");
      set.targets.push_back(accessors_.vectors(accessor, owner + "'s morph target"));
    }
    read_influences(attributes, set, owner);
    return set;
  }

  void note_divided_weights() {
    if (divided_ == 0) return;
    document_.notes.push_back(std::to_string(divided_) + (divided_ == 1 ? " vertex has" : " vertices have") +
                              " weights that do not add up to 1 within 1e-6, the sums from " +
                              std::to_string(least_sum_) + " to " + std::to_string(largest_sum_) +
                              "; they are divided by their sum");
  }

  void read_influences(const Attributes& attributes, VertexSet& set, const std::string& owner) {
    const std::map<std::string, int> by_name(attributes.begin(), attributes.end());
    const std::size_t count = set.positions.size();
    std::vector<std::vector<std::uint32_t>> joints;
    std::vector<std::vector<double>> weights;
    for (std::size_t k = 0;; ++k) {
      const auto j = by_name.find("JOINTS_" + std::to_string(k)), w = by_name.find("WEIGHTS_" + std::to_string(k));
      if (j == by_name.end() && w == by_name.end()) break;
      if (j == by_name.end() || w == by_name.end())
        document_.fail(owner + " has joints without weights, or the reverse");
      if (accessors_.count_of(j->second, owner) != count || accessors_.count_of(w->second, owner) != count)
        document_.fail(owner + " has joints or weights of another number of vertices");
      joints.push_back(accessors_.indices(j->second, TINYGLTF_TYPE_VEC4, owner + "'s joints"));
      weights.push_back(accessors_.numbers(w->second, TINYGLTF_TYPE_VEC4, owner + "'s weights"));
    }
    if (joints.empty()) return;
    set.begin.push_back(0);
    InterruptPoller poll_interrupt(1u << 14);
    for (std::size_t v = 0; v < count; ++v) {
      poll_interrupt();
      double sum = 0;
      const std::size_t first = set.joints.size();
      for (std::size_t k = 0; k < joints.size(); ++k)
        for (std::size_t c = 4 * v; c < 4 * v + 4; ++c) {
          if (weights[k][c] < 0) document_.fail(owner + " has a negative weight of vertex " + std::to_string(v));
          if (weights[k][c] == 0) continue;
          sum += weights[k][c];
          set.joints.push_back(joints[k][c]);
          set.weights.push_back(weights[k][c]);
        }
      if (!(sum > 0)) document_.fail(owner + " has no weights of vertex " + std::to_string(v));
      if (std::abs(1 - sum) > weight_tolerance) {
        least_sum_ = divided_ == 0 ? sum : std::min(least_sum_, sum);
        largest_sum_ = std::max(largest_sum_, sum);
        ++divided_;
      }
      for (std::size_t k = first; k < set.weights.size(); ++k) set.weights[k] /= sum;
      set.begin.push_back(static_cast<std::uint32_t>(set.joints.size()));
    }
  }

  std::vector<Facet> read_facets(const morula_tinygltf::Primitive& from, const VertexSet& set,
                                 const std::string& owner) const {
    std::vector<std::uint32_t> corners;
    if (from.indices >= 0) {
      corners = accessors_.indices(from.indices, TINYGLTF_TYPE_SCALAR, owner + "'s indices");
    } else {
      corners.resize(set.positions.size());
      for (std::size_t v = 0; v < corners.size(); ++v) corners[v] = static_cast<std::uint32_t>(v);
    }
    InterruptPoller poll_interrupt(1u << 16);
    for (const std::uint32_t v : corners) {
      poll_interrupt();
      if (v >= set.positions.size())
        document_.fail(owner + " refers to vertex " + std::to_string(v) + " of " +
                       std::to_string(set.positions.size()));
    }
    std::vector<Facet> facets;
    facets.reserve(from.mode == TINYGLTF_MODE_TRIANGLES ? corners.size() / 3 : corners.size());
    if (from.mode == TINYGLTF_MODE_TRIANGLES) {
      if (corners.size() % 3 != 0)
        document_.fail(owner + " has " + std::to_string(corners.size()) + " corners, no whole number of triangles");
      for (std::size_t i = 0; i < corners.size(); i += 3) {
        poll_interrupt();
        facets.push_back({corners[i], corners[i + 1], corners[i + 2]});
      }
      return facets;
    }
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
      poll_interrupt();
      if (from.mode == TINYGLTF_MODE_TRIANGLE_FAN)
        facets.push_back({corners[i + 1], corners[i + 2], corners[0]});
      else
        facets.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    }
    return facets;
  }

  void read_skin_data(std::size_t i) {
    const std::string owner = called("skin", i);
    SkinData skin;
    for (const int joint : model_.skins[i].joints)
      skin.joints.push_back(index(joint, model_.nodes.size(), owner, "node"));
    skin.inverse_bind.resize(skin.joints.size());
    if (const int accessor = model_.skins[i].inverseBindMatrices; accessor != -1) {
      if (accessors_.count_of(accessor, owner) < skin.joints.size())
        document_.fail(owner + " has fewer inverse bind matrices than joints");
      const std::vector<double> numbers =
          accessors_.numbers(accessor, TINYGLTF_TYPE_MAT4, owner + "'s inverse bind matrices");
      for (std::size_t k = 0; k < skin.joints.size(); ++k) skin.inverse_bind[k] = matrix(&numbers[16 * k], owner);
    }
    document_.skins.push_back(std::move(skin));
  }

  void check_drawn(std::uint32_t i) const {
    const Node& node = document_.nodes[i];
    const MeshData& mesh = document_.meshes[node.mesh];
    if (!node.weights.empty() && node.weights.size() != mesh.weights.size())
      document_.fail(called("node", i) + " has " + std::to_string(node.weights.size()) + " weights for " +
                     std::to_string(mesh.weights.size()) + " morph targets");
    if (node.skin == none) return;
    InterruptPoller poll_interrupt(1u << 16);
    for (const VertexSet& set : mesh.vertices) {
      if (set.begin.empty()) document_.fail(called("node", i) + " has a skin, but its mesh has no joints and weights");
      for (const std::uint32_t joint : set.joints) {
        poll_interrupt();
        if (joint >= document_.skins[node.skin].joints.size())
          document_.fail(called("node", i) + " refers to joint " + std::to_string(joint) + " of " +
                         std::to_string(document_.skins[node.skin].joints.size()));
      }
    }
  }

  // Many nodes may show one mesh: each has vertices, facets and weights of its own.
  void require_modest() const {
    constexpr std::size_t most_per_byte = 256;
    std::size_t count = 0;
    for (const std::uint32_t i : document_.drawn) {
      for (const VertexSet& set : document_.meshes[document_.nodes[i].mesh].vertices) count += set.positions.size();
      for (const Primitive& p : document_.meshes[document_.nodes[i].mesh].primitives) count += p.facets.size();
      if (count > most_per_byte * bytes_) document_.fail("shows more vertices than a file of this size can mean");
    }
    // A moment has the weights of all nodes, drawn or not.
    std::size_t weights = 0;
    for (const Node& node : document_.nodes) {
      if (node.mesh != none) weights += document_.meshes[node.mesh].weights.size();
      if (weights > most_per_byte * bytes_)
        document_.fail("has more weights of morph targets than a file of this size can mean");
    }
  }

  void read_animation(std::size_t i) {
    const morula_tinygltf::Animation& from = model_.animations[i];
    std::vector<Channel> channels;
    std::set<std::pair<std::uint32_t, Channel::Path>> moved;
    for (std::size_t c = 0; c < from.channels.size(); ++c) {
      const morula_tinygltf::AnimationChannel& own = from.channels[c];
      const std::string owner = called("animation", i) + ", channel " + std::to_string(c);
      Channel channel{};
      channel.node = index(own.target_node, document_.nodes.size(), owner, "node");
      if (own.target_path == "translation")
        channel.path = Channel::Path::translation;
      else if (own.target_path == "rotation")
        channel.path = Channel::Path::rotation;
      else if (own.target_path == "scale")
        channel.path = Channel::Path::scale;
      else if (own.target_path == "weights")
        channel.path = Channel::Path::weights;
      else
        document_.fail(owner + " moves " + in_quotes(own.target_path) + ", which glTF does not know");
      const Node& node = document_.nodes[channel.node];
      if (!moved.insert({channel.node, channel.path}).second) document_.fail(owner + " moves what another one moves");
      if (node.has_matrix && channel.path != Channel::Path::weights)
        document_.fail(owner + " moves a node that has a matrix");
      const auto& sampler = from.samplers[index(own.sampler, from.samplers.size(), owner, "sampler")];
      read_keys(sampler, node, channel, owner);
      channels.push_back(std::move(channel));
    }
    document_.animations.push_back(std::move(channels));
  }

  void read_keys(const morula_tinygltf::AnimationSampler& sampler, const Node& node, Channel& channel,
                 const std::string& owner) const {
    const std::string& kind = sampler.interpolation;
    if (kind == "LINEAR")
      channel.interpolation = Channel::Interpolation::linear;
    else if (kind == "STEP")
      channel.interpolation = Channel::Interpolation::step;
    else if (kind == "CUBICSPLINE")
      channel.interpolation = Channel::Interpolation::cubic;
    else
      document_.fail(owner + " is interpolated by " + in_quotes(kind) + ", which glTF does not know");
    channel.times = accessors_.numbers(sampler.input, TINYGLTF_TYPE_SCALAR, owner + "'s times");
    if (channel.times.empty()) document_.fail(owner + " has no times");
    // glTF wants ascending times. Some exporters write a key twice: equal neighbors are read, since sample() takes the
    // later one.
    for (std::size_t k = 0; k < channel.times.size(); ++k)
      if (channel.times[k] < 0 || (k > 0 && channel.times[k] < channel.times[k - 1]))
        document_.fail(owner + " has times that are negative or go down");
    const bool is_weights = channel.path == Channel::Path::weights;
    channel.width = is_weights ? (node.mesh == none ? 0 : document_.meshes[node.mesh].weights.size())
                    : channel.path == Channel::Path::rotation ? 4
                                                              : 3;
    if (channel.width == 0) document_.fail(owner + " moves weights of a node without morph targets");
    const int type = is_weights ? TINYGLTF_TYPE_SCALAR : channel.width == 4 ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3;
    channel.values = accessors_.numbers(sampler.output, type, owner + "'s values");
    const std::size_t each = channel.interpolation == Channel::Interpolation::cubic ? 3 : 1;
    const std::size_t groups = channel.values.size() / (each * channel.width);
    if (groups != channel.times.size() || channel.values.size() % (each * channel.width) != 0)
      document_.fail(owner + " has " + std::to_string(channel.times.size()) + " times, but values for " +
                     std::to_string(groups));
  }

  static constexpr double weight_tolerance = 1e-6;

  const morula_tinygltf::Model& model_;
  std::size_t bytes_;
  std::size_t divided_ = 0;  // vertices whose weights do not add up to 1
  double least_sum_ = 0, largest_sum_ = 0;
  Document document_;
  Accessors accessors_;
};

}  // namespace

Document read_document(const fs::path& path, std::string_view bytes) {
  const LoadedModel loaded = load_model(path, bytes);
  Document document = Reader(path, loaded.model, loaded.bytes).read();
  document.notes.insert(document.notes.begin(), loaded.notes.begin(), loaded.notes.end());
  return document;
}

}  // namespace morula::gltf
