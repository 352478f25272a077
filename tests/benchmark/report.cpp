// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/report.hpp"

#include <iomanip>
#include <sstream>

#include <nlohmann/json.hpp>

namespace clearway::bench {
namespace {

std::string Number(const std::optional<double>& value, int digits) {
  if (!value) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << *value;
  return text.str();
}

nlohmann::ordered_json ToObject(const Row& row) {
  nlohmann::ordered_json object = {{"case", row.case_name},
                                   {"points", row.points},
                                   {"stage", row.stage},
                                   {"textbook_ms", row.textbook_ms},
                                   {"textbook_p99_ms", row.textbook_p99_ms}};
  if (row.ns_per_point) object["ns_per_point"] = *row.ns_per_point;
  if (row.pcl_ms) object["pcl_ms"] = *row.pcl_ms;
  if (row.ratio_to_pcl) object["ratio_to_pcl"] = *row.ratio_to_pcl;
  if (row.partition_equal) object["partition_equal"] = *row.partition_equal;
  return object;
}

}  // namespace

std::string ToJson(const std::vector<Row>& rows) {
  nlohmann::ordered_json document;
  document["rows"] = nlohmann::ordered_json::array();
  for (const Row& row : rows) document["rows"].push_back(ToObject(row));
  return document.dump(2) + "\n";
}

std::string ToTable(const std::vector<Row>& rows) {
  std::ostringstream table;
  table << std::left << std::setw(25) << "case" << std::setw(12) << "stage" << std::right
        << std::setw(9) << "points" << std::setw(13) << "textbook_ms" << std::setw(10) << "p99_ms"
        << std::setw(12) << "ns/point" << std::setw(10) << "pcl_ms" << std::setw(8) << "ratio"
        << std::setw(7) << "equal"
        << "\n";
  for (const Row& row : rows) {
    const char* equal = !row.partition_equal ? "-" : *row.partition_equal ? "yes" : "NO";
    table << std::left << std::setw(25) << row.case_name << std::setw(12) << row.stage << std::right
          << std::setw(9) << row.points << std::setw(13) << Number(row.textbook_ms, 3)
          << std::setw(10) << Number(row.textbook_p99_ms, 3) << std::setw(12)
          << Number(row.ns_per_point, 1) << std::setw(10) << Number(row.pcl_ms, 3) << std::setw(8)
          << Number(row.ratio_to_pcl, 3) << std::setw(7) << equal << "\n";
  }
  return table.str();
}

}  // namespace clearway::bench
