// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace clearway::io {

/// True for .pcd and .bin, in any case of letters.
[[nodiscard]] bool IsScanFile(const std::filesystem::path& path);

/// True for .pcd, in any case of letters.
[[nodiscard]] bool IsPcdFile(const std::filesystem::path& path);

/// The scan files that an input stands for, at least one:
/// - a folder: all .pcd and .bin files in it and below it, folder by folder and name by name in
///   natural order (see ComesBefore()). Names that start with a dot are passed over, links to
///   folders are not followed;
/// - a list (.txt): one file a line, relative to the list's folder, in the order of the list;
///   empty lines and lines that start with # are passed over;
/// - a .pcd or .bin file: itself.
/// Throws ReadError that says what was looked for when there is nothing.
[[nodiscard]] std::vector<std::filesystem::path> ListScanFiles(const std::filesystem::path& input);

/// Natural order of names: runs of digits compare as numbers (scan2 before scan10), save behind a
/// decimal point, where they compare as decimals (0.25 before 0.5); all else byte by byte. A strict
/// weak order; names that differ only in leading zeros are ordered byte by byte.
[[nodiscard]] bool ComesBefore(std::string_view a, std::string_view b);

}  // namespace clearway::io
