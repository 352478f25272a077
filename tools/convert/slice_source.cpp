// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/slice_source.hpp"

#include "common/io/scan_listing.hpp"
#include "tools/convert/sources.hpp"

namespace clearway::convert {

Format FormatOf(const std::filesystem::path& path) {
  if (path.extension() == ".lvx" || path.extension() == ".LVX") return Format::kLvx;
  if (std::filesystem::is_directory(path) || io::IsScanFile(path)) return Format::kFolder;
  if (!std::filesystem::exists(path) && !path.has_extension()) return Format::kFolder;
  return Format::kLog;
}

std::unique_ptr<SliceSource> OpenSource(const SourceSettings& settings) {
  switch (FormatOf(settings.input)) {
    case Format::kLvx:
      return OpenLvx(settings);
    case Format::kFolder:
      return OpenFolder(settings);
    case Format::kLog:
      break;
  }
  return OpenLog(settings);
}

}  // namespace clearway::convert
