// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The submodule batch_engine: what `morula batch` is made of, for batches that are spread over many machines.
#include <batch/bytes.hpp>
#include <batch/manifest.hpp>
#include <batch/options.hpp>
#include <batch/task.hpp>
#include <batch/worker.hpp>
#include <map>
#include <optional>
#include <shared/command.hpp>
#include <shared/name_text.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "holders.hpp"
#include "module.hpp"

namespace morula::python {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string_view view_of(const nb::bytes& bytes) {
  return {bytes.c_str(), bytes.size()};
}

template <class F>
auto as_value_error(const F& f) {
  try {
    return without_gil(f);
  } catch (const cli::UsageError& error) {
    throw std::invalid_argument(error.what());
  }
}

// name, reference, path, reason of a rejection
using RowTuple = std::tuple<std::string, std::string, fs::path, std::string>;

std::vector<RowTuple> tuples_of(const std::vector<cli::ManifestRow>& rows) {
  std::vector<RowTuple> tuples;
  for (const cli::ManifestRow& row : rows)
    tuples.emplace_back(cli::text_of_name(row.name), cli::text_of_name(row.reference), row.mesh, row.rejection);
  return tuples;
}

void bind_seat(nb::module_& m) {
  nb::class_<cli::BatchSeat>(m, "Seat", "A place for worker processes, one process at a time; each builds many meshes.")
      .def(nb::init<>())
      .def(
          "build",
          [](cli::BatchSeat& seat, std::string key, FilePath mesh, FilePath tree, std::optional<FilePath> result,
             Words words, std::optional<double> time_limit, std::optional<std::size_t> memory_limit, bool no_trees) {
            const cli::BatchTask task{.key = std::move(key),
                                      .mesh = mesh.path,
                                      .tree = tree.path,
                                      .result = result ? result->path : fs::path(),
                                      .words = std::move(words),
                                      .time_limit = time_limit,
                                      .megabytes = memory_limit,
                                      .no_trees = no_trees};
            const auto found = without_gil([&] { return seat.build(task); });
            return found ? std::optional(cli::result_text(*found)) : std::nullopt;
          },
          nb::arg("key"), nb::arg("mesh"), nb::arg("tree"), nb::arg("result").none(), nb::arg("words"),
          nb::arg("time_limit").none(), nb::arg("memory_limit").none(), nb::arg("no_trees"),
          "Builds one mesh in a process of its own. result: path of the stored result; None: none. Returns the "
          "result's text, or None if the seat was stopped.")
      .def("stop", &cli::BatchSeat::stop,
           "Ends the running build and all later ones; to be called from another thread.");
}

void bind_rows(nb::module_& m) {
  m.def(
      "manifest",
      [](FilePath path) { return as_value_error([&] { return tuples_of(cli::read_manifest(path.path)); }); },
      nb::arg("path"),
      "Rows of a manifest: name as text, mesh as written, its path, and the reason if the mesh is rejected, or ''.");
  m.def(
      "manifest_of",
      [](const nb::bytes& given, bool is_csv, FilePath folder) {
        const std::string text(view_of(given));
        return as_value_error([&] { return tuples_of(cli::rows_of_manifest(text, is_csv, folder.path)); });
      },
      nb::arg("text"), nb::arg("is_csv"), nb::arg("folder"), "Rows of a manifest's text.");
  m.def(
      "keys",
      [](const std::vector<std::pair<FilePath, std::string>>& rows, const Words& words,
         const std::optional<std::vector<FilePath>>& roots) {
        return without_gil([&] {
          std::optional<FileRoots> folders;
          if (roots) folders.emplace(std::vector<fs::path>(roots->begin(), roots->end()));
          std::vector<std::pair<std::string, std::string>> keys;
          for (const auto& [path, rejection] : rows) {
            auto [key, message] =
                cli::key_of_file({{}, {}, path.path, rejection}, words, folders ? &*folders : nullptr);
            keys.emplace_back(std::move(key), std::move(message));
          }
          return keys;
        });
      },
      nb::arg("rows"), nb::arg("words"), nb::arg("roots").none(),
      "For each pair of a path and a reason: the key, or '' and the reason for its absence. roots: folders that files "
      "must lie in.");
  m.def(
      "key_of_bytes",
      [](const std::vector<nb::bytes>& files, const std::string& extension, const Words& words) {
        std::vector<std::string_view> views;
        for (const nb::bytes& file : files) views.push_back(view_of(file));
        return cli::key_of_bytes(views, extension, words);
      },
      nb::arg("files"), nb::arg("extension"), nb::arg("words"), "The key of a mesh and its buffers.");
  m.def(
      "buffers_of",
      [](const nb::bytes& mesh, const std::string& extension) { return cli::buffers_of(view_of(mesh), extension); },
      nb::arg("mesh"), nb::arg("extension"), "The buffer files that a .gltf names.");
  m.def(
      "text_of_name", [](const nb::bytes& name) { return cli::text_of_name(view_of(name)); }, nb::arg("name"),
      "A file's name as UTF-8 text, without loss.");
}

void bind_results(nb::module_& m) {
  m.def(
      "read",
      [](FilePath path) -> std::optional<nb::bytes> {
        const auto bytes = without_gil([&] { return cli::bytes_of_file(path.path); });
        if (!bytes) return std::nullopt;
        return nb::bytes(bytes->data(), bytes->size());
      },
      nb::arg("path"), "The bytes of a file; None if there is none. It does not wait for FIFOs.");
  m.def(
      "hash_of_bytes", [](const nb::bytes& bytes) { return cli::hash_of_bytes(view_of(bytes)); }, nb::arg("data"),
      "The hash of its tree's file that a result contains.");
  m.def(
      "whole_result",
      [](const nb::bytes& text, const std::string& key) {
        return cli::whole_result(std::string(view_of(text)), key).has_value();
      },
      nb::arg("text"), nb::arg("key"), "True if this is the result of the key, complete and unchanged.");
  m.def(
      "result_without_build",
      [](const std::string& key, const std::string& status, const std::string& message) {
        return cli::result_text(cli::result_without_build(key, status, cli::text_of_name(message)));
      },
      nb::arg("key"), nb::arg("status"), nb::arg("message"), "The text of a result without a build.");
  m.def(
      "tables",
      [](const std::vector<std::tuple<std::string, std::string, std::string>>& rows,
         const std::map<std::string, std::string>& results, bool no_trees) {
        const cli::BatchTables tables = without_gil([&] {
          std::vector<cli::TableRow> named;
          for (const auto& [name, key, message] : rows) named.push_back({name, key, message});
          std::map<std::string, cli::Json> parsed;
          for (const auto& [key, text] : results) parsed.emplace(key, cli::Json::parse(text));
          return cli::batch_tables(named, parsed, no_trees);
        });
        return std::make_tuple(tables.csv, tables.jsonl, tables.cost);
      },
      nb::arg("rows"), nb::arg("results"), nb::arg("no_trees"),
      "table.csv, table.jsonl and cost.csv of rows (name, key, message) and the texts of results by key.");
}

}  // namespace

void bind_batch(nb::module_& m) {
  nb::module_ batch = m.def_submodule("batch_engine", "The parts of `morula batch` that morula.batch consists of.");
  batch.def("start_workers_as", &cli::start_workers_as, nb::arg("program"), nb::arg("words"),
            "The command of a worker: a program, and its arguments ahead of the worker's.");
  batch.def(
      "build_words",
      [](const Words& options) { return as_value_error([&] { return cli::checked_build_words(options); }); },
      nb::arg("options"),
      "Options of `morula batch`, checked as in the command: those that affect results, in one spelling. Raises "
      "ValueError.");
  batch.def("remade_text", &cli::remade_text, nb::arg("count"), "The note on kept results that could not be used.");
  bind_seat(batch);
  bind_rows(batch);
  bind_results(batch);
}

}  // namespace morula::python
