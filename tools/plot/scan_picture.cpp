// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_picture.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "tools/plot/canvas.hpp"
#include "tools/plot/panels.hpp"
#include "tools/plot/view_region.hpp"

namespace clearway::plot {

namespace {

constexpr Rect kTitle{16.0, 8.0, 1568.0, 28.0};
constexpr Rect kBirdsEye{8.0, 62.0, 784.0, 660.0};
constexpr Rect kPerspective{808.0, 62.0, 776.0, 622.0};
constexpr Rect kLegend{24.0, 738.0, 1560.0, 154.0};

void DrawTitles(Canvas& canvas, const std::string& title) {
  constexpr TextStyle kLarge{.size_px = 20.0, .colour = kBlack, .is_bold = true};
  constexpr TextStyle kSmall{.size_px = 13.0, .colour = kTextGrey, .is_bold = true};
  canvas.Text(canvas.Shorten(title, kLarge, kTitle.width), {kTitle.x, kTitle.y + 20.0}, kLarge);
  canvas.Text("Bird's eye, x up", {kBirdsEye.x + 44.0, kBirdsEye.y - 8.0}, kSmall);
  canvas.Text("Perspective, from behind and above the vehicle",
              {kPerspective.x, kPerspective.y - 8.0},
              kSmall);
}

std::string OutsideRemark(const char* panel, const PanelReport& report) {
  return "not in view (" + std::string(panel) + "): " + std::to_string(report.num_points_outside) +
         " raw";
}

void WriteFile(const std::vector<unsigned char>& bytes, const std::filesystem::path& path) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  if (file) {
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file.close();
  }
  if (!file) {
    throw std::runtime_error("cannot write the picture '" + path.string() +
                             "': " + (errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
}

}  // namespace

void WritePng(const ScanPicture& picture, const std::filesystem::path& path) {
  Canvas canvas(kPictureWidth_px, kPictureHeight_px);
  const ViewRegion region = ChooseRegion(picture);
  DrawTitles(canvas, picture.title);
  const PanelReport above = DrawBirdsEye(canvas, kBirdsEye, picture, region);
  const PanelReport behind = DrawPerspective(canvas, kPerspective, picture, region);

  std::vector<std::string> remarks = {"grid " + StepLabel(above.grid_step_m, above.grid_step_m) +
                                      " m, in perspective " +
                                      StepLabel(behind.grid_step_m, behind.grid_step_m) + " m"};
  if (!picture.hidden.Contains(Layer::kRaw) && !picture.missing.Contains(Layer::kRaw)) {
    remarks.push_back(OutsideRemark("bird's eye", above));
    remarks.push_back(OutsideRemark("perspective", behind));
  }
  std::string hidden;
  for (const auto& [name, layer] : kLayerNames) {
    if (picture.hidden.Contains(layer)) hidden += (hidden.empty() ? "" : ", ") + std::string(name);
  }
  if (!hidden.empty()) remarks.push_back("not drawn: " + hidden);
  const std::size_t left_out = above.num_labels_left_out + behind.num_labels_left_out;
  if (left_out > 0) remarks.push_back(std::to_string(left_out) + " labels left out: no room");
  DrawLegend(canvas, kLegend, picture, remarks);
  WriteFile(canvas.EncodePng(), path);
}

}  // namespace clearway::plot
