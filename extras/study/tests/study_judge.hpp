// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The study's verdicts once more, from cells.csv alone and by other means than the study's.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace morula::test {

/// A line of cells.csv.
struct Row {
  std::string method, motion, rule, returns;
  int sample = 0, level = 0;
  double parameter = 0, looseness = 0, uncovered = 0;
};

inline std::vector<Row> rows_of(const std::string& csv) {
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

inline std::string judged(int count, int total) {
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
  std::string covers(const std::string& rule, bool wanted) const {
    std::map<std::string, double> worst;
    for (const Row& r : rows_) {
      if (r.rule != rule) continue;
      double& w = worst[r.method + r.motion + std::to_string(r.level)];
      w = std::max(w, r.uncovered);
    }
    int count = 0;
    for (const auto& [name, w] : worst) count += (w == 0) == wanted;
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

}  // namespace morula::test
