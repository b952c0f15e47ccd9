// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

using nlohmann::json;

const std::string small = "study --quick --mesh body.obj --frames 4 --resolution 32 --branching 4";

/// One run of a small study that several tests look at.
class StudyCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    bench_ = std::make_unique<Workbench>();
    bench_->require("sample limb -o body.obj --resolution 8");
    text_ = bench_->require(small + " -o study --threads 1").out;
  }
  static void TearDownTestSuite() { bench_.reset(); }

  static const Workbench& bench() { return *bench_; }
  static const std::string& text() { return text_; }
  static json study(const std::string& folder = "study") { return json::parse(bench().read(folder + "/study.json")); }
  /// Without what is measured in time.
  static json untimed(json study) {
    study.erase("cost");
    for (const char* part : {"claims", "tables"}) {
      json kept = json::array();
      for (const json& item : study[part])
        if (!item.value("timed", false)) kept.push_back(item);
      study[part] = kept;
    }
    return study;
  }

 private:
  static std::unique_ptr<Workbench> bench_;
  static std::string text_;
};
std::unique_ptr<Workbench> StudyCommand::bench_;
std::string StudyCommand::text_;

TEST_F(StudyCommand, writes_the_figures_of_the_paper_in_the_agreed_form) {
  const json data = study();
  std::set<std::string> figures;
  for (const json& figure : data["figures"]) {
    figures.insert(figure["id"].get<std::string>());
    EXPECT_TRUE(figure["frame_axis"].get<bool>());
    EXPECT_FALSE(figure["y"]["unit"].get<std::string>().empty());
    ASSERT_FALSE(figure["series"].empty()) << figure["id"];
    for (const json& series : figure["series"]) {
      ASSERT_EQ(series["x"].size(), series["y"].size());
      EXPECT_EQ(std::set<std::string>({"method", "reference", "bare"}).count(series["role"]), 1u);
      for (const json& x : series["x"]) {
        EXPECT_GE(x.get<double>(), 0);
        EXPECT_LE(x.get<double>(), 3);
      }
    }
  }
  for (const char* id : {"fig2a", "fig2a-bare", "fig2a-gap", "fig2a-protrusion", "fig2b", "fig2c-stretch",
                         "fig2c-twist", "fig2c-bend", "fig2d-stretch", "fig2d-twist-bare", "fig2d-bend"}) {
    EXPECT_EQ(figures.count(id), 1u) << id;
  }
  std::set<std::string> claims;
  for (const json& claim : data["claims"]) {
    EXPECT_TRUE(claims.insert(claim["id"].get<std::string>()).second) << claim["id"];
    EXPECT_EQ(std::set<std::string>({"paper", "new"}).count(claim["source"]), 1u);
    EXPECT_EQ(std::set<std::string>({"holds", "partly", "fails", "untested"}).count(claim["verdict"]), 1u);
    EXPECT_NE(text().find(claim["claim"].get<std::string>()), std::string::npos) << claim["claim"];
    EXPECT_NE(text().find(claim["numbers"].get<std::string>()), std::string::npos) << claim["numbers"];
    for (const json& figure : claim["figures"]) EXPECT_EQ(figures.count(figure), 1u) << figure;
  }
  for (const json& table : data["tables"]) {
    for (const json& row : table["rows"]) EXPECT_EQ(row.size(), table["columns"].size()) << table["id"];
    EXPECT_TRUE(std::filesystem::is_regular_file(bench() / ("study/" + table["id"].get<std::string>() + ".csv")));
  }
  ASSERT_EQ(data["pictures"].size(), 1u);
  EXPECT_EQ(data["pictures"][0]["svg"].get<std::string>(), bench().read("study/fig1.svg"));
  for (const char* name : {"fig1.svg", "fig2a.svg", "fig2d-bend.svg"}) {
    const std::string svg = bench().read(std::string("study/") + name);
    EXPECT_EQ(svg.rfind("<svg", 0), 0u) << name;
    EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n") << name;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << name;
  }
}

TEST_F(StudyCommand, has_the_same_figures_for_any_number_of_threads) {
  bench().require(small + " -o two --threads 2");
  EXPECT_TRUE(untimed(study()) == untimed(study("two")));
  for (const char* file : {"cells.csv", "fig2a.csv", "fig1.svg", "fig2c-twist.svg", "rules.csv", "trees.csv"})
    EXPECT_TRUE(bench().read(std::string("study/") + file) == bench().read(std::string("two/") + file)) << file;
}

TEST_F(StudyCommand, goes_on_from_the_cells_that_are_there) {
  std::filesystem::copy(bench() / "study", bench() / "again", std::filesystem::copy_options::recursive);
  std::vector<std::filesystem::path> cells;
  for (const auto& entry : std::filesystem::directory_iterator(bench() / "again/cells")) cells.push_back(entry.path());
  std::sort(cells.begin(), cells.end());
  ASSERT_GT(cells.size(), 20u);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string name = cells[i].filename().string();
    if (name.find("cost") != std::string::npos) continue;
    if (i % 3 == 0) std::filesystem::remove(cells[i]);
    if (i % 3 == 1 && i % 2 == 0) bench().write("again/cells/" + name, R"({"settings": {}, "resu)");
  }
  std::filesystem::remove(bench() / "again/study.json");
  const std::string out = bench().require(small + " -o again").out;
  EXPECT_EQ(out.find("; 0 of "), std::string::npos) << out;
  EXPECT_TRUE(bench().read("again/study.json") == bench().read("study/study.json"));
  EXPECT_TRUE(bench().read("again/cells.csv") == bench().read("study/cells.csv"));
}

/// cells.csv, read by other means than the study's.
struct Row {
  std::string method, motion, rule, returns;
  int sample = 0, level = 0;
  double parameter = 0, looseness = 0, bare = 0;
};

std::vector<Row> rows_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    std::vector<std::string> f;
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) f.push_back(cell);
    rows.push_back({f.at(1), f.at(2), f.at(3), f.at(16), std::stoi(f.at(4)), std::stoi(f.at(6)), std::stod(f.at(5)),
                    std::stod(f.at(8)), std::stod(f.at(12))});
  }
  return rows;
}

std::string judged(int count, int total) {
  return count == total ? "holds" : count == 0 ? "fails" : "partly";
}

class Judge {
 public:
  explicit Judge(std::vector<Row> rows) : rows_(std::move(rows)) {
    for (const Row& r : rows_) methods.insert(r.method), motions.insert(r.motion), levels.insert(r.level);
  }
  std::set<std::string> methods, motions;
  std::set<int> levels;

  std::vector<double> curve(const std::string& method, const std::string& motion, const std::string& rule,
                            int level) const {
    std::map<int, double> by_sample;
    for (const Row& r : rows_)
      if (r.method == method && r.motion == motion && r.rule == rule && r.level == level)
        by_sample[r.sample] = r.looseness;
    std::vector<double> list;
    for (const auto& [sample, value] : by_sample) list.push_back(value);
    return list;
  }
  static double mean(const std::vector<double>& e, std::size_t from) {
    double sum = 0;
    for (std::size_t i = from; i < e.size(); ++i) sum += e[i];
    return sum / static_cast<double>(e.size() - from);
  }
  std::string loss_below_traditional(const std::string& rule) const {
    int count = 0, total = 0;
    for (const std::string& m : methods)
      for (const std::string& motion : motions)
        for (const int level : levels) {
          const auto mine = curve(m, motion, rule, level), other = curve(m, motion, "traditional", level);
          ++total;
          count += mean(mine, 1) - mine[0] < mean(other, 1) - other[0];
        }
    return judged(count, total);
  }
  std::string bare_free(const std::string& rule, bool wanted_bare) const {
    std::map<std::string, double> worst;
    for (const Row& r : rows_) {
      if (r.rule != rule) continue;
      double& w = worst[r.method + r.motion + std::to_string(r.level)];
      w = std::max(w, r.bare);
    }
    int count = 0;
    for (const auto& [name, w] : worst) count += (w > 0) == wanted_bare;
    return judged(count, static_cast<int>(worst.size()));
  }
  std::string best(const std::vector<int>& of_levels, std::size_t from, const std::set<std::string>& winners) const {
    int count = 0;
    for (const std::string& motion : motions) {
      std::vector<std::pair<double, std::string>> order;
      for (const std::string& m : methods) {
        double sum = 0;
        for (const int level : of_levels) sum += mean(curve(m, motion, "approach2", level), from);
        order.emplace_back(sum, m);
      }
      std::sort(order.begin(), order.end());
      bool right = true;
      for (std::size_t i = 0; i < winners.size(); ++i) right = right && winners.count(order[i].second) == 1;
      count += right;
    }
    return judged(count, static_cast<int>(motions.size()));
  }
  std::string ratio(const std::string& rule, const std::string& other, double most, bool at_the_end) const {
    int count = 0, total = 0;
    for (const std::string& m : methods)
      for (const std::string& motion : motions)
        for (const int level : levels) {
          const auto a = curve(m, motion, rule, level), b = curve(m, motion, other, level);
          ++total;
          count += (at_the_end ? a.back() / b.back() : mean(a, 1) / mean(b, 1)) <= most;
        }
    return judged(count, total);
  }
  /// Orthogonal polynomials of degree 0 to 2 over equal steps, taken off one after the other.
  static double parabola_residual(std::vector<double> e) {
    std::vector<std::vector<double>> basis;
    for (int degree = 0; degree < 3; ++degree) {
      std::vector<double> p;
      for (std::size_t i = 0; i < e.size(); ++i) p.push_back(std::pow(static_cast<double>(i), degree));
      for (const std::vector<double>& q : basis) {
        double pq = 0;
        for (std::size_t i = 0; i < e.size(); ++i) pq += p[i] * q[i];
        for (std::size_t i = 0; i < e.size(); ++i) p[i] -= pq * q[i];
      }
      double size = 0, along = 0;
      for (const double value : p) size += value * value;
      for (double& value : p) value /= std::sqrt(size);
      for (std::size_t i = 0; i < e.size(); ++i) along += e[i] * p[i];
      for (std::size_t i = 0; i < e.size(); ++i) e[i] -= along * p[i];
      basis.push_back(p);
    }
    double sum = 0;
    for (const double value : e) sum += value * value;
    return sum;
  }
  /// The best c + a·exp(b t), by walking over b and solving for a and c from the normal equations.
  std::string exponential() const {
    int count = 0, faster = 0;
    for (const int level : levels) {
      const auto e = curve("medial", "stretch 2", "approach1", level);
      const double n = static_cast<double>(e.size());
      double least = 1e300, at = 0, variance = 0;
      for (const double value : e) variance += std::pow(value - mean(e, 0), 2);
      for (double b = -9.995; b < 10; b += 0.01) {
        double x1 = 0, x2 = 0, y1 = 0, xy = 0;
        for (std::size_t i = 0; i < e.size(); ++i) {
          const double x = std::exp(b * static_cast<double>(i) / (n - 1));
          x1 += x, x2 += x * x, y1 += e[i], xy += x * e[i];
        }
        const double a = (n * xy - x1 * y1) / (n * x2 - x1 * x1), c = (y1 - a * x1) / n;
        double off = 0;
        for (std::size_t i = 0; i < e.size(); ++i)
          off += std::pow(e[i] - c - a * std::exp(b * static_cast<double>(i) / (n - 1)), 2);
        if (off < least) least = off, at = b;
      }
      const bool bends_up = at >= 1 && 1 - least / variance >= 0.98;
      faster += bends_up;
      count += bends_up && least < parabola_residual(e);
    }
    return count == static_cast<int>(levels.size()) ? "holds" : faster > 0 ? "partly" : "fails";
  }
  std::string returns() const {
    int count = 0, total = 0;
    for (const Row& r : rows_)
      if (r.rule == "approach1" || r.rule == "approach2") ++total, count += r.returns == "yes";
    return judged(count, total);
  }

 private:
  std::vector<Row> rows_;
};

TEST_F(StudyCommand, its_verdicts_follow_from_its_csv) {
  const Judge judge(rows_of(bench().read("study/cells.csv")));
  ASSERT_EQ(judge.methods, (std::set<std::string>{"grid", "hubbard", "medial", "spawn"}));
  ASSERT_EQ(judge.motions.size(), 3u);
  ASSERT_EQ(judge.levels, (std::set<int>{1, 2}));
  std::map<std::string, std::string> expected{
      {"approach1-below-traditional", judge.loss_below_traditional("approach1")},
      {"approach2-below-traditional", judge.loss_below_traditional("approach2")},
      {"approach1-exponential", judge.exponential()},
      {"returns-to-rest", judge.returns()},
      {"level2-hubbard-medial", judge.best({1}, 1, {"hubbard", "medial"})},
      {"level3-grid", judge.best({2}, 1, {"grid"})},
      {"medial-best-average", judge.best({1, 2}, 0, {"medial"})},
      {"traditional-bare", judge.bare_free("traditional", true)},
      {"weighted-bare", judge.bare_free("weighted", true)},
      {"approach1-bare", judge.bare_free("approach1", true)},
      {"approach2-bare", judge.bare_free("approach2", true)},
      {"exact-covers", judge.bare_free("exact", false)},
      {"refitted-covers", judge.bare_free("refitted", false)},
      {"exact-cost", judge.ratio("exact", "approach2", 2, false)},
      {"exact-below-approach1", judge.ratio("exact", "approach1", 1, false)},
      {"refitted-near-floor", judge.ratio("refitted", "fresh", 2, true)}};
  std::size_t compared = 0;
  const json data = study();
  for (const json& claim : data["claims"]) {
    const auto found = expected.find(claim["id"].get<std::string>());
    if (found == expected.end()) continue;
    EXPECT_EQ(claim["verdict"].get<std::string>(), found->second) << claim["id"] << claim["numbers"];
    ++compared;
  }
  EXPECT_EQ(compared, expected.size());
  EXPECT_EQ(expected["exact-covers"], "holds");
  EXPECT_EQ(expected["refitted-covers"], "holds");
  EXPECT_EQ(expected["returns-to-rest"], "holds");
}

TEST_F(StudyCommand, its_figures_come_again_from_files) {
  bench().require("build body.obj -o grid.morula --method grid --depth 2 --branching 4");
  bench().require("deform body.obj -o motion --twist 180 --frames 7");
  bench().require("update body.obj grid.morula motion -o spheres --rule approach2");
  const json again =
      bench().require("measure body.obj spheres --motion motion --resolution 32 --no-protrusion --json").json();
  const Judge judge(rows_of(bench().read("study/cells.csv")));
  for (const int level : {1, 2}) {
    const std::vector<double> curve = judge.curve("grid", "twist 180", "approach2", level);
    ASSERT_EQ(curve.size(), 4u);
    for (std::size_t i = 0; i < curve.size(); ++i)
      EXPECT_EQ(curve[i], again["frames"][i]["levels"][static_cast<std::size_t>(level)]["looseness"].get<double>());
  }
}

TEST_F(StudyCommand, runs_on_trees_from_elsewhere) {
  std::filesystem::create_directory(bench() / "trees");
  bench().require("build body.obj -o trees/body-octree.sph --method octree --depth 2");
  bench().require(
      "study --quick -o elsewhere --mesh body.obj --trees trees --sph-origin none --frames 3 "
      "--resolution 16 --rules approach2,exact,fresh");
  const json data = study("elsewhere");
  EXPECT_EQ(data["cells"].size(), 6u);
  for (const json& cell : data["cells"]) {
    EXPECT_EQ(cell["method"], "octree");
    EXPECT_NE(cell["rule"], "fresh");
  }
}

TEST_F(StudyCommand, ranks_mixes_that_cover_before_the_others) {
  bench().require(
      "study --quick -o mixed --mesh body.obj --mixes --methods grid --rules exact --frames 3 "
      "--resolution 16");
  const json data = study("mixed");
  const auto table =
      std::find_if(data["tables"].begin(), data["tables"].end(), [](const json& t) { return t["id"] == "mixes"; });
  ASSERT_NE(table, data["tables"].end());
  double last = 0;
  bool bare = false;
  std::size_t covering = 0;
  for (const json& row : (*table)["rows"]) {
    const bool is_bare = row[2].get<double>() > 0;
    EXPECT_TRUE(is_bare || !bare) << row;
    if (is_bare != bare) last = 0;
    bare = is_bare;
    EXPECT_GE(row[1].get<double>(), last) << row;
    last = row[1].get<double>();
    if (row[0].get<std::string>().find("covering") == std::string::npos && row[0] != "exact+exact") continue;
    EXPECT_FALSE(is_bare) << row;
    ++covering;
  }
  EXPECT_EQ(covering, 16u);
}

TEST_F(StudyCommand, names_what_is_wrong_and_writes_nothing) {
  std::filesystem::create_directory(bench() / "none");
  bench().write("file", "");
  const auto before = bench().listing();
  const std::map<std::string, std::string> bad{{"--methods medal", "medal"},
                                               {"--methods grid,grid", "grid twice"},
                                               {"--rules exat", "exat"},
                                               {"--unit meter", "meter"},
                                               {"--frames 2", "frames"},
                                               {"--depth 0", "depth"},
                                               {"--trees nowhere", "nowhere"},
                                               {"--trees none", "none"},
                                               {"--mesh nothing.obj", "nothing.obj"}};
  for (const auto& [options, named] : bad) {
    const CommandResult result = bench().run("study -o bad " + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_NE(result.err.find(named), std::string::npos) << options << ": " << result.err;
  }
  EXPECT_EQ(bench().run("study -o file --quick").exit_code, 2);
  EXPECT_EQ(bench().listing(), before);
}

}  // namespace
}  // namespace morula::test
