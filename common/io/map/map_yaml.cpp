// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_yaml.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <optional>

#include <yaml-cpp/yaml.h>

#include "common/io/text.hpp"

namespace clearway::io {
namespace {

constexpr std::array kModes = {MapMode::kTrinary, MapMode::kScale, MapMode::kRaw};

std::size_t LineOf(const YAML::Mark& mark) {
  return mark.line < 0 ? 0 : static_cast<std::size_t>(mark.line) + 1;
}

// yaml-cpp's messages may quote the file.
std::string Printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

std::string Shown(const YAML::Node& value) {
  if (value.IsScalar()) return Quoted(value.Scalar());
  if (value.IsSequence()) return "(a list of " + std::to_string(value.size()) + ")";
  return value.IsMap() ? "(a map)" : "(nothing)";
}

struct Entry {
  std::string key;
  std::size_t line = 0;
  YAML::Node value;
  bool is_used = false;
};

class MapYamlReader {
 public:
  MapYamlReader(const YAML::Node& root, const std::string& name) : name_(name) {
    for (const auto& entry : root) AddEntry(entry.first, entry.second);
  }

  MapDescription Read() {
    MapDescription map;
    ReadImage(map);
    map.resolution_m = Number("resolution", "a number above 0", [](double v) { return v > 0.0; });
    ReadOrigin(map);
    ReadNegate(map);
    const auto is_share = [](double v) { return v >= 0.0 && v <= 1.0; };
    map.occupied_threshold = Number("occupied_thresh", "a number from 0 to 1", is_share);
    map.free_threshold = Number("free_thresh", "a number from 0 to 1", is_share);
    ReadMode(map);
    // NaN stands for a threshold that was refused already.
    if (map.free_threshold > map.occupied_threshold) {
      const Entry& entry = *Find("free_thresh");
      Refuse(entry, "at most occupied_thresh, which is " + Shown(Find("occupied_thresh")->value));
    }
    for (const Entry& entry : entries_) {
      if (!entry.is_used) map.ignored_keys.push_back(entry.key);
    }
    ThrowProblems();
    return map;
  }

 private:
  void AddEntry(const YAML::Node& key, const YAML::Node& value) {
    const std::size_t line = LineOf(key.Mark());
    if (!key.IsScalar()) {
      AddProblem(line, "key " + Shown(key) + ": expected a word");
      return;
    }
    const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return entry.key == key.Scalar();
    });
    if (same == entries_.end()) {
      entries_.push_back({key.Scalar(), line, value, false});
    } else {
      AddProblem(line,
                 "key " + Quoted(key.Scalar()) + " is there already in line " +
                     std::to_string(same->line) + ": expected it once");
    }
  }

  Entry* Find(const std::string& key) {
    const auto entry = std::find_if(
        entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == key; });
    if (entry == entries_.end()) return nullptr;
    entry->is_used = true;
    return &*entry;
  }

  Entry* Require(const std::string& key, const std::string& allowed) {
    Entry* entry = Find(key);
    if (entry == nullptr) {
      problems_.push_back(name_ + ": key \"" + key + "\" is missing: expected " + allowed);
    }
    return entry;
  }

  void Refuse(const Entry& entry, const std::string& allowed) {
    AddProblem(entry.line, entry.key + " " + Shown(entry.value) + ": expected " + allowed);
  }

  // NaN when it was refused.
  template <typename Predicate>
  double Number(const std::string& key, const std::string& allowed, Predicate is_allowed) {
    const Entry* entry = Require(key, allowed);
    if (entry == nullptr) return std::nan("");
    const std::optional<double> value = FiniteNumber(entry->value);
    if (value && is_allowed(*value)) return *value;
    Refuse(*entry, allowed);
    return std::nan("");
  }

  static std::optional<double> FiniteNumber(const YAML::Node& node) {
    if (!node.IsScalar()) return std::nullopt;
    const std::optional<double> value = ParseNumber(Trim(node.Scalar()));
    return value && std::isfinite(*value) ? value : std::nullopt;
  }

  void ReadImage(MapDescription& map) {
    const std::string allowed = "the name of an image";
    const Entry* entry = Require("image", allowed);
    if (entry == nullptr) return;
    const YAML::Node& node = entry->value;
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
    if (!node.IsScalar() || node.Scalar().empty() ||
        std::any_of(node.Scalar().begin(), node.Scalar().end(), is_control)) {
      Refuse(*entry, allowed);
      return;
    }
    map.image = node.Scalar();
    map.image_line = entry->line;
  }

  void ReadOrigin(MapDescription& map) {
    const std::string allowed = "a list of 3 numbers: x [m], y [m], yaw [rad]";
    const Entry* entry = Require("origin", allowed);
    if (entry == nullptr) return;
    if (!entry->value.IsSequence() || entry->value.size() != map.origin.size()) {
      Refuse(*entry, allowed);
      return;
    }
    for (std::size_t i = 0; i < map.origin.size(); ++i) {
      const YAML::Node element = entry->value[i];
      const std::optional<double> value = FiniteNumber(element);
      if (value) {
        map.origin[i] = *value;
      } else {
        AddProblem(entry->line,
                   "origin, number " + std::to_string(i + 1) + ", " + Shown(element) +
                       ": expected " + allowed);
      }
    }
  }

  void ReadNegate(MapDescription& map) {
    const std::string allowed = "0, 1, true or false";
    const Entry* entry = Require("negate", allowed);
    if (entry == nullptr) return;
    const YAML::Node& node = entry->value;
    if (node.IsScalar() && (node.Scalar() == "0" || node.Scalar() == "1")) {
      map.negate = node.Scalar() == "1";
    } else if (!node.IsScalar() || !YAML::convert<bool>::decode(node, map.negate)) {
      Refuse(*entry, allowed);
    }
  }

  void ReadMode(MapDescription& map) {
    const Entry* entry = Find("mode");
    if (entry == nullptr) return;
    std::string word = entry->value.IsScalar() ? entry->value.Scalar() : "";
    std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) {
      return static_cast<char>(std::tolower(c));
    });
    const auto mode = std::find_if(
        kModes.begin(), kModes.end(), [&](MapMode known) { return word == NameOf(known); });
    if (mode == kModes.end()) {
      Refuse(*entry, "trinary, scale or raw");
    } else {
      map.mode = *mode;
    }
  }

  void AddProblem(std::size_t line, const std::string& text) {
    problems_.push_back(ErrorInLine(name_, line, text).what());
  }

  void ThrowProblems() const {
    if (problems_.empty()) return;
    std::string all = problems_.front();
    for (std::size_t i = 1; i < problems_.size(); ++i) all += '\n' + problems_[i];
    throw ReadError(all);
  }

  const std::string& name_;
  std::vector<Entry> entries_;
  std::vector<std::string> problems_;
};

MapDescription Parse(std::string_view text, const std::string& name) {
  const YAML::Node root = YAML::Load(std::string(text));
  if (!root.IsMap()) {
    throw ErrorInLine(name,
                      std::max<std::size_t>(LineOf(root.Mark()), 1),
                      "the document is " + Shown(root) + ": expected a map of keys and values");
  }
  return MapYamlReader(root, name).Read();
}

}  // namespace

const char* NameOf(MapMode mode) {
  switch (mode) {
    case MapMode::kTrinary:
      return "trinary";
    case MapMode::kScale:
      return "scale";
    case MapMode::kRaw:
      return "raw";
  }
  return "";
}

MapDescription ParseMapYaml(std::string_view text, const std::string& name) {
  if (text.size() > kMaxMapYamlBytes) {
    throw ErrorInFile(name,
                      "has " + std::to_string(text.size()) +
                          " bytes: expected the YAML file of a map, at most " +
                          std::to_string(kMaxMapYamlBytes));
  }
  try {
    return Parse(text, name);
  } catch (const YAML::Exception& error) {
    throw ErrorInLine(
        name,
        LineOf(error.mark),
        "is not YAML: " + Printable(error.msg) + "; expected a map of keys and values");
  }
}

}  // namespace clearway::io
