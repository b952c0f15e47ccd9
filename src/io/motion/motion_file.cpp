// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <morula/io/files.hpp>
#include <morula/io/motion_file.hpp>
#include <set>

#include "io/array/stored_zip.hpp"
#include "io/byte_reader.hpp"
#include "io/mesh/formats.hpp"
#include "io/motion/array_motion.hpp"
#include "io/motion/point_cache.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

namespace fs = std::filesystem;

/// The frames of an array, read one at a time.
class ArrayFrames final : public FrameSource {
 public:
  ArrayFrames(ByteSource source, const MeshView& mesh)
      : source_(std::move(source)),
        array_(motion_array(source_, mesh.vertex_count())),
        facets_(mesh.facets.begin(), mesh.facets.end()),
        vertex_count_(mesh.vertex_count()) {}
  std::size_t frame_count() const override { return array_.shape[0]; }
  std::vector<Vec3> frame(std::size_t i) const override { return motion_frame(source_, array_, vertex_count_, i); }
  const std::vector<Facet>& facets() const override { return facets_; }
  std::size_t vertex_count() const override { return vertex_count_; }

 private:
  ByteSource source_;
  NpyArray array_;
  std::vector<Facet> facets_;
  std::size_t vertex_count_;
};

std::set<std::string> mesh_extensions() {
  std::set<std::string> extensions;
  for (const MeshFormat& format : mesh_formats) extensions.emplace(format.extension);
  return extensions;
}

std::vector<fs::path> frames_in(const fs::path& folder, std::string_view pattern, const fs::path& given) {
  std::vector<fs::path> files = frame_files(folder.empty() ? "." : folder, pattern, mesh_extensions());
  if (files.empty())
    throw FileError(platform::text_of(given) + ": no mesh file is there; a motion needs files ending in " +
                    readable_mesh_extensions());
  for (const fs::path& file : files)
    if (lower_extension(file) != lower_extension(files.front()))
      throw FileError(platform::text_of(given) + ": holds meshes of several kinds (" +
                      platform::text_of(files.front().filename()) + ", " + platform::text_of(file.filename()) +
                      "); name one kind, such as " +
                      platform::text_of(folder / ("*" + platform::text_of(files.front().extension()))));
  return files;
}

std::string frame_file_name(std::size_t frame, const std::string& extension) {
  const std::string digits = std::to_string(frame);
  return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits + extension;
}

bool is_frame_of(const std::string& name, std::size_t frame_count, const std::string& extension) {
  std::size_t frame = 0;
  const char* const end = name.data() + name.size();
  if (std::from_chars(name.data(), end, frame).ec != std::errc() || frame >= frame_count) return false;
  return name == frame_file_name(frame, extension);
}

}  // namespace

Motion::Motion(const fs::path& path, const MeshView& mesh, const MotionOptions& options)
    : vertex_count_(options.weld != nullptr ? options.weld->new_vertex.size() : mesh.vertex_count()),
      facets_(mesh.facets.begin(), mesh.facets.end()) {
  if (options.weld != nullptr) {
    if (options.weld->old_vertex.size() != mesh.vertex_count())
      throw std::invalid_argument("MotionOptions::weld makes " + std::to_string(options.weld->old_vertex.size()) +
                                  " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
    weld_ = *options.weld;
  }
  const std::vector<Vec3> of_file(weld_ ? vertex_count_ : 0);
  const MeshView in_file = weld_ ? MeshView{of_file, mesh.facets} : mesh;
  std::error_code ignored;
  const std::string name = platform::text_of(path.filename());
  if (fs::is_directory(path, ignored)) {
    files_ = frames_in(path, "*", path);
  } else if (!fs::exists(path, ignored) && name.find_first_of("*?") != std::string::npos) {
    files_ = frames_in(path.parent_path(), name, path);
  } else {
    const std::string extension = lower_extension(path);
    const MeshFormat* const format = mesh_format(extension);
    const bool is_array = extension == ".npy" || extension == ".npz" || is_point_cache(extension);
    if (!is_array && format == nullptr) {
      if (!fs::exists(path, ignored))
        throw SystemFileError(
            path, "there is no such folder, and no file of this name; check the name, or where you are", ENOENT);
      throw FileError(platform::text_of(path) +
                      ": is not a motion; name a folder, a pattern such as 'out/frame*.obj', or a file " +
                      "ending in .npy .npz .pc2 .mdd " + readable_mesh_extensions());
    }
    size_of_file(path);
    files_ = {path};
    if (is_point_cache(extension))
      source_ = open_point_cache(path, in_file);
    else if (is_array)
      source_ =
          std::make_shared<ArrayFrames>(extension == ".npz" ? motion_in_archive(path) : ByteSource(path), in_file);
    else if (format->open_frames != nullptr)
      source_ = format->open_frames(path, options);
    if (source_ && !is_array) require_frames_of(path, source_->vertex_count(), source_->facets());
  }
  frame_count_ = source_ ? source_->frame_count() : files_.size();
}

void Motion::require_frames_of(const fs::path& file, std::size_t vertex_count, std::span<const Facet> facets) const {
  const auto differs = [&](const std::string& how) {
    const std::string_view own = mesh_format(lower_extension(file))->frame_remedy;
    const std::string_view usual = "all frames need the vertices and facets of the mesh at rest, in the same order";
    throw FileError(platform::text_of(file) + ": " + how + "; " + std::string(own.empty() ? usual : own));
  };
  if (vertex_count != vertex_count_)
    differs("has " + std::to_string(vertex_count) + " vertices, but the mesh has " + std::to_string(vertex_count_));
  if (facets.size() != facets_.size())
    differs("has " + std::to_string(facets.size()) + " facets, but the mesh has " + std::to_string(facets_.size()));
  const auto is_same = [&](Facet own, const Facet& rest) {
    for (std::uint32_t& v : own) v = weld_ ? weld_->new_vertex[v] : v;
    return own == rest;
  };
  const auto [own, rest] = std::mismatch(facets.begin(), facets.end(), facets_.begin(), is_same);
  if (own != facets.end())
    differs("facet " + std::to_string(rest - facets_.begin()) + ", counted from 0, has other vertices than the mesh's");
}

std::vector<Vec3> Motion::frame(std::size_t i) const {
  if (!weld_) return unwelded_frame(i);
  const std::vector<Vec3> positions = unwelded_frame(i);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const std::uint32_t first = weld_->old_vertex[weld_->new_vertex[v]];
    // mutant weld-moves-apart: `positions[v] != positions[first]` -> `false`
    if (positions[v] != positions[first])
      throw FileError(platform::text_of(source_ ? files_.front() : files_[i]) + ": frame " + std::to_string(i) +
                      ": vertices " + std::to_string(first) + " and " + std::to_string(v) +
                      " of the unwelded mesh are merged, but they are at different positions; read the mesh without "
                      "welding");
  }
  return welded_positions(positions, *weld_);
}

std::vector<Vec3> Motion::unwelded_frame(std::size_t i) const {
  assert(i < frame_count_);
  if (source_) return source_->frame(i);
  // A polygon that has become concave is still cut as in the mesh at rest.
  MeshReading reading;
  reading.cut_like = facets_;
  // mutant weld-frames-cut: `if (weld_) reading.cut_like_vertex = weld_->new_vertex` -> ``
  if (weld_) reading.cut_like_vertex = weld_->new_vertex;
  Mesh mesh = read_mesh_as(files_[i], reading);
  require_frames_of(files_[i], mesh.vertex_count(), mesh.facets);
  return std::move(mesh.positions);
}

ByteSource detail::motion_in_archive(const ByteSource& archive) {
  std::vector<ZipEntry> arrays;
  std::string names;
  for (ZipEntry& entry : zip_entries(archive)) {
    if (lower_extension(entry.name) != ".npy") continue;
    const std::string name = entry.name.substr(0, entry.name.size() - 4);
    if (name == "positions") return zip_part(archive, entry);
    names += (names.empty() ? "" : ", ") + in_quotes(name);
    arrays.push_back(std::move(entry));
  }
  if (arrays.size() == 1) return zip_part(archive, arrays.front());
  const std::string file = platform::text_of(archive.name());
  if (arrays.empty()) throw FileError(file + ": holds no arrays; write one with numpy.savez(FILE, positions=array)");
  for (const ZipEntry& entry : arrays)
    if (entry.name == "spheres.npy")
      throw FileError(file + ": holds spheres, not positions of vertices; use it in place of a tree");
  throw FileError(file + ": holds the arrays " + names + ", and none is called 'positions'; save it under this name");
}

NpyArray detail::motion_array(const ByteSource& source, std::size_t vertex_count) {
  NpyArray array = read_npy_header(source, {{0, vertex_count, 3}, "(frames, vertices, 3)"});
  const std::string name = platform::text_of(source.name());
  if (array.shape[0] == 0) throw FileError(name + ": the array has no frames");
  if (array.shape[1] != vertex_count)
    throw FileError(name + ": the array has " + std::to_string(array.shape[1]) +
                    " vertices a frame, but the mesh has " + std::to_string(vertex_count));
  return array;
}

std::vector<Vec3> detail::motion_frame(const ByteSource& source, const NpyArray& array, std::size_t vertex_count,
                                       std::size_t frame) {
  const std::size_t numbers = 3 * vertex_count;
  const std::vector<double> values = read_npy_values(source, array, frame * numbers, numbers);
  std::vector<Vec3> positions(vertex_count);
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    poll_interrupt();
    positions[v] = {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
    if (!is_finite(positions[v]))
      throw FileError(platform::text_of(source.name()) + ": frame " + std::to_string(frame) + ": vertex " +
                      std::to_string(v) + " has a coordinate that is not finite; repair it where the array was made");
  }
  return positions;
}

std::string Motion::frame_name(std::size_t i) const {
  assert(i < frame_count_);
  if (source_) return platform::text_of(files_[0].filename()) + " frame " + std::to_string(i);
  return platform::text_of(files_[i].filename());
}

MotionWriter::MotionWriter(const fs::path& path, const MeshView& mesh, std::size_t frame_count,
                           const std::string& extension)
    : path_(path), extension_(extension), mesh_(to_mesh(mesh)), frame_count_(frame_count) {
  require_usable(mesh);
  if (frame_count == 0) throw std::invalid_argument("a motion has at least one frame");
  if (!is_frame_extension(extension))
    throw std::invalid_argument("frames are written as .obj, .off, .ply or .vtp, not as " + in_quotes(extension));
  const std::string own_extension = lower_extension(path);
  std::error_code error;
  if (own_extension == ".npy" || is_point_cache(own_extension)) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, error)) throw SystemFileError(path, "there is no such folder; make it first", ENOENT);
    const bool is_npy = own_extension == ".npy";
    const std::string start = is_npy ? npy_start("<f8", std::array{frame_count, mesh.vertex_count(), std::size_t{3}})
                                     : point_cache_start(own_extension, mesh.vertex_count(), frame_count);
    const std::uint64_t frame_bytes = (is_npy ? 24 : 12) * std::uint64_t{mesh.vertex_count()};
    if (frame_count > (std::uint64_t{1} << 62) / frame_bytes)
      throw FileError(platform::text_of(path) + ": " + std::to_string(frame_count) +
                      " frames are too many for any disk");
    require_room(path, start.size() + frame_bytes * frame_count);
    npy_.emplace(path);
    npy_->write(start);
    return;
  }
  if (fs::exists(path, error) ? !fs::is_directory(path, error) : mesh_format(own_extension) != nullptr)
    throw FileError(platform::text_of(path) +
                    ": a motion is written into a folder or a .npy, .pc2 or .mdd file, not into one mesh file");
  // Frames of a longer motion that was in this folder would be read as part of this one.
  for (fs::directory_iterator entry(path, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = platform::text_of(entry->path().filename());
    if (name[0] != '.' && mesh_format(lower_extension(name)) != nullptr && !is_frame_of(name, frame_count, extension))
      throw FileError(platform::text_of(entry->path()) + ": would be read as part of this motion of " +
                      std::to_string(frame_count) + " frames; empty the folder, or choose another");
  }
  const fs::path parent = (path.has_filename() ? path : path.parent_path()).parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  folder_.emplace(path);
}

void MotionWriter::write(std::span<const Vec3> positions) {
  if (written_ == frame_count_)
    throw std::invalid_argument("the motion has " + std::to_string(frame_count_) + " frames; this is one more");
  // Checks for interruption ahead of a frame, because a frame is written whole.
  check_interrupt();
  const std::string frame = "frame " + std::to_string(written_);
  if (positions.size() != mesh_.vertex_count())
    throw std::invalid_argument(frame + " has " + std::to_string(positions.size()) + " positions, but the mesh has " +
                                std::to_string(mesh_.vertex_count()) + " vertices");
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!is_finite(positions[v]))
      throw std::invalid_argument(frame + ": vertex " + std::to_string(v) + " has a coordinate that is not finite");

  if (npy_) {
    chunk_.clear();
    const std::string extension = lower_extension(path_);
    if (is_point_cache(extension)) {
      append_point_cache_frame(chunk_, extension, positions);
    } else {
      InterruptPoller poll_interrupt(1u << 16);
      for (const Vec3& p : positions) {
        poll_interrupt();
        for (const double number : {p.x, p.y, p.z}) store(chunk_, number);
      }
    }
    npy_->write(chunk_);
  } else {
    const std::string bytes = mesh_bytes(extension_, {positions, mesh_.facets});
    // Frames are about as long as the first: half of their estimated size is certainly needed.
    if (written_ == 0) require_room(path_, bytes.size() / 2 * frame_count_);
    write_whole(folder_->path() / frame_file_name(written_, extension_), bytes);
  }
  ++written_;
}

void MotionWriter::finish() {
  if (written_ < frame_count_)
    throw FileError(platform::text_of(path_) + ": " + std::to_string(written_) + " of " + std::to_string(frame_count_) +
                    " frames were written; the motion is incomplete");
  if (npy_)
    npy_->commit();
  else
    folder_->commit();
}

}  // namespace morula
