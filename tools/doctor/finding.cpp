// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/finding.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace clearway::doctor {
namespace {

constexpr char kSudo[] = "sudo ";
constexpr char kPipedSudo[] = "| sudo ";
constexpr std::size_t kMostWords = 8;

bool NeedsNoQuotes(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         (c != '\0' && std::strchr("_-./:=@%+,", c) != nullptr);
}

}  // namespace

std::string ShellWord(const std::string& text) {
  if (!text.empty() && std::all_of(text.begin(), text.end(), NeedsNoQuotes)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

Finding ForRoot(Finding finding) {
  for (std::string& command : finding.mend) {
    if (command.starts_with(kSudo)) command.erase(0, std::strlen(kSudo));
    const std::size_t piped = command.find(kPipedSudo);
    if (piped != std::string::npos) command.replace(piped, std::strlen(kPipedSudo), "| ");
  }
  return finding;
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < std::min(words.size(), kMostWords); ++i) {
    if (i > 0) text += ", ";
    text += words[i];
  }
  if (words.size() > kMostWords) {
    text += " and " + std::to_string(words.size() - kMostWords) + " more";
  }
  return text;
}

}  // namespace clearway::doctor
