// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "study_judge.hpp"
#include "workbench.hpp"

namespace morula::test {
namespace {

using Json = nlohmann::json;

const std::string small = "study --quick --seeds 1 --depth 2 --mesh body.obj --frames 4 --resolution 32 --branching 4";

/// One run of a small study that several tests look at.
class LongStudyCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    bench_ = std::make_unique<Workbench>();
    bench_->require("sample limb -o body.obj --resolution 8");
    text_ = bench_->require(small + " -o study --threads 1").out;
  }
  static void TearDownTestSuite() { bench_.reset(); }

  static const Workbench& bench() { return *bench_; }
  static const std::string& text() { return text_; }
  static Json study(const std::string& folder = "study") { return Json::parse(bench().read(folder + "/study.json")); }
  /// Without what is measured in time.
  static Json untimed(Json study) {
    study.erase("cost");
    Json kept = Json::array();
    for (const Json& table : study["tables"])
      if (!table.value("timed", false)) kept.push_back(table);
    study["tables"] = kept;
    for (Json& claim : study["claims"]) claim.erase("times");
    return study;
  }

 private:
  static std::unique_ptr<Workbench> bench_;
  static std::string text_;
};
std::unique_ptr<Workbench> LongStudyCommand::bench_;
std::string LongStudyCommand::text_;

TEST_F(LongStudyCommand, writes_the_figures_of_the_paper_in_the_agreed_form) {
  const Json data = study();
  std::set<std::string> figures;
  for (const Json& figure : data["figures"]) {
    figures.insert(figure["id"].get<std::string>());
    const bool pressed = figure["motion"] == "press";
    EXPECT_NE(figure["frame_axis"].get<bool>(), pressed) << figure["id"];
    const double last = pressed ? static_cast<double>(figure["x"]["names"].size()) - 1 : 3;
    EXPECT_FALSE(figure["y"]["unit"].get<std::string>().empty());
    ASSERT_FALSE(figure["series"].empty()) << figure["id"];
    for (const Json& series : figure["series"]) {
      ASSERT_EQ(series["x"].size(), series["y"].size());
      EXPECT_EQ(std::set<std::string>({"method", "reference", "uncovered"}).count(series["role"]), 1u);
      for (const Json& x : series["x"]) {
        EXPECT_GE(x.get<double>(), 0);
        EXPECT_LE(x.get<double>(), last);
      }
    }
  }
  for (const char* id :
       {"fig2a", "fig2a-uncovered", "fig2a-uncovered-distance", "fig2a-protrusion", "fig2b", "fig2c-stretch",
        "fig2c-twist", "fig2c-bend", "fig2d-stretch", "fig2d-twist-uncovered", "fig2d-bend", "press-generators-z",
        "press-generators-x-normal", "press-rules-y", "press-rules-x-lost"}) {
    EXPECT_EQ(figures.count(id), 1u) << id;
  }
  std::set<std::string> claims;
  for (const Json& claim : data["claims"]) {
    EXPECT_TRUE(claims.insert(claim["id"].get<std::string>()).second) << claim["id"];
    EXPECT_EQ(std::set<std::string>({"paper", "new"}).count(claim["source"]), 1u);
    EXPECT_EQ(std::set<std::string>({"holds", "partly", "fails", "not decided"}).count(claim["verdict"]), 1u);
    EXPECT_NE(in_one_line(text()).find(claim["claim"].get<std::string>()), std::string::npos) << claim["claim"];
    EXPECT_NE(in_one_line(text()).find(claim["numbers"].get<std::string>()), std::string::npos) << claim["numbers"];
    for (const Json& figure : claim["figures"]) EXPECT_EQ(figures.count(figure), 1u) << figure;
    if (claim.contains("why")) {
      const std::string why = claim["why"];
      EXPECT_LE(std::count(why.begin(), why.end(), '.'), 4) << "two sentences, and 0.98: " << why;
    }
  }
  // The words of study.json, except where a failed claim is better than claimed.
  for (const Json& claim : data["claims"]) {
    if (claim.value("adverse", false) && claim["verdict"] == "fails") continue;
    const std::string told = claim["verdict"].get<std::string>() + " " + claim["claim"].get<std::string>();
    EXPECT_NE(in_one_line(text()).find(told), std::string::npos) << told;
  }
  EXPECT_NE(text().find("  not decided Rebuilt, exact is at most twice"), std::string::npos) << "it needs fresh trees";
  for (const Json& table : data["tables"]) {
    for (const Json& row : table["rows"]) EXPECT_EQ(row.size(), table["columns"].size()) << table["id"];
    EXPECT_TRUE(std::filesystem::is_regular_file(bench() / ("study/" + table["id"].get<std::string>() + ".csv")));
  }
  ASSERT_EQ(data["pictures"].size(), 1u);
  EXPECT_EQ(data["pictures"][0]["svg"].get<std::string>(), bench().read("study/fig1.svg"));
  for (const char* name : {"fig1.svg", "fig2a.svg", "fig2d-bend.svg", "press-rules-z.svg"}) {
    const std::string svg = bench().read(std::string("study/") + name);
    EXPECT_EQ(svg.rfind("<svg", 0), 0u) << name;
    EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n") << name;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << name;
  }
}

TEST_F(LongStudyCommand, ends_with_a_page_that_holds_the_study_or_says_why_not) {
  if (text().find("- no index.html: this morula was built without its page") != std::string::npos) {
    EXPECT_FALSE(std::filesystem::exists(bench() / "study/index.html"));
    return;
  }
  const std::string page = bench().read("study/index.html");
  const std::string open = "id=\"morula-manifest\">";
  const std::size_t begin = page.find(open);
  ASSERT_NE(begin, std::string::npos);
  const Json manifest =
      Json::parse(page.substr(begin + open.size(), page.find("</script>", begin) - begin - open.size()));
  EXPECT_EQ(manifest["study"], study());
  EXPECT_EQ(manifest["motions"].size(), 3u) << "stretch, twist, bend";
  EXPECT_EQ(manifest["scenes"].size(), 6u) << "each by approach2 and by exact";
}

TEST_F(LongStudyCommand, writes_figures_in_the_formats_that_were_named) {
  bench().require(small + " -o formats --formats pdf,pgf");
  std::map<std::string, std::set<std::string>> stems;
  for (const auto& entry : std::filesystem::directory_iterator(bench() / "formats"))
    stems[entry.path().extension().string()].insert(entry.path().stem().string());
  std::map<std::string, std::set<std::string>> usual;
  for (const auto& entry : std::filesystem::directory_iterator(bench() / "study"))
    usual[entry.path().extension().string()].insert(entry.path().stem().string());
  EXPECT_EQ(stems.count(".svg"), 0u);
  EXPECT_EQ(stems[".pdf"], usual[".svg"]);
  EXPECT_TRUE(usual[".pdf"].empty() && usual[".pgf"].empty());
  usual[".svg"].erase("fig1");  // a picture has no curves
  EXPECT_EQ(stems[".pgf"], usual[".svg"]);
  EXPECT_EQ(stems[".csv"].count("rules"), 1u) << "tables are always CSV";
  EXPECT_EQ(stems[".csv"].count("fig2a"), 0u);
  bench().expect_refused("study --quick -o none --formats svg,png", "png");
  EXPECT_FALSE(std::filesystem::exists(bench() / "none"));
}

TEST_F(LongStudyCommand, has_the_same_figures_for_any_number_of_threads) {
  bench().require(small + " -o two --threads 2");
  EXPECT_TRUE(untimed(study()) == untimed(study("two")));
  for (const char* file : {"cells.csv", "fig2a.csv", "fig1.svg", "fig2c-twist.svg", "rules.csv", "trees.csv",
                           "contacts.csv", "press-generators-z.svg"})
    EXPECT_TRUE(bench().read(std::string("study/") + file) == bench().read(std::string("two/") + file)) << file;
}

TEST_F(LongStudyCommand, goes_on_from_the_cells_that_are_there) {
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
  EXPECT_TRUE(bench().read("again/contacts.csv") == bench().read("study/contacts.csv"));
}

TEST_F(LongStudyCommand, its_verdicts_follow_from_its_csv) {
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
      {"traditional-uncovered", judge.covers("traditional", false)},
      {"weighted-uncovered", judge.covers("weighted", false)},
      {"approach1-uncovered", judge.covers("approach1", false)},
      {"approach2-uncovered", judge.covers("approach2", false)},
      {"exact-covers", judge.covers("exact", true)},
      {"rebuilt-covers", judge.covers("rebuilt", true)},
      {"exact-cost", judge.ratio("exact", "approach2", 2, false)},
      {"exact-below-approach1", judge.ratio("exact", "approach1", 1, false)},
      {"rebuilt-near-floor", "not decided"}};
  std::size_t compared = 0;
  const Json data = study();
  for (const Json& claim : data["claims"]) {
    const auto found = expected.find(claim["id"].get<std::string>());
    if (found == expected.end()) continue;
    EXPECT_EQ(claim["verdict"].get<std::string>(), found->second) << claim["id"] << claim["numbers"];
    ++compared;
  }
  EXPECT_EQ(compared, expected.size());
  EXPECT_EQ(expected["exact-covers"], "holds");
  EXPECT_EQ(expected["rebuilt-covers"], "holds");
  EXPECT_EQ(expected["returns-to-rest"], "holds");
}

TEST_F(LongStudyCommand, presses_every_tree_and_exact_loses_no_crossing) {
  const Json data = study();
  const Json& settings = data["settings"]["press"];
  std::map<std::string, int> cells;
  for (const Json& press : data["presses"]) {
    ++cells[press["rule"].get<std::string>()];
    // Level 1, the budgets, all leaves.
    const std::size_t queries = settings["budgets"].size() + 2;
    ASSERT_EQ(press["figures"].size(), 3 * settings["amounts"].size() * queries);
    for (std::size_t i = 0; i < press["figures"].size(); ++i) {
      const Json& f = press["figures"][i];
      const std::size_t query = f["query"];
      ASSERT_EQ(query, i % queries);
      const double amount = settings["amounts"][f["amount"].get<std::size_t>()];
      EXPECT_LE(f["true_depth"].get<double>(), amount * (1 + 1e-9));
      EXPECT_GT(f["true_depth"].get<double>(), 0.5 * amount);
      EXPECT_GT(f["crossings"].get<int>(), 0);
      EXPECT_LE(f["kept"].get<int>(), f["contacts"].get<int>());
      if (query >= 1 && query <= settings["budgets"].size()) {
        EXPECT_LE(f["pair_tests"].get<int>(), settings["budgets"][query - 1].get<int>());
      }
      if (query >= 2) {
        EXPECT_GE(f["finished"].get<int>(), press["figures"][i - 1]["finished"].get<int>());
      }
      if (query + 1 == queries) {
        EXPECT_EQ(f["finished"], f["contacts"]);
      }
      if (press["rule"] != "exact") continue;
      EXPECT_EQ(f["lost"], 0) << press["method"] << i;
    }
  }
  EXPECT_EQ(cells, (std::map<std::string, int>{{"approach2", 4}, {"exact", 4}, {"traditional", 4}}));
  // Two ways to the truth: the normal is a sum along the curve of crossings, the depth a search for the way out.
  for (const Json& truth : data["press_truths"][0]["truths"]) {
    if (truth["amount"].get<double>() > 0.01) continue;
    const std::size_t axis = truth["axis"].get<std::string>()[0] - 'x';
    EXPECT_NEAR(truth["depth"].get<double>() / truth["amount"].get<double>(), -truth["normal"][axis].get<double>(), 0.1)
        << truth;
  }
  for (const std::string rule : {"exact", "approach2", "traditional"}) {
    int lost = 0;
    int total = 0;
    for (const Json& press : data["presses"]) {
      if (press["rule"] != rule) continue;
      for (const Json& f : press["figures"]) {
        const bool every = rule == "exact";
        if (!every && f["query"] != settings["budgets"].size() + 1) continue;
        lost += f["lost"] > 0 ? 1 : 0;
        ++total;
      }
    }
    const std::string id = rule == "exact" ? "exact-keeps-crossings" : rule + "-loses-crossings";
    const auto claim =
        std::find_if(data["claims"].begin(), data["claims"].end(), [&](const Json& c) { return c["id"] == id; });
    ASSERT_NE(claim, data["claims"].end());
    EXPECT_EQ((*claim)["verdict"], judged(rule == "exact" ? total - lost : lost, total)) << id;
  }
}

/// On a bar of which Approach 2 leaves surface uncovered where it is pressed.
TEST_F(LongStudyCommand, a_press_is_what_collide_finds_there) {
  bench().require("sample bar -o bar.obj --resolution 16");
  bench().require(
      "study --quick --seeds 1 -o pressed --mesh bar.obj --depth 3 --methods octree --rules approach2,exact --frames 3 "
      "--resolution 16");
  bench().require("build bar.obj -o bar.morula --method octree --depth 3");
  bench().require("deform bar.obj -o bent --bend 45 --frames 2 --one-way");
  const Json data = study("pressed");
  const Json& truths = data["press_truths"][0]["truths"];
  const auto words = [](const Json& v) { return v[0].dump() + "," + v[1].dump() + "," + v[2].dump(); };
  std::map<std::string, std::size_t> lost;
  for (const Json& press : data["presses"]) {
    const std::string rule = press["rule"];
    for (std::size_t i = 0; i < truths.size(); ++i) {
      const Json found = bench()
                             .require(
                                 "collide bar.obj bar.obj --tree-a bar.morula --tree-b bar.morula --motion-a bent "
                                 "--motion-b bent --crossings --json --rule " +
                                 rule + " --rotate-b " + words(truths[i]["turn_b"]["axis"]) + ",90 --translate-b " +
                                 words(truths[i]["place_b"]))
                             .json()["frames"][1];
      const Json& leaves = press["figures"][(i + 1) * press["figures"].size() / truths.size() - 1];
      const auto crossings = leaves["crossings"].get<std::size_t>();
      EXPECT_EQ(found["contacts"].size(), leaves["contacts"].get<std::size_t>());
      EXPECT_EQ(found["facet_pairs"].size(), crossings - leaves["lost"].get<std::size_t>());
      EXPECT_EQ(crossings, truths[i]["crossings"].get<std::size_t>());
      lost[rule] += leaves["lost"].get<std::size_t>();
    }
  }
  EXPECT_EQ(lost["exact"], 0u);
  EXPECT_GT(lost["approach2"], 0u);
}

TEST_F(LongStudyCommand, its_figures_come_again_from_files) {
  bench().require("build body.obj -o grid.morula --method grid --depth 2 --branching 4");
  bench().require("deform body.obj -o motion --twist 180 --frames 7");
  bench().require("update body.obj grid.morula motion -o spheres --rule approach2");
  const Json again =
      bench().require("measure body.obj spheres --motion motion --resolution 32 --no-protrusion --json").json();
  const Judge judge(rows_of(bench().read("study/cells.csv")));
  for (const int level : {1, 2}) {
    const std::vector<double> curve = judge.curve("grid", "twist 180", "approach2", level);
    ASSERT_EQ(curve.size(), 4u);
    for (std::size_t i = 0; i < curve.size(); ++i)
      EXPECT_EQ(curve[i], again["frames"][i]["levels"][static_cast<std::size_t>(level)]["looseness"].get<double>());
  }
}

TEST_F(LongStudyCommand, runs_on_trees_from_elsewhere) {
  std::filesystem::create_directory(bench() / "trees");
  bench().require("build body.obj -o trees/body-octree.sph --method octree --depth 2");
  bench().require(
      "study --quick --seeds 1 --depth 2 -o elsewhere --mesh body.obj --trees trees --sph-origin none --frames 3 "
      "--resolution 16 --rules approach2,exact,fresh");
  const Json data = study("elsewhere");
  EXPECT_EQ(data["cells"].size(), 6u);
  for (const Json& cell : data["cells"]) {
    EXPECT_EQ(cell["method"], "octree");
    EXPECT_NE(cell["rule"], "fresh");
  }
}

TEST_F(LongStudyCommand, ranks_mixes_that_cover_before_the_others) {
  bench().require(
      "study --quick --seeds 1 --depth 2 -o mixed --mesh body.obj --mixes --methods grid --rules exact --frames 3 "
      "--resolution 16");
  const Json data = study("mixed");
  const auto table =
      std::find_if(data["tables"].begin(), data["tables"].end(), [](const Json& t) { return t["id"] == "mixes"; });
  ASSERT_NE(table, data["tables"].end());
  double last = 0;
  bool uncovered = false;
  std::size_t covering = 0;
  for (const Json& row : (*table)["rows"]) {
    const bool is_uncovered = row[2].get<double>() > 0;
    EXPECT_TRUE(is_uncovered || !uncovered) << row;
    if (is_uncovered != uncovered) last = 0;
    uncovered = is_uncovered;
    EXPECT_GE(row[1].get<double>(), last) << row;
    last = row[1].get<double>();
    if (row[0].get<std::string>().find("covering") == std::string::npos && row[0] != "exact+exact") continue;
    EXPECT_FALSE(is_uncovered) << row;
    ++covering;
  }
  EXPECT_EQ(covering, 16u);
}

const std::string seeded =
    "study --quick --bodies limb,bar --depth 2 --frames 3 --resolution 24 --branching 4 --methods grid,hubbard "
    "--rules traditional,approach1,approach2,exact --seeds 2";

/// Every body with every seed, and every count and verdict is that of the trials.
TEST_F(LongStudyCommand, joins_the_verdicts_of_bodies_and_seeds) {
  const std::string out = bench().require(seeded + " -o seeded").out;
  const Json data = study("seeded");
  EXPECT_EQ(data["settings"]["seeds"], (std::vector<int>{1, 2}));
  ASSERT_EQ(data["settings"]["trials"].size(), 4u);
  EXPECT_NE(in_one_line(out).find("4 trials: limb ("), std::string::npos) << out;
  std::size_t decided = 0;
  for (const Json& claim : data["claims"]) {
    std::map<std::string, int> counts;
    ASSERT_EQ(claim["trials"].size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      const Json& trial = claim["trials"][i];
      EXPECT_EQ(trial["body"], data["settings"]["trials"][i]["body"]);
      EXPECT_EQ(trial["seed"], data["settings"]["trials"][i]["seed"]);
      ++counts[trial["verdict"]];
    }
    for (const char* verdict : {"holds", "partly", "fails"}) EXPECT_EQ(claim["counts"][verdict], counts[verdict]);
    const int of_trials = 4 - counts["not decided"];
    const std::string expected = of_trials == 0                          ? "not decided"
                                 : 10 * counts["holds"] >= 9 * of_trials ? "holds"
                                 : 10 * counts["fails"] >= 9 * of_trials ? "fails"
                                                                         : "partly";
    EXPECT_EQ(claim["verdict"], expected) << claim["id"];
    if (of_trials > 1) {
      ++decided;
      EXPECT_NE(claim["numbers"].get<std::string>().find("Holds in "), std::string::npos) << claim["numbers"];
      if (!claim["value"].is_null() && claim.contains("value")) {
        EXPECT_LE(claim["value"]["low"], claim["value"]["mean"]) << claim["id"];
        EXPECT_LE(claim["value"]["mean"], claim["value"]["high"]) << claim["id"];
      }
    }
  }
  EXPECT_GT(decided, 8u);
  if (std::filesystem::exists(bench() / "seeded/index.html")) {
    EXPECT_NE(bench().read("seeded/index.html").find("Study of 2 bodies: limb, bar"), std::string::npos);
  }
  EXPECT_EQ(data["stability"]["seeds"], (std::vector<std::vector<int>>{{1}, {2}}));
  EXPECT_GE(data["stability"]["compared"], data["stability"]["same"]);
}

TEST_F(LongStudyCommand, parts_of_several_machines_join_to_the_same_study) {
  if (!std::filesystem::exists(bench() / "seeded/study.json")) bench().require(seeded + " -o seeded");
  for (const char* part : {"2/3", "1/3", "3/3"}) bench().require(seeded + " -o parts --shard " + std::string(part));
  EXPECT_FALSE(std::filesystem::exists(bench() / "parts/study.json"));
  const std::string out = bench().require(seeded + " -o parts").out;
  EXPECT_TRUE(untimed(study("parts")) == untimed(study("seeded")));
  EXPECT_TRUE(bench().read("parts/cells.csv") == bench().read("seeded/cells.csv"));
  const std::size_t cells = study("parts")["cells"].size() + study("parts")["presses"].size();
  EXPECT_NE(out.find(std::to_string(cells) + " of " + std::to_string(cells) + " cells were there"), std::string::npos)
      << out;
}

/// A held-back body and a held-back motion, without a change of code.
TEST_F(LongStudyCommand, takes_bodies_and_motions_of_files) {
  bench().require("sample capsule -o capsule.obj --resolution 8");
  bench().require("deform capsule.obj -o solver.npy --bend 60 --twist 30 --frames 5 --one-way");
  bench().require(
      "study --quick --seeds 1 --depth 2 -o files --mesh body.obj --mesh capsule.obj --motion solver.npy --frames 5 "
      "--resolution 16 --methods grid --rules approach2,exact");
  const Json data = study("files");
  EXPECT_EQ(data["settings"]["motions"], (std::vector<std::string>{"stretch 2", "twist 180", "bend 90", "solver"}));
  std::map<std::string, int> motions;
  for (const Json& cell : data["cells"]) {
    if (cell["motion"] != "solver") continue;
    EXPECT_EQ(cell["body"], "capsule");
    ++motions[cell["rule"]];
  }
  EXPECT_EQ(motions, (std::map<std::string, int>{{"approach2", 1}, {"exact", 1}}));
  // It is what the commands measure on the frames.
  bench().require("build capsule.obj -o capsule.morula --method grid --depth 2");
  bench().require("update capsule.obj capsule.morula solver.npy -o capsule-spheres --rule approach2");
  const Json again =
      bench()
          .require("measure capsule.obj capsule-spheres --motion solver.npy --resolution 16 --no-protrusion --json")
          .json();
  for (const Json& cell : data["cells"]) {
    if (cell["motion"] != "solver" || cell["rule"] != "approach2") continue;
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_EQ(cell["samples"][i]["levels"][1]["looseness"], again["frames"][i]["levels"][2]["looseness"]);
  }
}

TEST_F(LongStudyCommand, names_what_is_wrong_and_writes_nothing) {
  std::filesystem::create_directory(bench() / "none");
  bench().write("file", "");
  const auto before = bench().listing();
  const std::map<std::string, std::string> bad{{"--methods medal", "medal"},
                                               {"--methods grid,grid", "grid twice"},
                                               {"--rules exat", "exat"},
                                               {"--unit meter", "meter"},
                                               {"--frames 2", "frames"},
                                               {"--depth 0", "depth"},
                                               {"--bodies cow", "cow"},
                                               {"--seeds 0", "seeds"},
                                               {"--shard 3/2", "3/2"},
                                               {"--motion nothing.npy", "nothing.npy"},
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
