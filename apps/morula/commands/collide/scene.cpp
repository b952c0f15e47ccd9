// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <toolbox/csv.hpp>
#include <toolbox/stopwatch.hpp>

#include "commands/collide/scene_file.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

/// A mesh with its tree, for all bodies that name the same files.
struct Model {
  Mesh mesh;
  CoveredTree model{};
};

/// One body, frame after frame. Neither copied nor moved.
class SceneMember {
 public:
  SceneMember(SceneFileBody file, std::shared_ptr<Model> model) : file_(std::move(file)), model_(std::move(model)) {
    if (!file_.motion.empty()) motion_.emplace(file_.motion, model_->mesh);
    // Frames are read one after the other; the first is read here, so that a bad one is known before trees are built.
    if (motion_) positions_ = motion_->frame(0);
  }
  SceneMember(const SceneMember&) = delete;
  SceneMember& operator=(const SceneMember&) = delete;

  void prepare(const std::vector<Rule>& rules, Workers& workers) {
    if (rules.size() > model_->model.tree.level_count())
      throw UsageError(fmt::format("--rule names level {}, but the tree of {} has levels 0 to {}", rules.size() - 1,
                                   file_.name, model_->model.tree.level_count() - 1));
    body_.emplace(model_->mesh, model_->model, UpdateOptions{.rules = rules, .details = {}}, workers);
    collider_.emplace(model_->mesh, *body_);
    move_to(0, workers);
  }
  std::size_t frame_count() const {
    return std::max<std::size_t>({1, file_.path.size(), motion_ ? motion_->frame_count() : 1});
  }
  /// Beyond the end of its motion or path a body stays where it is.
  void move_to(std::size_t frame, Workers& workers) {
    if (motion_) {
      const std::size_t at = std::min(frame, motion_->frame_count() - 1);
      if (at != frame_) {
        if (at > 0 || frame_) positions_ = motion_->frame(at);
        if (const UpdateStatus status = body_->update(positions_, workers); !status)
          throw UsageError(fmt::format("{}: {}: {}", file_.name, motion_->frame_name(at), message(status)));
        frame_ = at;
      }
    }
    RigidTransform transform = file_.transform;
    if (!file_.path.empty())
      transform.translation = transform.translation + file_.path[std::min(frame, file_.path.size() - 1)];
    collider_->set_transform(transform);
  }
  const Collider& collider() const { return *collider_; }
  const SceneFileBody& file() const { return file_; }

 private:
  SceneFileBody file_;
  std::shared_ptr<Model> model_;
  std::optional<Motion> motion_;
  std::vector<Vec3> positions_;
  std::optional<Body> body_;
  std::optional<Collider> collider_;
  std::optional<std::size_t> frame_;
};

struct PairRow {
  std::size_t a, b;  // members
  std::uint64_t id;
  bool touches, confirmed, began, finished;
  std::vector<Contact> contacts;
  std::vector<ContactSurface> surfaces;
  std::vector<Crossing> crossings;
};
struct SceneFrame {
  SceneStatus status;
  double microseconds = 0;
  std::vector<PairRow> pairs;
  std::vector<EndedPair> ended;

  std::size_t contact_count() const {
    std::size_t count = 0;
    for (const PairRow& pair : pairs) count += pair.contacts.size();
    return count;
  }
  std::size_t crossing_count() const {
    std::size_t count = 0;
    for (const PairRow& pair : pairs) count += pair.crossings.size();
    return count;
  }
  std::size_t touch_count() const {
    return static_cast<std::size_t>(
        std::count_if(pairs.begin(), pairs.end(), [](const PairRow& pair) { return pair.touches; }));
  }
  std::size_t began_count() const {
    return static_cast<std::size_t>(
        std::count_if(pairs.begin(), pairs.end(), [](const PairRow& pair) { return pair.began; }));
  }
};

using Members = std::vector<std::unique_ptr<SceneMember>>;

Members read_members(const SceneRun& run, const std::vector<SceneFileBody>& files, Workers& workers) {
  std::map<std::pair<std::filesystem::path, std::filesystem::path>, std::shared_ptr<Model>> models;
  Members members;
  for (const SceneFileBody& file : files) {
    std::shared_ptr<Model>& model = models[{file.mesh, file.tree}];
    if (!model) model = std::make_shared<Model>(Model{load_mesh(file.mesh)});
    members.push_back(std::make_unique<SceneMember>(file, model));
  }
  for (auto& [paths, model] : models) {
    const ReadTreeOptions reading = parse_sph_origin(run.sph_origin, &model->mesh);
    model->model = paths.second.empty() ? build(model->mesh, {.quality = Quality::fast}, workers)
                                        : read_covered_tree(paths.second, model->mesh, reading, workers);
  }
  const std::vector<Rule> rules = parse_rules(run.rule);
  for (const auto& member : members) member->prepare(rules, workers);
  return members;
}

SceneFrame frame_of(const Scene& scene, const SceneStatus& status, double microseconds) {
  SceneFrame frame{.status = status, .microseconds = microseconds, .pairs = {}, .ended = {}};
  frame.ended.assign(scene.ended().begin(), scene.ended().end());
  for (const ScenePair& p : scene.pairs())
    frame.pairs.push_back({scene.user_data(p.a),
                           scene.user_data(p.b),
                           p.id,
                           p.touches,
                           p.confirmed,
                           p.began,
                           p.finished,
                           {p.contacts.begin(), p.contacts.end()},
                           {p.surfaces.begin(), p.surfaces.end()},
                           {p.crossings.begin(), p.crossings.end()}});
  return frame;
}

std::string scene_csv(const SceneRun& run, const Members& members, const std::vector<SceneFrame>& frames) {
  std::string text = run.options.find_crossings
                         ? "frame,a,b,touch,facet_a,facet_b\n"
                         : "frame,a,b,touch,began,finished,node_a,node_b,x,y,z,normal_x,normal_y,"
                           "normal_z,depth,error_bound,surface_depth\n";
  const auto out = std::back_inserter(text);
  const auto vector = [](const Vec3& v) {
    return fmt::format("{},{},{}", exact_digits(v.x), exact_digits(v.y), exact_digits(v.z));
  };
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const PairRow& pair : frames[i].pairs) {
      const std::string begin = fmt::format("{},{},{},{}", i, toolbox::csv_cell(members[pair.a]->file().name),
                                            toolbox::csv_cell(members[pair.b]->file().name), pair.id);
      if (run.options.find_crossings) {
        for (const Crossing& c : pair.crossings) fmt::format_to(out, "{},{},{}\n", begin, c.facet_a, c.facet_b);
        continue;
      }
      for (std::size_t k = 0; k < pair.contacts.size(); ++k) {
        const Contact& c = pair.contacts[k];
        fmt::format_to(out, "{},{},{},{},{},{},{},{},{},{}\n", begin, int{pair.began}, int{c.finished}, c.node_a,
                       c.node_b, vector(c.point), vector(c.normal), exact_digits(c.depth), exact_digits(c.error_bound),
                       k < pair.surfaces.size() ? exact_digits(pair.surfaces[k].depth) : "");
      }
    }
  return text;
}

void print_text(const SceneRun& run, const Members& members, const std::vector<SceneFrame>& frames,
                unsigned thread_count) {
  std::vector<std::string> header{"frame", "near", "touching", "began", "ended", "contacts", "pair tests", "µs"};
  if (run.options.find_crossings) header.emplace_back("facet pairs");
  header.emplace_back("state");
  Table table(header, 1);
  std::vector<double> microseconds;
  std::size_t stopped = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const SceneFrame& f = frames[i];
    std::vector<std::string> cells{std::to_string(i),
                                   std::to_string(f.status.near_pairs),
                                   std::to_string(f.touch_count()),
                                   std::to_string(f.began_count()),
                                   std::to_string(f.ended.size()),
                                   std::to_string(f.contact_count()),
                                   std::to_string(f.status.pair_tests),
                                   figure(f.microseconds)};
    if (run.options.find_crossings) cells.push_back(std::to_string(f.crossing_count()));
    cells.push_back(f.status.finished ? "finished" : fmt::format("{} open", counted(f.status.open_pairs, "pair")));
    table.add(std::move(cells));
    microseconds.push_back(f.microseconds);
    stopped += f.status.finished ? 0 : 1;
  }
  fmt::print("{}\n", table.text());
  fmt::print("summary   {}, {}; {} µs per frame (median), {}\n",
             members.size() == 1 ? std::string("1 body") : fmt::format("{} bodies", members.size()),
             counted(frames.size(), "frame"), figure(median(microseconds)), counted(thread_count, "thread"));
  if (stopped > 0)
    fmt::print("budget    {} ended {} early: no crossing is missed, but contacts marked unfinished may be none\n",
               run.budget, counted(stopped, "frame"));
  for (const std::string& file : {run.output, run.page})
    if (!file.empty()) fmt::print("written   {}\n", file);
}

void print_json_report(const SceneRun& run, const Members& members, const std::vector<SceneFrame>& frames,
                       unsigned thread_count) {
  Json json{{"scene", run.file}, {"threads", thread_count}, {"bodies", Json::array()}, {"frames", Json::array()}};
  if (!run.budget.empty()) json["budget"] = run.budget;
  for (const auto& member : members) json["bodies"].push_back(member->file().name);
  for (const SceneFrame& f : frames) {
    Json frame{{"finished", f.status.finished},
               {"near_pairs", f.status.near_pairs},
               {"open_pairs", f.status.open_pairs},
               {"undecided_pairs", f.status.undecided_pairs},
               {"pair_tests", f.status.pair_tests},
               {"microseconds", f.microseconds},
               {"pairs", Json::array()},
               {"ended", Json::array()}};
    for (const PairRow& p : f.pairs) {
      double deepest = 0;
      for (const ContactSurface& s : p.surfaces) deepest = std::max(deepest, s.depth);
      Json pair{{"a", members[p.a]->file().name}, {"b", members[p.b]->file().name}, {"touch", p.id},
                {"touches", p.touches},           {"confirmed", p.confirmed},       {"began", p.began},
                {"finished", p.finished},         {"contacts", p.contacts.size()},  {"surface_depth", deepest}};
      if (run.options.find_crossings) pair["facet_pairs"] = p.crossings.size();
      frame["pairs"].push_back(std::move(pair));
    }
    for (const EndedPair& p : f.ended) frame["ended"].push_back(p.id);
    json["frames"].push_back(std::move(frame));
  }
  print_json(json);
}

}  // namespace

int collide_scene(const SceneRun& run) {
  const std::vector<SceneFileBody> files = read_scene_file(run.file, run.roots);
  if (!run.output.empty() || !run.page.empty()) {
    std::vector<std::filesystem::path> inputs{run.file};
    for (const SceneFileBody& body : files) inputs.insert(inputs.end(), {body.mesh, body.tree, body.motion});
    if (!run.output.empty()) {
      if (extension(run.output) != ".csv")
        throw UsageError(fmt::format("-o {}: contacts are written as .csv", run.output));
      require_output_place(run.output);
      require_not_input(run.output, inputs);
    }
    if (!run.page.empty()) collide_views().require(run.page, inputs);
  }
  Workers workers = make_workers(run.threads);
  const Members members = read_members(run, files, workers);
  Scene scene(run.options);
  std::size_t count = 1;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const SceneFileBody& file = members[i]->file();
    scene.add(members[i]->collider(), {.is_static = file.is_static,
                                       .category = file.category,
                                       .mask = file.mask,
                                       .weight = file.weight,
                                       .user_data = i});
    count = std::max(count, members[i]->frame_count());
  }
  std::vector<SceneFrame> frames;
  std::unique_ptr<CollideView> view;
  if (!run.page.empty()) {
    std::vector<const Collider*> colliders;
    for (const auto& member : members) colliders.push_back(&member->collider());
    view = collide_views().make(std::filesystem::path(run.file).stem().string(), std::move(colliders), run.rule);
  }
  {
    Progress progress("colliding");
    for (std::size_t frame = 0; frame < count; ++frame) {
      progress.update(static_cast<double>(frame) / static_cast<double>(count));
      for (const auto& member : members) member->move_to(frame, workers);
      toolbox::Stopwatch watch;
      const SceneStatus status = scene.update(workers);
      const double microseconds = 1e6 * watch.lap();
      if (!status) throw UsageError(message(status));
      frames.push_back(frame_of(scene, status, microseconds));
      if (view) {
        for (const PairRow& pair : frames.back().pairs) view->mark(pair.contacts, pair.surfaces);
        view->end_frame(fmt::format("frame {}", frame));
      }
    }
  }
  if (!run.output.empty()) {
    write_whole(run.output, scene_csv(run, members, frames));
    note_written(run.output);
  }
  if (view) {
    write_whole(run.page, view->text());
    note_written(run.page);
  }
  if (run.json) {
    print_json_report(run, members, frames, workers.thread_count());
  } else {
    print_text(run, members, frames, workers.thread_count());
  }
  return exit_done;
}

}  // namespace morula::cli
