// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page's additions to the command: `view`, and `collide --page`.
#include "shared/extension.hpp"

#include <fmt/format.h>

#include <morula/page/collide_page.hpp>
#include <utility>

#include "notices.hpp"
#include "shared/files.hpp"

namespace morula::cli {

void add_view(CLI::App& app, Run& run);

namespace {

void require_collide_page(const std::string& page, const std::vector<std::filesystem::path>& inputs) {
  if (!has_page()) throw UsageError(fmt::format("this morula was built without its page: {}", why_no_page()));
  if (const std::string ending = extension(page); ending != ".html" && ending != ".htm")
    throw UsageError(fmt::format("--page {}: pages are written as .html", page));
  require_output_place(page);
  require_not_input(page, inputs);
}

/// CollidePage as the command calls it.
class PageOfCollide final : public CollideView {
 public:
  explicit PageOfCollide(CollidePage page) : page_(std::move(page)) {}
  void mark(std::span<const Contact> contacts, std::span<const ContactSurface> surfaces) override {
    add_marks(contacts, surfaces, marks_);
  }
  void end_frame(const std::string& name) override { page_.add(name, std::exchange(marks_, {})); }
  void end_frame_with_patches(const std::string& name, std::span<const ContactPatch> patches,
                              std::span<const Crossing> crossings) override {
    page_.add(name, patches, crossings);
  }
  std::string text() const override { return page_.text(); }

 private:
  CollidePage page_;
  std::vector<PageContact> marks_;  ///< marks of the present frame
};

std::unique_ptr<CollideView> make_collide_page(const std::string& title, std::vector<const Collider*> bodies,
                                               const std::string& rule) {
  return std::make_unique<PageOfCollide>(CollidePage(title, std::move(bodies), rule));
}

}  // namespace

Extension page_extension() {
  Extension extension;
  extension.commands = {add_view};
  if (has_page()) extension.notices = page_notices();
  extension.collide_views = {require_collide_page, make_collide_page};
  return extension;
}

}  // namespace morula::cli
