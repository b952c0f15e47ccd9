// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes of the C interface: bodies are identified by their handles.
#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

using Member = morula_scene::Member;

std::vector<Member>::iterator find(morula_scene& scene, const morula_body* body) {
  return std::find_if(scene.members.begin(), scene.members.end(),
                      [&](const Member& member) { return member.body.get() == body; });
}

/// The pairs of the last update, in the form of this interface; none if memory is short.
void read_pairs(morula_scene& scene) {
  const auto handle = [&](BodyId id) {
    return reinterpret_cast<morula_body*>(static_cast<std::uintptr_t>(scene.scene.user_data(id)));
  };
  scene.pairs.clear();
  scene.contacts.clear();
  for (const ScenePair& pair : scene.scene.pairs())
    for (const Contact& contact : pair.contacts) scene.contacts.push_back(contact_of(contact));
  const morula_contact* contacts = scene.contacts.data();
  for (const ScenePair& pair : scene.scene.pairs()) {
    scene.pairs.push_back({handle(pair.a), handle(pair.b), contacts, pair.contacts.size(), pair.touches ? 1 : 0,
                           pair.confirmed ? 1 : 0, pair.began ? 1 : 0, pair.finished ? 1 : 0});
    contacts += pair.contacts.size();
  }
}

}  // namespace

morula_status morula_scene_create(const morula_contact_options* options, int threads, morula_scene** scene) {
  return guarded([&] {
    require_pointer(scene, "scene");
    *scene = nullptr;
    *scene = new morula_scene(contact_options<SceneOptions>(options), thread_count(threads));
    return MORULA_OK;
  });
}

void morula_scene_destroy(morula_scene* scene) {
  delete scene;
}

morula_status morula_scene_add(morula_scene* scene, morula_body* body, int is_static) {
  return guarded([&] {
    require_pointer(scene, "scene");
    require_pointer(body, "body");
    if (find(*scene, body) != scene->members.end()) throw std::invalid_argument("body is in the scene already");
    // The list grows first, so that an error leaves nothing to undo.
    if (scene->members.size() == scene->members.capacity()) scene->members.reserve(2 * scene->members.size() + 1);
    const BodyId id = scene->scene.add(
        body->collider, {.is_static = is_static != 0, .user_data = reinterpret_cast<std::uintptr_t>(body)});
    scene->members.push_back({body->of_caller, id});
    return MORULA_OK;
  });
}

morula_status morula_scene_remove(morula_scene* scene, const morula_body* body) {
  return guarded([&] {
    require_pointer(scene, "scene");
    require_pointer(body, "body");
    const auto member = find(*scene, body);
    if (member == scene->members.end()) throw std::invalid_argument("body is not in the scene");
    scene->pairs.clear();  // pairs name a body that may be gone
    scene->scene.remove(member->id);
    scene->members.erase(member);
    return MORULA_OK;
  });
}

morula_status morula_scene_update(morula_scene* scene) {
  return guarded([&]() -> morula_status {
    require_pointer(scene, "scene");
    const SceneStatus status = scene->scene.update(scene->workers);
    if (!status) return fails(MORULA_REFUSED, message(status).c_str());
    read_pairs(*scene);
    return MORULA_OK;
  });
}

size_t morula_scene_pair_count(const morula_scene* scene) {
  return scene == nullptr ? 0 : scene->pairs.size();
}
const morula_scene_pair* morula_scene_pairs(const morula_scene* scene) {
  return scene == nullptr ? nullptr : scene->pairs.data();
}
