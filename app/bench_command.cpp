// `rend bench`.
#include "app/bench_command.h"

#include "app/write_file.h"
#include "bench/bench_accuracy.h"
#include "bench/bench_cracks.h"
#include "bench/bench_fracture.h"
#include "bench/bench_render.h"
#include "bench/bench_solver.h"
#include "bench/bench_variants.h"
#include "bench/bench_worst_cases.h"
#include "engine/core/error.h"
#include "render/image_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <iostream>
#include <memory>

namespace rend {

namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

File open_csv(const std::filesystem::path& path) {
  if (path.empty()) return nullptr;
  File file(std::fopen(path.c_str(), "w"));
  if (!file) throw Error(path.string(), std::string("cannot be written: ") + std::strerror(errno));
  return file;
}

void print_study(const StudyOutput& study, const BenchOptions& options) {
  fmt::print("{}", study.table);
  if (!options.csv.empty()) write_file(options.csv, study.csv);
  if (options.out.empty()) return;
  make_folder(options.out);
  write_file(options.out / (options.name + ".csv"), study.csv);
  write_file(options.out / (options.name + ".md"), study.table);
  for (const LogPlot& plot : study.plots) {
    write_file(options.out / (plot.name + ".svg"), plot_svg(plot));
    write_png(options.out / (plot.name + ".png"), plot_image(plot), 9);
  }
}

}  // namespace

const std::vector<std::string>& bench_names() {
  static const std::vector<std::string> names = {"solver", "worst", "fracture",
                                                 "render", "accuracy", "cracks"};
  return names;
}

void run_bench(const BenchOptions& options) {
  const StudySize size = options.quick ? StudySize::quick : StudySize::full;
  if (options.name == "accuracy")
    return print_study(bench_accuracy(size, options.scenes, stderr), options);
  if (options.name == "cracks")
    return print_study(bench_cracks(size, options.scenes, stderr), options);
  const File csv = open_csv(options.csv);
  if (options.name == "solver") {
    print_solver_bench(bench_solver(options.quick, stderr), stdout, csv.get());
    print_variants("tile solver, features", bench_features(options.quick, stderr), stdout);
    print_variants("tile solver, sizes", bench_sizes(options.quick, stderr), stdout);
    print_worst_cases(bench_worst_cases(options.quick), stdout);
  } else if (options.name == "worst") {
    print_worst_cases(bench_worst_cases(options.quick), stdout);
  } else if (options.name == "fracture") {
    const std::vector<Index> sizes = options.quick ? std::vector<Index>{4000, 60000}
                                                   : std::vector<Index>{4000, 60000, 207000, 1000000};
    print_fracture_bench(sizes, stdout, csv.get());
  } else {
    print_render_bench(std::cout, bench_render(options.quick));
  }
}

}  // namespace rend
