// The gallery's page.
#include "app/gallery_page.h"

#include "engine/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <tuple>

namespace rend {

namespace {

constexpr const char* kHeader = "scene,particles,steps_per_frame,simulate_seconds,post_seconds\n";

/// Seconds per frame that the slides of 2019 print beside an experiment.
struct SlideFigures {
  const char *prefix, *simulate, *post;
};
constexpr SlideFigures kSlides[] = {
    {"e1_", "2", "5"},   {"e2_", "11", "n/a"}, {"e3_", "11", "5"},
    {"e4_", "16", "13"}, {"e5_", "35", "16"},  {"e6_", "5", "0.2"},
    {"e7_", "15", "8"},  {"e8_", "11", "4"},   {"e10_", "0.6", "0.5"},
};

/// Scenes that only say something side by side.
struct Comparison {
  const char *prefix, *title, *lesson;
};
constexpr Comparison kComparisons[] = {
    {"e8_", "E8: three thresholds in a frame",
     "The same block under the same press: the lower the von Mises threshold, the sooner and the "
     "wider it fails."},
    {"e10_", "E10: three ways to compute forces",
     "Nothing here is strained to failure: gaps on the fine particle grid are numerical, and mesh "
     "forces do not have them."},
    {"e11_60k", "E11: 60 thousand particles, three grids",
     "With the particles fixed, a finer grid gives thinner cracks but fewer particles a cell."},
    {"e11_17k", "E11: 17 thousand particles, three grids",
     "Fewer particles need a coarser grid: each picture has nearly as many particles a cell as the "
     "one above."},
};

int experiment_number(const std::string& name) {
  const bool experiment = name.size() > 1 && name[0] == 'e' && name[1] >= '0' && name[1] <= '9';
  return experiment ? std::atoi(name.c_str() + 1) : 1000;
}

std::string folder_of(const GalleryEntry& entry) { return entry.local ? "local/" : ""; }

std::string figures_row(const GalleryEntry& entry,
                        const std::map<std::string, GalleryFigures>& figures) {
  const auto slide =
      std::find_if(std::begin(kSlides), std::end(kSlides),
                   [&](const SlideFigures& s) { return entry.name.starts_with(s.prefix); });
  const bool known = slide != std::end(kSlides);
  const auto found = figures.find(entry.name);
  std::string row = fmt::format("| {} |", entry.name);
  if (found == figures.end()) return row + " not measured | | | | | |\n";
  const GalleryFigures& f = found->second;
  return row + fmt::format(" {} | {:.0f} | {:.2g} | {} | {:.2g} | {} |\n", f.particles, f.steps,
                           f.simulate, known ? slide->simulate : "", f.post,
                           known ? slide->post : "");
}

std::string comparison_section(const Comparison& comparison,
                               const std::vector<const GalleryEntry*>& members) {
  std::string names = "|", rule = "|", stills = "|", notes;
  for (const GalleryEntry* entry : members) {
    names += " " + entry->name + " |";
    rule += "---|";
    stills += fmt::format(" ![{0}]({1}{0}.jpg) |", entry->name, folder_of(*entry));
    notes += fmt::format("\n**{0}**: {1}\n\n![{0}, five frames]({2}{0}_strip.jpg)\n", entry->name,
                         entry->description, folder_of(*entry));
  }
  return fmt::format("\n## {}\n\n{}\n\n{}\n{}\n{}\n{}", comparison.title, comparison.lesson,
                     names, rule, stills, notes);
}

std::string scene_section(const GalleryEntry& entry) {
  std::string text = fmt::format("\n## {}\n\n{}\n\n", entry.name, entry.description);
  if (entry.local)
    return text +
           fmt::format(
               "The mesh of this scene is not ours to show. `./rend gallery --only {0}` makes "
               "[the picture](local/{0}.jpg) and [the strip](local/{0}_strip.jpg) on your "
               "machine.\n",
               entry.name);
  return text + fmt::format("![{0}]({0}.jpg)\n\n![{0}, five frames]({0}_strip.jpg)\n", entry.name);
}

}  // namespace

std::map<std::string, GalleryFigures> read_figures(const std::filesystem::path& file) {
  std::map<std::string, GalleryFigures> figures;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    const std::size_t comma = line.find(',');
    GalleryFigures f;
    if (comma == std::string::npos ||
        std::sscanf(line.c_str() + comma, ",%ld,%lf,%lf,%lf", &f.particles, &f.steps, &f.simulate,
                    &f.post) != 4)
      throw Error(file.string(),
                  "cannot read the line \"" + line + "\"; it must hold a name and four numbers");
    figures[line.substr(0, comma)] = f;
  }
  return figures;
}

std::string figures_csv(const std::map<std::string, GalleryFigures>& figures) {
  std::string text = kHeader;
  for (const auto& [name, f] : figures)
    text +=
        fmt::format("{},{},{:.1f},{:.4f},{:.4f}\n", name, f.particles, f.steps, f.simulate, f.post);
  return text;
}

void sort_entries(std::vector<GalleryEntry>& entries) {
  std::sort(entries.begin(), entries.end(), [](const GalleryEntry& a, const GalleryEntry& b) {
    return std::tuple(experiment_number(a.name), a.name) <
           std::tuple(experiment_number(b.name), b.name);
  });
}

std::string gallery_page(const std::vector<GalleryEntry>& entries,
                         const std::map<std::string, GalleryFigures>& figures) {
  std::string page =
      "# Gallery\n\nEvery scene of `scenes/`, made by `./rend gallery`. E1 to E11 follow the "
      "experiments of Stephanie Wang's slides "
      "\"Simulation and visualization of ductile fracture with MPM\" (2019): their particle "
      "counts, and their seconds per "
      "frame beside ours. The slides name neither objects nor hardware, so objects are our own "
      "choice. Ours are medians "
      "over a run on two shared cores.\n\n"
      "| scene | particles | steps per frame | simulate, s | slides, s | post-process, s | slides, "
      "s |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n";
  for (const GalleryEntry& entry : entries) page += figures_row(entry, figures);
  const Comparison* open = nullptr;
  for (const GalleryEntry& entry : entries) {
    const auto* comparison =
        std::find_if(std::begin(kComparisons), std::end(kComparisons),
                     [&](const Comparison& c) { return entry.name.starts_with(c.prefix); });
    if (comparison == std::end(kComparisons)) {
      page += scene_section(entry);
      continue;
    }
    if (comparison == open) continue;
    open = comparison;
    std::vector<const GalleryEntry*> members;
    for (const GalleryEntry& other : entries)
      if (other.name.starts_with(comparison->prefix)) members.push_back(&other);
    page += comparison_section(*comparison, members);
  }
  return page;
}

}  // namespace rend
