// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/scan_listing.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <system_error>

#include "common/io/file_bytes.hpp"
#include "common/io/read_error.hpp"
#include "common/io/text.hpp"

namespace clearway::io {

namespace {

namespace fs = std::filesystem;

bool IsDigit(char character) {
  return character >= '0' && character <= '9';
}

std::string LowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& letter : extension) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return extension;
}

/// The part of a name that compares as one: a run of digits, or one byte.
struct Token {
  std::string_view text;
  bool is_number = false;     ///< Digits that are not behind a decimal point.
  std::string_view compared;  ///< A number without its leading zeros.
};

Token TokenAt(std::string_view name, std::size_t start) {
  if (!IsDigit(name[start]))
    return {.text = name.substr(start, 1), .compared = name.substr(start, 1)};
  std::size_t end = start;
  while (end < name.size() && IsDigit(name[end])) ++end;
  const std::string_view digits = name.substr(start, end - start);
  const bool is_fraction = start >= 2 && name[start - 1] == '.' && IsDigit(name[start - 2]);
  if (is_fraction) return {.text = digits, .compared = digits};
  const std::size_t zeros = std::min(digits.find_first_not_of('0'), digits.size());
  return {.text = digits, .is_number = true, .compared = digits.substr(zeros)};
}

bool PathComesBefore(const fs::path& a, const fs::path& b) {
  return std::lexicographical_compare(
      a.begin(), a.end(), b.begin(), b.end(), [](const fs::path& one, const fs::path& other) {
        return ComesBefore(one.native(), other.native());
      });
}

std::vector<fs::path> ListFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::size_t num_other = 0;
  try {
    for (auto entry = fs::recursive_directory_iterator(folder);
         entry != fs::recursive_directory_iterator();
         ++entry) {
      std::error_code ignored;  // A link that leads nowhere is no folder; reading it will tell.
      const bool is_folder = entry->is_directory(ignored);
      if (entry->path().filename().native().starts_with('.')) {
        if (is_folder) entry.disable_recursion_pending();
      } else if (!is_folder && IsScanFile(entry->path())) {
        files.push_back(entry->path());
      } else if (!is_folder) {
        ++num_other;
      }
    }
  } catch (const fs::filesystem_error& error) {
    const fs::path& place = error.path1().empty() ? folder : error.path1();
    throw ErrorInFile(place.string(), "cannot be searched: " + error.code().message());
  }
  if (files.empty()) {
    throw ErrorInFile(folder.string(),
                      "no scan in this folder or below it: looked for *.pcd and *.bin, found " +
                          std::to_string(num_other) + " other files");
  }
  std::sort(files.begin(), files.end(), PathComesBefore);
  return files;
}

std::vector<fs::path> ReadList(const fs::path& list) {
  const std::string file = list.string();
  const std::string text = ReadFileBytes(list);
  std::vector<fs::path> files;
  LineReader lines(text);
  while (const auto line = lines.Next()) {
    const std::string_view name = Trim(*line);
    if (name.empty() || name[0] == '#') continue;
    const fs::path path = list.parent_path() / name;
    if (!IsScanFile(path)) {
      throw ErrorInLine(file, lines.line(), Quoted(name) + ": expected a .pcd or .bin file");
    }
    std::error_code error;
    if (!fs::is_regular_file(path, error)) {
      throw ErrorInLine(file, lines.line(), "no such file: " + path.string());
    }
    files.push_back(path);
  }
  if (files.empty()) throw ErrorInFile(file, "the list names no .pcd or .bin file");
  return files;
}

}  // namespace

bool IsPcdFile(const fs::path& path) {
  return LowerExtension(path) == ".pcd";
}

bool IsScanFile(const fs::path& path) {
  return IsPcdFile(path) || LowerExtension(path) == ".bin";
}

std::vector<fs::path> ListScanFiles(const fs::path& input) {
  std::error_code error;
  const auto status = fs::status(input, error);
  if (fs::is_directory(status)) return ListFolder(input);
  if (fs::is_regular_file(status)) {
    if (IsScanFile(input)) return {input};
    if (LowerExtension(input) == ".txt") return ReadList(input);
  }
  throw ErrorInFile(input.string(),
                    std::string(fs::exists(status) ? "not a recording" : "no such file or folder") +
                        "; expected a folder with .pcd or .bin files, one such file, or a .txt "
                        "list of them");
}

bool ComesBefore(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    const Token one = TokenAt(a, i);
    const Token other = TokenAt(b, j);
    if (one.is_number && other.is_number && one.compared.size() != other.compared.size()) {
      return one.compared.size() < other.compared.size();
    }
    if (one.compared != other.compared) return one.compared < other.compared;
    i += one.text.size();
    j += other.text.size();
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;
}

}  // namespace clearway::io
