// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/convert/slice_source.hpp"

namespace clearway::convert {

/// An LVX file through the driver's own path: packets -> core::livox::SensorStream -> slices. PTP
/// and GPS stamps are taken as they are; others count from settings.start_utime, else from the
/// stamp that the file is named after, else from io::kFirstScanUtime.
[[nodiscard]] std::unique_ptr<SliceSource> OpenLvx(const SourceSettings& settings);

/// LIDAR_POINTS of an LCM log.
[[nodiscard]] std::unique_ptr<SliceSource> OpenLog(const SourceSettings& settings);

/// .pcd and .bin files: each a scan of settings.scan_period_us. Their stamps are their names where
/// all of these are stamps, else one follows the other from settings.start_utime on, else from
/// io::kFirstScanUtime.
[[nodiscard]] std::unique_ptr<SliceSource> OpenFolder(const SourceSettings& settings);

}  // namespace clearway::convert
