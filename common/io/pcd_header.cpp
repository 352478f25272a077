// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_header.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/io/read_error.hpp"
#include "common/io/text.hpp"

namespace clearway::io {

namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::array<std::string_view, 6> kVersions = {".5", ".6", ".7", "0.5", "0.6", "0.7"};
constexpr std::array<std::string_view, 9> kEntries =
    {"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS"};
// A cloud of that many takes 1.8 GB of memory; a robot's computer has 4.
constexpr std::uint64_t kMaxPoints = 100'000'000;
constexpr std::uint64_t kMaxCount = 1'000'000;

/// One line of the header. Line 0: the file has no such entry.
struct Entry {
  std::vector<std::string_view> values;
  std::size_t line = 0;
};

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  PcdHeader Parse() {
    CollectEntries();
    CheckVersion();
    MakeFields();
    SetLayout();
    header_.width = Count("WIDTH");
    header_.height = Count("HEIGHT");
    header_.points = Points();
    SetViewpoint();
    return std::move(header_);
  }

 private:
  void CollectEntries() {
    LineReader lines(bytes_);
    std::size_t start = 0;
    while (const auto line = lines.Next()) {
      std::string_view text = *line;
      if (start == 0 && text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
      std::vector<std::string_view> words = SplitWords(text);
      if (!words.empty() && words[0] == "DATA") return ReadData(text, lines);
      if (!words.empty() && !words[0].starts_with('#')) Store(std::move(words), lines.line());
      start = lines.position();
    }
    throw ErrorInLine(file_,
                      lines.line(),
                      "the file ends after " + std::to_string(bytes_.size()) +
                          " bytes, before the DATA line of its header");
  }

  void Store(std::vector<std::string_view> words, std::size_t line) {
    const std::string_view key = words[0] == "COLUMNS" ? "FIELDS" : words[0];
    if (std::find(kEntries.begin(), kEntries.end(), key) == kEntries.end()) {
      throw ErrorInLine(file_,
                        line,
                        "unknown header entry " + Quoted(words[0]) +
                            "; a PCD header has # VERSION FIELDS SIZE TYPE COUNT WIDTH HEIGHT "
                            "VIEWPOINT POINTS DATA");
    }
    Entry& entry = entries_[key];
    if (entry.line != 0) {
      throw ErrorInLine(
          file_,
          line,
          std::string(key) + " is there twice, first in line " + std::to_string(entry.line));
    }
    words.erase(words.begin());
    entry = {.values = std::move(words), .line = line};
  }

  /// Sets encoding and start of the body from the DATA line, after which `lines` stands.
  void ReadData(std::string_view text, const LineReader& lines) {
    const std::string_view value = Trim(text.substr(text.find("DATA") + 4));
    data_line_ = lines.line();
    header_.body_line = data_line_ + 1;
    header_.body_offset = lines.position();
    if (value == "binary_compressed") {
      header_.encoding = PcdEncoding::kBinaryCompressed;
    } else if (value == "binary") {
      header_.encoding = PcdEncoding::kBinary;
    } else if (value.starts_with("ascii") && StartsARow(value.substr(5))) {
      header_.encoding = PcdEncoding::kAscii;
      header_.glued_row = Trim(value.substr(5));
    } else {
      throw ErrorInLine(file_,
                        lines.line(),
                        "DATA " + Quoted(value) + ": expected ascii, binary or binary_compressed");
    }
  }

  /// Some files lack the line end after `DATA ascii`: then a row follows.
  static bool StartsARow(std::string_view rest) {
    return rest.empty() || std::string_view(" \t+-.0123456789nN").find(rest[0]) != rest.npos;
  }

  [[nodiscard]] const Entry& Get(std::string_view key) const {
    static const Entry kAbsent;
    const auto found = entries_.find(key);
    return found == entries_.end() ? kAbsent : found->second;
  }

  void CheckVersion() const {
    const Entry& entry = Get("VERSION");
    if (entry.line == 0) return;
    const std::string_view version = entry.values.empty() ? "" : entry.values[0];
    if (std::find(kVersions.begin(), kVersions.end(), version) == kVersions.end()) {
      throw ErrorInLine(
          file_, entry.line, "VERSION " + Quoted(version) + ": expected .5, .6 or .7");
    }
  }

  void MakeFields() {
    const Entry& fields = Get("FIELDS");
    if (fields.values.empty()) {
      throw ErrorInLine(file_,
                        fields.line != 0 ? fields.line : data_line_,
                        "FIELDS is " + std::string(fields.line != 0 ? "empty" : "missing") +
                            "; expected at least x y z");
    }
    for (const std::string_view name : fields.values) {
      header_.fields.push_back({.name = std::string(name)});
    }
    const bool is_ascii = header_.encoding == PcdEncoding::kAscii;
    const Entry& sizes = PerField("SIZE", is_ascii);
    const Entry& types = PerField("TYPE", is_ascii);
    const Entry& counts = PerField("COUNT", true);
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      if (sizes.line != 0) header_.fields[i].size = Size(sizes, i);
      if (types.line != 0) header_.fields[i].type = Type(types, i);
      if (counts.line != 0) header_.fields[i].count = ValueCount(counts, i);
    }
  }

  /// An entry that has one value for each field.
  [[nodiscard]] const Entry& PerField(std::string_view key, bool may_be_missing) const {
    const Entry& entry = Get(key);
    if (entry.line == 0) {
      if (may_be_missing) return entry;
      throw ErrorInLine(file_, data_line_, std::string(key) + " is missing in the header");
    }
    if (entry.values.size() != header_.fields.size()) {
      throw ErrorInLine(file_,
                        entry.line,
                        std::string(key) + " has " + std::to_string(entry.values.size()) +
                            " values, FIELDS has " + std::to_string(header_.fields.size()));
    }
    return entry;
  }

  [[nodiscard]] std::size_t Size(const Entry& entry, std::size_t i) const {
    const auto size = ParseWhole(entry.values[i]);
    if (size == 1 || size == 2 || size == 4 || size == 8) return static_cast<std::size_t>(*size);
    throw ErrorInLine(file_, entry.line, Named("SIZE", entry, i) + ": expected 1, 2, 4 or 8");
  }

  [[nodiscard]] char Type(const Entry& entry, std::size_t i) const {
    const std::string_view type = entry.values[i];
    if (type == "I" || type == "U" || type == "F") return type[0];
    throw ErrorInLine(file_, entry.line, Named("TYPE", entry, i) + ": expected I, U or F");
  }

  [[nodiscard]] std::size_t ValueCount(const Entry& entry, std::size_t i) const {
    // Ouster's recordings announce padding of no bytes: `_` with COUNT 0.
    const std::uint64_t least = header_.fields[i].name == "_" ? 0 : 1;
    const auto count = ParseWhole(entry.values[i]);
    if (count && *count >= least && *count <= kMaxCount) return static_cast<std::size_t>(*count);
    throw ErrorInLine(file_,
                      entry.line,
                      Named("COUNT", entry, i) + ": expected a whole number in [" +
                          std::to_string(least) + ", " + std::to_string(kMaxCount) + "]");
  }

  [[nodiscard]] std::string Named(const std::string& key, const Entry& entry, std::size_t i) const {
    return key + " " + Quoted(entry.values[i]) + " of field " + Quoted(header_.fields[i].name);
  }

  void SetLayout() {
    for (PcdField& field : header_.fields) {
      field.offset = header_.point_bytes;
      field.column = header_.columns;
      header_.point_bytes += field.size * field.count;
      header_.columns += field.count;
    }
  }

  /// A count of points; 0 when the entry is missing.
  [[nodiscard]] std::uint64_t Count(std::string_view key) const {
    const Entry& entry = Get(key);
    if (entry.line == 0) return 0;
    if (entry.values.size() == 1) {
      const auto count = ParseWhole(entry.values[0]);
      if (count && *count <= kMaxPoints) return *count;
    }
    throw ErrorInLine(file_,
                      entry.line,
                      std::string(key) + " " + Quoted(entry.values.empty() ? "" : entry.values[0]) +
                          (entry.values.size() > 1 ? " and more" : "") +
                          ": expected one whole number in [0, " + std::to_string(kMaxPoints) + "]");
  }

  [[nodiscard]] std::uint64_t Points() const {
    if (Get("POINTS").line != 0) return Count("POINTS");
    if (Get("WIDTH").line != 0 && Get("HEIGHT").line != 0) {
      const std::uint64_t points = header_.width * header_.height;
      if (points <= kMaxPoints) return points;
      throw ErrorInLine(file_,
                        Get("WIDTH").line,
                        "WIDTH * HEIGHT is " + std::to_string(points) + "; expected at most " +
                            std::to_string(kMaxPoints) + " points");
    }
    throw ErrorInLine(file_, data_line_, "the header has neither POINTS nor both WIDTH and HEIGHT");
  }

  void SetViewpoint() {
    const Entry& entry = Get("VIEWPOINT");
    if (entry.line == 0) return;
    std::vector<double> numbers;
    for (const std::string_view value : entry.values) {
      const auto number = ParseNumber(value);
      if (!number || !std::isfinite(*number)) {
        throw ErrorInLine(
            file_, entry.line, "VIEWPOINT " + Quoted(value) + ": expected a finite number");
      }
      numbers.push_back(*number);
    }
    if (numbers.size() != 7) {
      throw ErrorInLine(file_,
                        entry.line,
                        "VIEWPOINT has " + std::to_string(numbers.size()) +
                            " values; expected 7 (tx ty tz qw qx qy qz)");
    }
    std::copy_n(numbers.begin(), 3, header_.viewpoint.translation_m.begin());
    std::copy_n(numbers.begin() + 3, 4, header_.viewpoint.rotation_wxyz.begin());
  }

  std::string_view bytes_;
  const std::string& file_;
  std::map<std::string_view, Entry> entries_;
  std::size_t data_line_ = 0;
  PcdHeader header_;
};

}  // namespace

PcdHeader ParsePcdHeader(std::string_view bytes, const std::string& file) {
  if (bytes.empty()) throw ErrorInFile(file, "is empty (0 bytes)");
  return HeaderParser(bytes, file).Parse();
}

}  // namespace clearway::io
