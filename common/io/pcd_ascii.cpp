// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_ascii.hpp"

#include <cstdint>
#include <utility>
#include <vector>

#include "common/io/read_error.hpp"
#include "common/io/text.hpp"

namespace clearway::io {

namespace {

class AsciiReader {
 public:
  explicit AsciiReader(const PcdBody& body)
      : body_(body), text_(WithoutPadding(body)), lines_(text_, body.header.body_line) {}

  core::PointCloud Run() {
    // A row takes a character and a separator a value at least: a longer announcement is not
    // believed, and found out when the rows run out.
    if (body_.header.points <= (text_.size() + 1) / (2 * body_.header.columns)) {
      cloud_.Reserve(static_cast<std::size_t>(body_.header.points));
    }
    const std::string_view glued = body_.header.glued_row;
    if (!glued.empty() && CountRows() + 1 == body_.header.points) {
      AddRow(glued, body_.header.body_line - 1);
    }
    while (const auto line = lines_.Next()) {
      if (IsRow(*line)) AddRow(*line, lines_.line());
    }
    if (cloud_.size() != body_.header.points) {
      throw ErrorInLine(body_.file,
                        lines_.line(),
                        "the file ends after " + std::to_string(cloud_.size()) + " of " +
                            std::to_string(body_.header.points) + " points: it is cut short");
    }
    return std::move(cloud_);
  }

 private:
  static std::string_view WithoutPadding(const PcdBody& body) {
    const std::string_view text = body.bytes.substr(body.header.body_offset);
    return text.substr(0, text.find_last_not_of('\0') + 1);
  }

  static bool IsRow(std::string_view line) {
    const std::string_view text = Trim(line);
    return !text.empty() && text[0] != '#';
  }

  [[nodiscard]] std::uint64_t CountRows() const {
    std::uint64_t rows = 0;
    LineReader lines(text_);
    while (const auto line = lines.Next()) rows += IsRow(*line) ? 1 : 0;
    return rows;
  }

  void AddRow(std::string_view text, std::size_t line) {
    line_ = line;
    if (cloud_.size() == body_.header.points) {
      throw ErrorInLine(
          body_.file, line_, "a row too many; POINTS is " + std::to_string(body_.header.points));
    }
    const std::vector<std::string_view> words = SplitWords(text);
    if (words.size() != body_.header.columns) {
      throw ErrorInLine(body_.file,
                        line_,
                        "the row of point " + std::to_string(cloud_.size()) + " has " +
                            std::to_string(words.size()) + " values; expected " +
                            std::to_string(body_.header.columns));
    }
    const PcdSelection& selection = body_.selection;
    const Eigen::Vector3f point(ToCoordinate(Number(words, selection.xyz[0])),
                                ToCoordinate(Number(words, selection.xyz[1])),
                                ToCoordinate(Number(words, selection.xyz[2])));
    const double intensity = selection.intensity ? Number(words, *selection.intensity) : 0.0;
    cloud_.Add(point, ToIntensity(intensity, body_.intensity_scale));
  }

  [[nodiscard]] double Number(const std::vector<std::string_view>& words, std::size_t field) const {
    const PcdField& info = body_.header.fields[field];
    const std::string_view word = words[info.column];
    const auto number = ParseNumber(word);
    if (number) {
      // A float as it says, so that the same cloud is the same in each encoding.
      const bool is_float = info.type == 'F' && info.size == 4;
      return is_float ? static_cast<double>(ToCoordinate(*number)) : *number;
    }
    throw ErrorInLine(body_.file,
                      line_,
                      info.name + " of point " + std::to_string(cloud_.size()) + " is " +
                          Quoted(word) + ": expected a number");
  }

  const PcdBody& body_;
  std::string_view text_;
  LineReader lines_;
  std::size_t line_ = 0;  // Of the row that is read.
  core::PointCloud cloud_;
};

}  // namespace

core::PointCloud ReadPcdAscii(const PcdBody& body) {
  return AsciiReader(body).Run();
}

}  // namespace clearway::io
