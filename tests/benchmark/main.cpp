// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/benchmark/cases.hpp"
#include "tests/benchmark/measure.hpp"
#include "tests/benchmark/report.hpp"

namespace {

constexpr int kExitUsage = 64;
constexpr int kExitFailure = 70;

struct Options {
  std::string json_path;
  std::vector<std::string> only;
  int repetitions = 15;
  bool with_slow = false;
};

bool IsWanted(const Options& options, const std::string& name) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), name) != options.only.end();
}

int Run(const Options& options) {
  namespace bench = clearway::bench;
  std::vector<bench::Row> rows;
  for (const bench::Case& test_case : bench::MakeCases(options.with_slow)) {
    if (!IsWanted(options, test_case.name)) continue;
    std::cerr << "measuring " << test_case.name << " (" << test_case.cloud.size() << " points)\n";
    const auto measured = bench::Measure(test_case, options.repetitions);
    rows.insert(rows.end(), measured.begin(), measured.end());
  }
  if (rows.empty()) {
    std::cerr << "clearway-bench: no case of that name; slow ones need --all, recorded ones their "
                 "recordings\n";
    return kExitUsage;
  }
  std::cout << bench::ToTable(rows) << std::flush;
  if (options.json_path.empty()) return 0;
  std::ofstream file(options.json_path);
  file << bench::ToJson(rows) << std::flush;
  if (file) return 0;
  std::cerr << "clearway-bench: cannot write '" << options.json_path << "'\n";
  return kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Measures the stages of perception and the whole chain on generated and, where they "
      "are here, recorded scans."};
  app.add_option("--json", options.json_path, "Also write the figures to this file");
  app.add_option("--case", options.only, "Measure these cases only");
  app.add_option("--repetitions", options.repetitions, "Repetitions of each measurement")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_flag("--all", options.with_slow, "Also the cases that take seconds or more");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  try {
    return Run(options);
  } catch (const std::exception& error) {
    std::cerr << "clearway-bench: " << error.what() << "\n";
    return kExitFailure;
  }
}
