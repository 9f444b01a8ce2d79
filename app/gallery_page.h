// The gallery's page: measured figures of every scene beside those of the 2019 slides, as Markdown.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rend {

/// What a run of a scene cost.
struct GalleryFigures {
  long particles = 0;
  double steps = 0;               ///< per frame, mean
  double simulate = 0, post = 0;  ///< wall seconds per frame, median over the run
};

/// A scene as the page shows it.
struct GalleryEntry {
  std::string name, description;
  bool local =
      false;  ///< pictures stay out of the repository, in local/: the scene's mesh is not ours
};

/// By scene name. A file that does not exist gives no figures. @throws Error for a line that does
/// not read.
std::map<std::string, GalleryFigures> read_figures(const std::filesystem::path& file);

std::string figures_csv(const std::map<std::string, GalleryFigures>& figures);

/// E1, E2, ... E11 by their numbers, then the others by name.
void sort_entries(std::vector<GalleryEntry>& entries);

/// The page; scenes without figures are listed without them.
std::string gallery_page(const std::vector<GalleryEntry>& entries,
                         const std::map<std::string, GalleryFigures>& figures);

}  // namespace rend
