// SPDX-License-Identifier: BSD-3-Clause
#include "tools/map/show.hpp"

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/plot/map_picture.hpp"

namespace clearway::map_tool {
namespace {

std::string Format(const char* format, double a, double b = 0.0) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

}  // namespace

std::string FormatJson(const io::LoadedMap& map) {
  const core::GridGeometry& geometry = map.grid.geometry;
  const plot::CellCounts counts = plot::CountCells(map.grid);
  nlohmann::ordered_json json;
  json["size"] = {{"width", geometry.width}, {"height", geometry.height}};
  json["resolution_m"] = geometry.resolution_m;
  json["origin"] = {{"x_m", geometry.origin_x_m},
                    {"y_m", geometry.origin_y_m},
                    {"yaw_rad", geometry.origin_yaw_rad}};
  json["cells"] = {{"free", counts.free},
                   {"occupied", counts.occupied},
                   {"between", counts.between},
                   {"unknown", counts.unknown}};
  json["mode"] = io::NameOf(map.description.mode);
  json["negate"] = map.description.negate;
  json["occupied_threshold"] = map.description.occupied_threshold;
  json["free_threshold"] = map.description.free_threshold;
  json["image"] = map.image_path.string();
  json["ignored_keys"] = map.description.ignored_keys;
  // A file's name need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

std::string FormatLine(const io::LoadedMap& map) {
  const core::GridGeometry& geometry = map.grid.geometry;
  const plot::CellCounts counts = plot::CountCells(map.grid);
  return std::to_string(geometry.width) + " x " + std::to_string(geometry.height) + " cells of " +
         Format("%.6g m", geometry.resolution_m) + ", origin " +
         Format("(%.6g, %.6g) m", geometry.origin_x_m, geometry.origin_y_m) +
         Format(", yaw %.6g rad", geometry.origin_yaw_rad) + ", " +
         io::NameOf(map.description.mode) + ": " + std::to_string(counts.free) + " free, " +
         std::to_string(counts.occupied) + " occupied, " + std::to_string(counts.between) +
         " between, " + std::to_string(counts.unknown) + " unknown\n";
}

void DrawMap(const io::LoadedMap& map,
             const std::filesystem::path& yaml,
             const std::filesystem::path& output) {
  plot::MapPictureText text;
  text.title = yaml.string();
  text.lines = {"image " + map.description.image,
                std::string("mode ") + io::NameOf(map.description.mode) +
                    (map.description.negate ? ", negated" : ""),
                Format("occupied above %.6g, free below %.6g",
                       map.description.occupied_threshold,
                       map.description.free_threshold)};
  plot::WriteMapPng(map.grid, text, output);
}

}  // namespace clearway::map_tool
