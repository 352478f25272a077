// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace clearway::test {

/// Walks a config struct and notes which fields have a default outside their own bounds, which
/// names stand twice in one element, and how many fields there are.
class DefaultsVisitor {
 public:
  void Number(const std::string& name, double& v, double lo, double hi, const char*) {
    Note(name, v >= lo && v <= hi);
  }
  void Integer(const std::string& name, int& v, int lo, int hi, const char*) {
    Note(name, v >= lo && v <= hi);
  }
  void Degrees(const std::string& name, double& v, double lo, double hi, const char*) {
    const double degrees = v * 180.0 / std::numbers::pi;
    Note(name, degrees >= lo - 1e-9 && degrees <= hi + 1e-9);
  }
  void Milliseconds(const std::string& name, std::int64_t& v, double lo, double hi, const char*) {
    const double ms = static_cast<double>(v) / 1000.0;
    Note(name, ms >= lo && ms <= hi);
  }
  void Flag(const std::string& name, bool&, const char*) { Note(name, true); }
  void Text(const std::string& name, std::string&, const char*) { Note(name, true); }
  template <typename Enum, std::size_t N>
  void Choice(const std::string& name,
              Enum& v,
              const std::array<std::pair<const char*, Enum>, N>& names,
              const char*) {
    bool is_known = false;
    for (const auto& entry : names) is_known = is_known || entry.second == v;
    Note(name, is_known);
  }
  template <typename Struct>
  void Group(const std::string& name, Struct& inner, const char*) {
    Note(name, true);
    DefaultsVisitor visitor;
    Struct::Visit(inner, visitor);
    Take(name, visitor);
  }
  template <typename Struct>
  void List(const std::string& name, std::vector<Struct>& list, const char*) {
    Note(name, true);
    for (Struct& inner : list) {
      DefaultsVisitor visitor;
      Struct::Visit(inner, visitor);
      Take(name, visitor);
    }
  }

  std::vector<std::string> faults;
  int num_fields = 0;

 private:
  void Note(const std::string& name, bool is_good) {
    ++num_fields;
    if (!is_good) faults.push_back(name + " has a default outside its bounds");
    if (!names_.insert(name).second) faults.push_back(name + " stands twice");
  }
  void Take(const std::string& name, const DefaultsVisitor& inner) {
    num_fields += inner.num_fields;
    for (const std::string& fault : inner.faults) faults.push_back(name + "." + fault);
  }

  std::set<std::string> names_;
};

/// The faults of a default-constructed config.
template <typename Config>
std::vector<std::string> FaultsOfDefaults() {
  Config config;
  DefaultsVisitor visitor;
  Config::Visit(config, visitor);
  return visitor.faults;
}

}  // namespace clearway::test
